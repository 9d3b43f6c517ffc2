//! The `mouldloft` programme: command line in, [`mouldloft::app`] out.

fn main() {}
