//! Peers measured beside multires.

fn main() {}
