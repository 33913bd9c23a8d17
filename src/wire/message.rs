//! What the lines say: messages to and from the robot, as text and back. Numbers leave in the units of
//! the protocol page and are what a robot would make of them; [`quantised`] and
//! [`told`] are the same rounding for a robot that needs no line.

mod fields;
mod rounding;

use crate::robot::{
    Chassis, Command, CommandId, DoneReason, Edge, Guard, Motion, Odometer, SWITCHES, SensorMount,
    SwitchSet, Telemetry,
};
use fields::Fields;
pub use rounding::{quantised, told};
use std::fmt::Write as _;

/// The version of the protocol that this program speaks.
pub const VERSION: u32 = 1;
/// Most switches that a robot may have.
const MOST_SWITCHES: usize = *SWITCHES.end();

/// Hundredths of a millimetre in a metre; microradians; and so on.
const LENGTH: f64 = 1e5;
const MILLI: f64 = 1e3;
const MICRO: f64 = 1e6;
const NANO: f64 = 1e9;

/// Host to robot.
#[derive(Debug, Clone, PartialEq)]
pub enum ToRobot {
    /// Who are you?
    Hello {
        /// Version of the protocol.
        version: u32,
        /// Another one for every conversation: numbers count anew with it.
        session: u32,
    },
    /// A motion; its id is the sequence number.
    Command(Command),
    /// Stop; answered, unlike the stop byte.
    Stop {
        /// Its sequence number.
        seq: u32,
    },
    /// The host is there.
    Ping {
        /// Counts up.
        number: u32,
        /// The newest event that the host has.
        event: u32,
    },
}

/// Robot to host.
#[derive(Debug, Clone, PartialEq)]
pub enum FromRobot {
    /// Who it is.
    Hello {
        /// Version of the protocol.
        version: u32,
        /// Another one after every start.
        boot: u32,
        /// The conversation that it is in; 0 before the first.
        session: u32,
        /// Silence of the host after which it stops, milliseconds.
        watchdog: u32,
        /// How many switches it has.
        switches: usize,
        /// Its name.
        name: String,
    },
    /// Its body; without the switches.
    Body(Chassis),
    /// One of its switches.
    Switch {
        /// Which one.
        index: usize,
        /// Its name and direction.
        mount: SensorMount,
    },
    /// A command was taken.
    Acknowledge {
        /// Which one.
        seq: u32,
    },
    /// A command is refused.
    Refuse {
        /// Which one.
        seq: u32,
        /// Why, in the robot's words.
        why: String,
    },
    /// Answer to a ping.
    Pong {
        /// Which one.
        number: u32,
    },
    /// The periodic report.
    Report {
        /// Encoders and gyro.
        odometer: Odometer,
        /// Which switches are closed.
        switches: SwitchSet,
        /// Whether the bumper is pressed.
        bumper: bool,
        /// The newest event that happened before it.
        event: u32,
        /// Volts of the battery, where there is one.
        battery: Option<f64>,
    },
    /// A switch changed, or a motion ended: numbered, sent until it is confirmed.
    Event {
        /// Its number, from 1.
        event: u32,
        /// An edge or the end of a motion.
        telemetry: Telemetry,
    },
}

fn scaled(value: f64, unit: f64) -> i64 {
    (value * unit).round() as i64
}

impl std::fmt::Display for ToRobot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Hello { version, session } => write!(f, "H {version} {session:08X}"),
            Self::Stop { seq } => write!(f, "S {seq}"),
            Self::Ping { number, event } => write!(f, "P {number} {event}"),
            Self::Command(Command { id, motion, guard, time_limit }) => {
                let (seq, limit) = (id.0, scaled(*time_limit, MILLI));
                let (rise, fall) = (guard.rise.0, guard.fall.0);
                match motion {
                    Motion::Move { distance, speed } => {
                        let (distance, speed) = (scaled(*distance, LENGTH), scaled(*speed, MILLI));
                        write!(f, "M {seq} {distance} {speed} {rise:02X} {fall:02X} {limit}")
                    }
                    Motion::Turn { angle, rate } => {
                        let (angle, rate) = (scaled(*angle, MICRO), scaled(*rate, MILLI));
                        write!(f, "T {seq} {angle} {rate} {rise:02X} {fall:02X} {limit}")
                    }
                    Motion::Rest => write!(f, "R {seq} {limit}"),
                }
            }
        }
    }
}

fn letter_of(body: &str) -> Option<(&str, &str)> {
    let (letter, rest) = body.split_once(' ')?;
    (letter.len() == 1).then_some((letter, rest))
}

impl ToRobot {
    /// Reads a body; none when it makes no sense or is not known.
    #[must_use]
    pub fn parse(body: &str) -> Option<Self> {
        let (letter, rest) = letter_of(body)?;
        let mut fields = Fields::of(rest, 20);
        let command = |seq, motion, guard, limit: f64| {
            Self::Command(Command { id: CommandId(seq), motion, guard, time_limit: limit })
        };
        let message = match letter {
            "H" => Self::Hello { version: fields.number()?, session: fields.hex()? },
            "S" => Self::Stop { seq: fields.number()? },
            "P" => Self::Ping { number: fields.number()?, event: fields.number()? },
            "M" => {
                let seq = fields.sequence()?;
                let distance = fields.measure(LENGTH)?;
                let motion = Motion::Move { distance, speed: fields.measure(MILLI)? };
                let guard = Guard { rise: fields.set()?, fall: fields.set()? };
                command(seq, motion, guard, fields.measure(MILLI)?)
            }
            "T" => {
                let seq = fields.sequence()?;
                let angle = fields.measure(MICRO)?;
                let motion = Motion::Turn { angle, rate: fields.measure(MILLI)? };
                let guard = Guard { rise: fields.set()?, fall: fields.set()? };
                command(seq, motion, guard, fields.measure(MILLI)?)
            }
            "R" => {
                let seq = fields.sequence()?;
                command(seq, Motion::Rest, Guard::default(), fields.measure(MILLI)?)
            }
            _ => return None,
        };
        Some(message)
    }
}

struct Odo<'a>(&'a Odometer);

impl std::fmt::Display for Odo<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Odometer { time_us, left_ticks, right_ticks, heading } = self.0;
        write!(f, "{time_us} {left_ticks} {right_ticks} {}", scaled(*heading, MICRO))
    }
}

fn reason_word(reason: DoneReason) -> String {
    match reason {
        DoneReason::Complete => "ok".to_owned(),
        DoneReason::Guard { sensor, rising } => {
            format!("g{sensor}{}", if rising { '+' } else { '-' })
        }
        DoneReason::Bumper => "bump".to_owned(),
        DoneReason::Stalled => "stall".to_owned(),
        DoneReason::TimeLimit => "time".to_owned(),
        DoneReason::Stopped => "stop".to_owned(),
        DoneReason::HostSilent => "host".to_owned(),
    }
}

/// "3+" or "3-".
fn switch_word(word: &str) -> Option<(usize, bool)> {
    let (index, sign) = word.split_at_checked(word.len().checked_sub(1)?)?;
    let index = index.parse().ok().filter(|index| *index < MOST_SWITCHES)?;
    match sign {
        "+" => Some((index, true)),
        "-" => Some((index, false)),
        _ => None,
    }
}

fn reason_of(word: &str) -> Option<DoneReason> {
    Some(match word {
        "ok" => DoneReason::Complete,
        "bump" => DoneReason::Bumper,
        "stall" => DoneReason::Stalled,
        "time" => DoneReason::TimeLimit,
        "stop" => DoneReason::Stopped,
        "host" => DoneReason::HostSilent,
        other => {
            let (sensor, rising) = switch_word(other.strip_prefix('g')?)?;
            DoneReason::Guard { sensor, rising }
        }
    })
}

impl std::fmt::Display for FromRobot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Hello { version, boot, session, watchdog, switches, name } => {
                let name = plain(name, 40);
                write!(f, "h {version} {boot:08X} {session:08X} {watchdog} {switches} {name}")
            }
            Self::Body(chassis) => {
                let length = |value| scaled(value, LENGTH);
                write!(
                    f,
                    "c {} {} {} {} {} {} {} {} {}",
                    length(chassis.radius),
                    length(chassis.wheel_base),
                    scaled(chassis.tick, NANO),
                    length(chassis.range),
                    length(chassis.hysteresis),
                    scaled(chassis.speed, MILLI),
                    scaled(chassis.turn_rate, MILLI),
                    scaled(chassis.acceleration, MILLI),
                    scaled(chassis.bumper_half_angle, MICRO),
                )
            }
            Self::Switch { index, mount } => {
                write!(f, "s {index} {} {}", scaled(mount.angle, MICRO), plain(&mount.name, 40))
            }
            Self::Acknowledge { seq } => write!(f, "a {seq}"),
            Self::Refuse { seq, why } => write!(f, "n {seq} {}", plain(why, 60)),
            Self::Pong { number } => write!(f, "p {number}"),
            Self::Report { odometer, switches, bumper, event, battery } => {
                let battery = scaled(battery.unwrap_or(0.0), MILLI);
                let (set, bumper) = (switches.0, u8::from(*bumper));
                write!(f, "r {} {set:02X} {bumper} {event} {battery}", Odo(odometer))
            }
            Self::Event { event, telemetry } => match telemetry {
                Telemetry::Edge(Edge { sensor, rising, odometer }) => {
                    let sign = if *rising { '+' } else { '-' };
                    write!(f, "e {event} {sensor}{sign} {}", Odo(odometer))
                }
                Telemetry::Done { id, reason, odometer, switches, bumper } => {
                    let mut word = reason_word(*reason);
                    let _ = write!(word, " {}", Odo(odometer));
                    let (set, bumper) = (switches.0, u8::from(*bumper));
                    write!(f, "d {event} {} {word} {set:02X} {bumper}", id.0)
                }
                Telemetry::Report { .. } => Ok(()),
            },
        }
    }
}

/// Text for the line: printable ASCII, not longer than `most`.
fn plain(text: &str, most: usize) -> String {
    text.chars().map(|c| if matches!(c, ' '..='~') { c } else { '?' }).take(most).collect()
}

impl FromRobot {
    /// Reads a body; none when it makes no sense or is not known. Bodies hold printable ASCII only,
    /// so no text in them can steer a terminal.
    #[must_use]
    pub fn parse(body: &str) -> Option<Self> {
        let (letter, rest) = letter_of(body)?;
        let message = match letter {
            "h" => {
                let mut fields = Fields::of(rest, 6);
                Self::Hello {
                    version: fields.number()?,
                    boot: fields.hex()?,
                    session: fields.hex()?,
                    watchdog: fields.number()?,
                    switches: fields.number()?,
                    name: fields.text(),
                }
            }
            "c" => Self::Body(chassis(&mut Fields::of(rest, 20))?),
            "s" => {
                let mut fields = Fields::of(rest, 3);
                let index = fields.number().filter(|index| *index < MOST_SWITCHES)?;
                let angle = fields.measure(MICRO)?;
                Self::Switch { index, mount: SensorMount { name: fields.text(), angle } }
            }
            "n" => {
                let mut fields = Fields::of(rest, 2);
                Self::Refuse { seq: fields.number()?, why: fields.text() }
            }
            _ => return Self::of_motion(letter, &mut Fields::of(rest, 20)),
        };
        Some(message)
    }

    fn of_motion(letter: &str, fields: &mut Fields<'_>) -> Option<Self> {
        let message = match letter {
            "a" => Self::Acknowledge { seq: fields.number()? },
            "p" => Self::Pong { number: fields.number()? },
            "r" => Self::Report {
                odometer: fields.odometer()?,
                switches: fields.set()?,
                bumper: fields.flag()?,
                event: fields.number()?,
                battery: fields.measure(MILLI).filter(|volts| *volts > 0.0),
            },
            "e" => {
                let event = fields.number()?;
                let (sensor, rising) = switch_word(&fields.text())?;
                let odometer = fields.odometer()?;
                let telemetry = Telemetry::Edge(Edge { sensor, rising, odometer });
                Self::Event { event, telemetry }
            }
            "d" => {
                let event = fields.number()?;
                let id = CommandId(fields.number()?);
                let reason = reason_of(&fields.text())?;
                let odometer = fields.odometer()?;
                let (switches, bumper) = (fields.set()?, fields.flag()?);
                let telemetry = Telemetry::Done { id, reason, odometer, switches, bumper };
                Self::Event { event, telemetry }
            }
            _ => return None,
        };
        Some(message)
    }
}

/// The body of a robot, as it says; whether a robot can have it is asked when it is taken for one.
fn chassis(fields: &mut Fields<'_>) -> Option<Chassis> {
    Some(Chassis {
        radius: fields.measure(LENGTH)?,
        wheel_base: fields.measure(LENGTH)?,
        tick: fields.measure(NANO)?,
        range: fields.measure(LENGTH)?,
        hysteresis: fields.measure(LENGTH)?,
        speed: fields.measure(MILLI)?,
        turn_rate: fields.measure(MILLI)?,
        acceleration: fields.measure(MILLI)?,
        bumper_half_angle: fields.measure(MICRO)?,
        sensors: Vec::new(),
    })
}

#[cfg(test)]
mod tests;
