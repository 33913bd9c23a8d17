//! How long the host waits, and for what (see the protocol page).

/// A host that is there says so this often, seconds.
pub(super) const PING: f64 = 0.1;
/// The robot is asked who it is this often, seconds.
pub(super) const HELLO: f64 = 0.25;
/// A board that restarts when its port is opened answers within this, seconds.
pub(super) const BOOT: f64 = 3.5;
/// With a motion in hand, a robot that told nothing of itself for this long is stopped, seconds.
pub(super) const BLIND: f64 = 0.3;
/// A line over which nothing was told for this long is stale, seconds.
pub(super) const STALE: f64 = 0.5;
/// ... and lost after this, until the robot tells something again.
pub const LOST: f64 = 1.5;
/// An answer is waited for this long, besides the time the bytes take, seconds.
pub(super) const ANSWER: f64 = 0.05;
/// A command that is not acknowledged for this long although the line is there is given up, seconds.
pub(super) const UNANSWERED: f64 = 3.0;
/// A motion must have ended this long after its own limit, seconds.
pub(super) const OVERDUE: f64 = 3.0;
/// A line is believed in again when it was there without a break for this long, seconds.
pub(super) const CLEAN: f64 = 0.5;
/// What began before a stop has ended, and said so, this long after it and the time that braking takes, seconds.
pub(super) const UNDOUBTED: f64 = 1.0;
/// A robot that tells of later events says the next one again within this, seconds.
pub(super) const HOLE: f64 = 0.5;
/// No robot waits longer than this for its host, milliseconds: simulated hardware that is a thousand times as
/// fast as life does.
pub(super) const PATIENCE: u32 = 300_000;
/// Bytes of the longest command and its acknowledgement.
pub(super) const EXCHANGE: f64 = 60.0;
/// Stops are numbered from here: commands never get so far.
pub(super) const FIRST_STOP: u32 = 1 << 31;
/// A report may come after one that was made so much later, microseconds of robot time.
pub(super) const OVERTAKEN_US: u64 = 1_000_000;
