//! Position and heading.

use super::{Point, Vector, angle};
use serde::{Deserialize, Serialize};
use std::str::FromStr;

/// Where something is and which way it faces.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Centre, metres.
    pub position: Point,
    /// Direction of travel, radians counter-clockwise from +x.
    pub heading: f64,
}

/// What is no pose.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PoseError {
    /// Not three values.
    #[error("a pose is X,Y,DEG: metres, and degrees counter-clockwise from +x, such as 0.6,0.6,90")]
    Form,
    /// One of them is none.
    #[error("`{0}` is not a finite number")]
    Number(String),
    /// Nowhere near.
    #[error("a pose is within 100 km of the origin and a whole turn: metres and degrees")]
    Far,
}

impl PoseError {
    /// Nothing is farther from the origin in x or y, metres.
    const FAR: f64 = 1e5;
}

/// As people write it: `X,Y,DEG`, metres and degrees counter-clockwise from +x.
impl FromStr for Pose {
    type Err = PoseError;

    fn from_str(text: &str) -> Result<Self, PoseError> {
        let number = |part: &str| {
            let value = part.trim().parse().ok().filter(|value: &f64| value.is_finite());
            value.ok_or_else(|| PoseError::Number(part.trim().to_owned()))
        };
        let parts: Vec<&str> = text.split(',').collect();
        let [x, y, degrees] = parts[..] else { return Err(PoseError::Form) };
        let (x, y, degrees) = (number(x)?, number(y)?, number(degrees)?);
        if x.abs() > PoseError::FAR || y.abs() > PoseError::FAR || degrees.abs() > 360.0 {
            return Err(PoseError::Far);
        }
        Ok(Self::new(x, y, angle::wrap(degrees.to_radians())))
    }
}

impl Pose {
    /// A pose at (`x`, `y`) metres facing `heading` radians.
    #[must_use]
    pub fn new(x: f64, y: f64, heading: f64) -> Self {
        Self { position: Point::new(x, y), heading }
    }

    /// Unit vector of the heading.
    #[must_use]
    pub fn direction(&self) -> Vector {
        angle::unit(self.heading)
    }

    /// A point given ahead (x) and to the left (y) of this pose, in the frame this pose is in.
    #[must_use]
    pub fn to_world(&self, local: Point) -> Point {
        self.position + self.rotate(local.coords)
    }

    /// The inverse of [`Pose::to_world`].
    #[must_use]
    pub fn to_local(&self, world: Point) -> Point {
        let away = world - self.position;
        let ahead = self.direction();
        Point::new(away.dot(&ahead), super::cross(ahead, away))
    }

    /// A displacement given ahead (x) and to the left (y), turned into this pose's outer frame.
    #[must_use]
    pub fn rotate(&self, local: Vector) -> Vector {
        let ahead = self.direction();
        ahead * local.x + super::perp(ahead) * local.y
    }

    /// This pose driven `distance` metres straight ahead.
    #[must_use]
    pub fn advanced(&self, distance: f64) -> Self {
        Self { position: self.position + self.direction() * distance, heading: self.heading }
    }

    /// This pose turned counter-clockwise by `by` radians, heading wrapped.
    #[must_use]
    pub fn turned(&self, by: f64) -> Self {
        Self { position: self.position, heading: angle::wrap(self.heading + by) }
    }
}
