//! Periplus: an operator console for robots that map a room by touch.
//!
//! The method is that of *Path Based Mapping Technique for Robots* (Dhawan, Oak, Mishra,
//! Puthanpurackal), section III. Data flows one way: telemetry in, mapping core, commands out; the
//! screen and the exports read copies of the state.
//!
//! Reading order:
//!
//! 1. `geometry`: points, poses, rings of straight and circular pieces.
//! 2. `robot`: what may be asked of a robot, what it reports, what its body is like.
//! 3. `mapping`: the core, without I/O or clock. `map` is what is known, as plain data, and what it owes of
//!    its promise; `mission` is the run as one state machine;
//!    `odometry` and `survey` (where the robot and the walls are, and how surely); `search` (III.C)
//!    with `follow`, `ahead`, `wall`, `circuit` (with `drift`, the gyro's, `lay`, one look laid on another,
//!    and `retreat`, back by the way it came) and `adjust`; `retrace`, a lap more that is averaged in,
//!    and `calibration`, what that tells of wheels and gyro; `shape` (III.D), which ends the map at straits,
//!    and `smooth`, which lets its straight walls straighten the lap, and `thin`, which parts the faces of thin
//!    ones; `tape`, a length that was measured in the room; `square`, right angles made right; `plan` (III.E)
//!    on `floor`; `tour` (III.F) on the `chart` of what is mapped; `network`, all observations adjusted at
//!    once, when the lap has its shape and when the tour is over (in a round room on the way as well), and what
//!    errors they then have in common;
//!    `relocate`, how a robot that was carried, or doubts where it is, finds its place again;
//!    `trust`, which switches can be believed; `accuracy`, how well all of it is known; `unreached`, what
//!    the robot does not get to.
//! 4. `safety`: the one gate for commands. `session`: core, gate and operator's word together, the
//!    snapshot that the screen reads, and the replay of a record.
//! 5. `wire`: what host and robot say to each other. `simulator`, `firmware`, `link`: the simulated
//!    room, the robot's own side, and the ways to either.
//! 6. `console`, `export`, `journal`: the screen, the results, the record.
//! 7. `runtime`, `cli`, `commands`: the clock, the signals, the arguments; `runtime::live` is a session
//!    with a real robot, `runtime::line` the thread that keeps its port.
//!
//! `spelling`, which all that reads words may ask, is what somebody likely meant, and what a reader of files
//! does; `wording`, which all that writes figures may ask, is how they are written.
//!
//! What is absent on purpose: the core never reads a clock or a file, and never sees the
//! simulator's truth, which goes from the link to the exports alone.

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
pub mod spelling;
pub mod wire;
pub mod wording;
