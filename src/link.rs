//! The links to a robot: something that takes commands and yields telemetry.

pub mod faults;
pub mod port;
pub mod simulated;
pub use faults::{Faults, FaultyWay};
pub use port::{Address, PortError, RobotEnd, Stream};
pub use simulated::SimulatedLink;
