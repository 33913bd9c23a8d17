//! The operator's screen: what it shows, what keys do, and the loop that joins both to a run.
//!
//! A key becomes an [`action::Action`] (keymap), an action becomes a change of the
//! [`model::Model`] and effects (`update`), and the view draws model and snapshot by shared
//! reference. Nothing here steers: the console speaks to the run in intents, through
//! [`driver::Driver`], and sees of it only the [`crate::session::Snapshot`].
//!
//! Reading order: `action`, `key`, `keymap`; `command`, `prompt`, `model`, `update`; `theme`, `canvas`,
//! `layout`, `view`; `frame` (a frame without a terminal); `driver`, `screen`, `terminal`, `app`.

pub mod action;
pub mod app;
pub mod canvas;
pub mod command;
pub mod driver;
pub mod frame;
pub mod key;
pub mod keymap;
pub mod layout;
pub mod model;
pub mod prompt;
mod sanitize;
pub mod screen;
pub mod terminal;
pub mod theme;
pub mod update;
pub mod view;

pub use app::{ConsoleError, Ending, Options, run};
pub use driver::Driver;
pub use keymap::{Keymap, KeymapError};
