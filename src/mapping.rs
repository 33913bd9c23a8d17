//! The mapping core: from telemetry to the next command and the map. Without I/O, clock or chance
//! that is not seeded; it cannot fail, and knows only what the robot reported.

pub mod accuracy;
pub mod adjust;
pub mod ahead;
pub mod calibration;
pub mod chart;
pub mod circuit;
pub mod drift;
pub mod event;
pub mod floor;
pub mod follow;
pub mod lay;
pub mod map;
pub mod mission;
pub mod network;
pub mod odometry;
pub mod passing;
pub mod plan;
pub mod relocate;
pub mod retrace;
mod retreat;
pub mod search;
pub mod settings;
pub mod shape;
pub mod smooth;
pub mod square;
pub mod survey;
pub mod tape;
pub mod thin;
pub mod tour;
pub mod trust;
pub mod unreached;
pub mod wall;
