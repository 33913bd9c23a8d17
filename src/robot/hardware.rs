//! The few functions of a robot's hardware that its firmware needs.

use super::{Edge, Odometer, SwitchSet};

/// Motors, encoders, gyro, switches and bumper, real or simulated.
pub trait Hardware {
    /// Sets the speed of the body, metres per second ahead and radians per second counter-clockwise, until
    /// set again.
    fn drive(&mut self, speed: f64, rate: f64);
    /// Encoders and gyro now.
    fn odometer(&self) -> Odometer;
    /// Which switches are closed now.
    fn switches(&self) -> SwitchSet;
    /// Whether the bumper is pressed now.
    fn bumper(&self) -> bool;
    /// The oldest edge that was not taken yet.
    fn take_edge(&mut self) -> Option<Edge>;
}
