//! One step of the whole: mapping core, gate and records behind one door.
pub mod snapshot;
pub use snapshot::{RunState, Snapshot};
