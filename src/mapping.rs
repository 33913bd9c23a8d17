//! The mapping core.
pub mod adjust;
pub mod ahead;
pub mod circuit;
pub mod event;
pub mod fix;
pub mod floor;
pub mod follow;
pub mod map;
pub mod mission;
pub mod odometry;
pub mod passing;
pub mod plan;
pub mod search;
pub mod settings;
pub mod shape;
pub mod tour;
pub mod wall;
