//! Honest measurement.
