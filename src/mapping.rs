//! The mapping core.
pub mod adjust;
pub mod ahead;
pub mod circuit;
pub mod event;
pub mod fix;
pub mod follow;
pub mod floor;
pub mod map;
pub mod mission;
pub mod odometry;
pub mod settings;
pub mod wall;
pub mod shape;
