//! The whole run as one state machine: telemetry in, commands and events out.

use super::circuit::{Circuit, Closure, Leg};
use super::event::{Event, EventKind, Failure};
use super::follow::{Ask, AtRest, Side};
use super::map::{Phase, RoomMap};
use super::odometry::Tracker;
use super::settings::Settings;
use super::wall::Wall;
use crate::geometry::angle;
use crate::robot::{Command, CommandId, DoneReason, Guard, Motion, Odometer, SwitchSet, Telemetry};

/// What the core wants done or told.
#[derive(Debug, Clone, PartialEq)]
pub enum Output {
    /// Send this to the robot.
    Command(Command, &'static str),
    /// Something happened.
    Event(Event),
}

enum Task {
    Begin,
    Seeking { tried: usize },
    Lapping(Box<Circuit>),
    Over,
}

/// A run.
pub struct Mission {
    settings: Settings,
    /// debug
    pub tracker: Tracker,
    map: RoomMap,
    phase: Phase,
    task: Task,
    wall: Wall,
    closed: SwitchSet,
    next_id: u32,
    awaiting: Option<(CommandId, bool)>,
    /// debug
    pub closure: Option<Closure>,
    /// debug
    pub failure: Option<Failure>,
    /// d
    pub debug_misclosure: Option<super::map::Misclosure>,
    /// d
    pub debug_adjusted: Vec<super::map::Contact>,
}

impl Mission {
    /// new
    #[must_use]
    pub fn new(settings: Settings) -> Self {
        let tracker = Tracker::new(&settings.chassis, settings.start);
        let wall = Wall::new(&settings.chassis);
        Self {
            settings,
            tracker,
            map: RoomMap::default(),
            phase: Phase::Boundary,
            task: Task::Begin,
            wall,
            closed: SwitchSet::EMPTY,
            next_id: 0,
            awaiting: None,
            closure: None,
            failure: None,
            debug_misclosure: None,
            debug_adjusted: Vec::new(),
        }
    }

    /// debug
    pub fn over(&self) -> bool {
        matches!(self.task, Task::Over)
    }

    /// debug
    pub fn wall(&self) -> &Wall {
        match &self.task {
            Task::Lapping(c) => &c.wall,
            _ => &self.wall,
        }
    }
    fn wall_mut(&mut self) -> &mut Wall {
        match &mut self.task {
            Task::Lapping(c) => &mut c.wall,
            _ => &mut self.wall,
        }
    }

    /// start
    pub fn begin(&mut self, out: &mut Vec<Output>) {
        let rest = AtRest {
            pose: self.tracker.pose(),
            closed: self.closed,
            reason: DoneReason::Complete,
        };
        self.decide(rest, out);
    }

    /// step
    pub fn step(&mut self, input: &Telemetry, out: &mut Vec<Output>) {
        match input {
            Telemetry::Report {
                odometer, switches, ..
            } => {
                self.follow_odometer(odometer, self.closed);
                self.closed = *switches;
            }
            Telemetry::Edge(edge) => {
                let pose = self.follow_odometer(&edge.odometer, self.closed);
                let turning = self.awaiting.is_some_and(|(_, turning)| turning);
                let travelled = self.tracker.travelled();
                self.wall_mut().observe(edge, pose, turning, travelled);
                self.closed = self.closed.with(edge.sensor, edge.rising);
            }
            Telemetry::Done {
                id,
                reason,
                odometer,
                switches,
                ..
            } => {
                let pose = self.follow_odometer(odometer, self.closed);
                self.closed = *switches;
                if self.awaiting.is_none_or(|(expected, _)| expected != *id) {
                    return;
                }
                self.awaiting = None;
                if *reason == DoneReason::Bumper {
                    let (t, us) = (self.tracker.travelled(), odometer.time_us);
                    self.wall_mut().touch(pose, 0.0, t, us);
                    self.tell(EventKind::Bumped, out);
                }
                let rest = AtRest {
                    pose,
                    closed: self.closed,
                    reason: *reason,
                };
                self.decide(rest, out);
            }
        }
    }

    fn follow_odometer(&mut self, odometer: &Odometer, closed: SwitchSet) -> crate::geometry::Pose {
        let pose = self.tracker.advance(odometer, self.phase);
        let travelled = self.tracker.travelled();
        self.wall_mut().carve(pose, closed, travelled);
        pose
    }

    fn tell(&mut self, kind: EventKind, out: &mut Vec<Output>) {
        out.push(Output::Event(Event {
            time_us: self.tracker.time_us(),
            kind,
        }));
    }

    fn order(&mut self, ask: &Ask, out: &mut Vec<Output>) {
        let chassis = &self.settings.chassis;
        self.next_id += 1;
        let (motion, time) = match ask.motion {
            Motion::Move { distance, speed } => {
                let speed = speed.min(chassis.speed);
                (Motion::Move { distance, speed }, distance.abs() / speed)
            }
            Motion::Turn { angle, rate } => {
                let rate = rate.min(chassis.turn_rate);
                (Motion::Turn { angle, rate }, angle.abs() / rate)
            }
            Motion::Rest => (Motion::Rest, 1.0),
        };
        let command = Command {
            id: CommandId(self.next_id),
            motion,
            guard: ask.guard,
            time_limit: time * 1.5 + 2.0,
        };
        self.awaiting = Some((command.id, matches!(motion, Motion::Turn { .. })));
        out.push(Output::Command(command, ask.why));
    }

    fn decide(&mut self, rest: AtRest, out: &mut Vec<Output>) {
        match std::mem::replace(&mut self.task, Task::Over) {
            Task::Begin => {
                let ask = Ask {
                    motion: Motion::Move {
                        distance: 100.0,
                        speed: f64::INFINITY,
                    },
                    guard: Guard {
                        rise: SwitchSet(0xff),
                        fall: SwitchSet::EMPTY,
                    },
                    why: "driving until something is met",
                };
                self.task = Task::Seeking { tried: 0 };
                self.order(&ask, out);
            }
            Task::Seeking { .. } => {
                let side = match rest.reason {
                    DoneReason::Guard { sensor, .. }
                        if self.settings.chassis.sensors[sensor].angle < -0.5
                            && self.settings.chassis.sensors[sensor].angle > -angle::PI + 0.1 =>
                    {
                        Side::Right
                    }
                    _ => Side::Left,
                };
                let wall = std::mem::replace(&mut self.wall, Wall::new(&self.settings.chassis));
                let circuit = Circuit::new(&self.settings.chassis, side, wall, 0.6);
                self.task = Task::Lapping(Box::new(circuit));
                self.decide(rest, out);
            }
            Task::Lapping(mut circuit) => match circuit.next(&self.tracker, &rest) {
                Leg::Go(ask) => {
                    self.task = Task::Lapping(circuit);
                    self.order(&ask, out);
                }
                Leg::Closed(closure, misclosure) => {
                    let adj =
                        super::adjust::Adjustment::new(self.tracker.path(), &closure, &misclosure);
                    for s in circuit.wall.log() {
                        let _ = s;
                    }
                    self.debug_misclosure = Some(misclosure);
                    self.debug_adjusted = circuit
                        .wall
                        .log()
                        .iter()
                        .filter(|s| {
                            s.alive
                                && s.travelled > closure.from.travelled - 0.05
                                && s.travelled < closure.to.travelled
                        })
                        .map(|s| {
                            let mut c = s.contact();
                            c.point = adj.place(c.point, s.time_us);
                            c.from = adj.place(c.from, s.time_us);
                            c
                        })
                        .collect();
                    self.closure = Some(closure);
                    self.wall = circuit.wall;
                    self.tell(
                        EventKind::LapClosed {
                            length: closure.length(),
                            extrinsic: closure.is_extrinsic(),
                        },
                        out,
                    );
                    let _ = &self.map;
                    self.task = Task::Over;
                }
                Leg::Failed(why) => {
                    self.wall = circuit.wall;
                    self.failure = Some(why);
                    self.tell(EventKind::LapFailed { why }, out);
                    self.task = Task::Over;
                }
            },
            Task::Over => {}
        }
    }
}
