//! The vocabulary that host and robot share: what may be asked of a robot, what it reports, and
//! what its body is like (paper III.B). Plain data; nothing here moves or decides.

pub mod bounds;
pub mod chassis;
pub mod command;
pub mod hardware;
pub mod intent;
pub mod telemetry;

pub use bounds::{SWITCHES, Unfit};
pub use chassis::{Chassis, SensorMount, SwitchSet};
pub use command::{Command, CommandId, Guard, Motion};
pub use hardware::Hardware;
pub use intent::Intent;
pub use telemetry::{DoneReason, Edge, Odometer, Telemetry};
