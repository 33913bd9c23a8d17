//! Periplus: an operator console for robots that map a room by touch.
pub mod cli;
pub mod commands;
pub mod console;
pub mod export;
pub mod firmware;
pub mod geometry;
pub mod journal;
pub mod link;
pub mod mapping;
pub mod robot;
pub mod runtime;
pub mod safety;
pub mod session;
pub mod simulator;
