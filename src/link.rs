//! The links to a robot: something that takes commands and yields telemetry.

pub mod simulated;
pub use simulated::SimulatedLink;
