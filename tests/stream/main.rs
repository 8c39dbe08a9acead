//! A model sent to a client shows there what it shows at home, within the client's limits, whatever the line does.
#![cfg(feature = "stream")]

#[path = "../support/sent.rs"]
mod sent;

mod faults;
mod hostile;
mod limits;
mod prefix;
mod same_cut;
#[cfg(feature = "io")]
mod store;
