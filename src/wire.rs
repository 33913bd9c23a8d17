//! What host and robot say to each other, and how the host keeps watch over the line. No I/O and no
//! clock: bytes and the time come in, bytes and messages go out. The protocol is on one page,
//! [`PROTOCOL`], which is all that a robot of another make needs.

pub mod frame;
pub mod host;
pub mod message;

pub use frame::{Decoder, Item, STOP, seal};
pub use host::{Health, Heard, Host};
pub use message::{FromRobot, ToRobot, VERSION, quantised, told};

/// The protocol, as `periplus protocol` prints it.
pub const PROTOCOL: &str = include_str!("wire/PROTOCOL.md");
