//! Following a wall: from what is known of the surfaces near the robot to its next motion.
//!
//! The robot is thought of as a disc of radius r + gap that rolls along the contacts, like the
//! ball of ball pivoting (Bernardini et al. 1999) in the plane: the next straight step goes in the
//! first direction, counted from the wall away, that keeps the disc clear of every contact. Beyond
//! the last contact the wall is believed to go on as it came, straight or round, until a look says
//! that it does not; then the disc rolls round the last contact, which is what an outer corner asks
//! for. Between steps the robot looks: it swings towards the wall until its front diagonal switch
//! closes, which gives contacts ahead before it gets there.
//!
//! Owns no pose and no contacts; it is told both. Knows nothing of laps or maps.

mod escape;
mod held;
mod look;
mod roles;

use super::ahead::{Frontier, Rolling, Sweep};
use super::lay::Seen;
use super::map::ContactKind;
use super::wall::{Sighting, Wall};
use crate::geometry::{Point, Pose, Ring, Vector, angle};
use crate::robot::{Chassis, DoneReason, Guard, Motion, SwitchSet};
use held::Held;
use roles::Roles;

/// On which hand the wall is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Wall on the left; a room is gone round clockwise, an object counter-clockwise.
    Left,
    /// Wall on the right.
    Right,
}

impl Side {
    /// +1 for left, -1 for right: multiplies angles, so that positive is towards the wall.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    /// The other hand.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// No move through the open is longer, metres; along a wall that goes on as it did, the longest is
/// [`LONGEST_STRIDE`]. How far the wheels carry the robot differs from one move to the next; over many short
/// ones that averages out. A stop costs as much time as 4 cm of way.
pub const STRIDE: f64 = 0.25;

/// How far from a wall the robot's centre is kept while it follows it, metres: inside the band that the
/// switches see.
#[must_use]
pub fn clearance(chassis: &Chassis) -> f64 {
    chassis.radius + GAP * chassis.range
}

/// Share of the switches' range at which the body is kept off the wall.
const GAP: f64 = 0.75;

/// The next motion, with what ends it and why it was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Ask {
    /// What to do.
    pub motion: Motion,
    /// What ends it early.
    pub guard: Guard,
    /// Why, for the operator.
    pub why: &'static str,
}

/// What is known when the robot has come to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AtRest {
    /// Believed pose.
    pub pose: Pose,
    /// Closed switches.
    pub closed: SwitchSet,
    /// Why the last motion ended.
    pub reason: DoneReason,
}

/// What the follower did last.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Doing {
    /// Nothing yet: the robot has just met the wall.
    Arrived,
    /// Turning away from something ahead until its switch opens.
    Clearing,
    /// Turning towards the wall to see where it goes on.
    Looking,
    /// Turning into the direction of the next step, of this length.
    Facing(f64),
    /// A step along the wall.
    Stepping,
    /// Backing off after a bump.
    BackingOff,
    /// Held between things: turning the back to where it came from, to leave by that way.
    Leaving,
}

/// Follows one wall.
#[derive(Debug, Clone)]
pub struct Follower {
    side: Side,
    roles: Roles,
    doing: Doing,
    /// The wall is known to end at the frontier.
    ended: bool,
    /// Where its switch has just seen it end, and the way the robot went then.
    tip: Option<(Point, Vector)>,
    /// Length of a step along a wall that behaves, metres.
    stride: f64,
    /// How many times as long the next one is.
    growth: f64,
    gap: f64,
    frontier: Option<Frontier>,
    held: Held,
    rolling: Rolling,
    /// Bearing and reach of the switch that looks ahead of the wall.
    ahead: Option<(f64, f64)>,
    /// Heading at the beginning of the look.
    looked_from: f64,
    swept: Option<Sweep>,
    body: f64,
    /// Body and range together, half the swath, metres.
    reach: f64,
    squeezing: bool,
    /// Outlines of what stands about and is no part of the wall.
    known: Vec<Ring>,
}

/// What is seen nearer than this to something known is of it, metres.
const SAME_THING: f64 = 0.1;
/// So much of the way to where the switch of a wall opens is left to chance, metres.
const UNSEEN: f64 = 0.003;
/// The body keeps this far off the walls when it has to squeeze out of a pocket, metres.
const SQUEEZED: f64 = 0.02;
/// What slid into the beam on the far side of a gap is taken to be this near to the body, metres.
const BESIDE: f64 = 0.02;
/// A robot that reaches farther than this from its centre, metres, sees past the end of a thin wall before it is round
/// it, and was led across the gap behind by what it had seen of the far side. One that reaches as far as ours never
/// was, and what it has seen on both sides leads it out of pockets that are hardly wider than it is.
const FAR: f64 = 0.165;
/// A step along a wall of which little is known, metres, ...
const SHORTEST_STRIDE: f64 = 0.09;
/// ... and along one that goes on as it did.
pub const LONGEST_STRIDE: f64 = 0.50;
/// A step round a corner, metres.
const ROUND_CORNER: f64 = 0.06;
/// Rolling round a corner never turns farther towards the wall than this at once, radians.
const MOST_TOWARDS: f64 = 1.9;

impl Follower {
    /// Follows with the wall on `side`.
    #[must_use]
    pub fn new(chassis: &Chassis, side: Side) -> Self {
        let gap = GAP * chassis.range;
        let roles = Roles::new(chassis, side);
        Self {
            side,
            roles,
            ahead: roles.ahead.map(|index| (chassis.sensors[index].angle, chassis.reach())),
            looked_from: 0.0,
            swept: None,
            doing: Doing::Arrived,
            ended: false,
            tip: None,
            stride: SHORTEST_STRIDE,
            growth: look::GROWTH,
            gap,
            frontier: None,
            held: Held::default(),
            rolling: Rolling {
                side,
                radius: chassis.radius + gap,
                least: chassis.radius + 0.012,
                slack: (1.0 - GAP) * chassis.range - UNSEEN,
                sees_far: chassis.reach() > FAR,
            },
            body: chassis.radius,
            reach: chassis.reach(),
            squeezing: false,
            known: Vec::new(),
        }
    }

    /// What is followed is most likely a room: the first look that finds its wall where it was believed to go on is
    /// enough for a long step, though now and then that is a thing which stands free. Along what is known to be a thing, of
    /// which all that is known comes from a few looks, steps grow slowly.
    #[must_use]
    pub fn along_walls(self) -> Self {
        Self { growth: f64::INFINITY, ..self }
    }

    /// Goes through gaps hardly wider than the body, `on` or no longer: to get out where it got in.
    pub fn squeeze(&mut self, on: bool) {
        self.squeezing = on;
        self.rolling.radius = self.body + if on { SQUEEZED } else { self.gap };
    }

    /// Begins anew where the robot is, in front of a `gap` between two points, if any, that is closed to it.
    pub fn resume(&mut self, gap: Option<(Point, Point)>) {
        self.doing = Doing::Arrived;
        self.ended = false;
        self.stride = SHORTEST_STRIDE;
        self.frontier = None;
        if let Some((one, other)) = gap {
            self.close(one, other);
        }
    }

    /// The gap between two points is closed to it, as if something stood there.
    pub fn close(&mut self, one: Point, other: Point) {
        self.held.bar(one, other);
    }

    /// What is `known` to stand about and to be no part of the wall makes no gap that is refused.
    pub fn beside(&mut self, known: Vec<Ring>) {
        self.known = known;
    }

    /// On which hand the wall is.
    #[must_use]
    pub fn side(&self) -> Side {
        self.side
    }

    /// Whether the follower is about to step, with its heading set: a good moment to begin or
    /// judge a lap.
    #[must_use]
    pub fn is_stepping(&self) -> bool {
        self.doing == Doing::Stepping
    }

    /// Whether the robot has gone nowhere for long.
    #[must_use]
    pub fn is_stuck(&self) -> bool {
        self.held.is_stuck()
    }

    /// The next motion; none when the robot is held on all sides.
    pub fn next(&mut self, wall: &mut Wall, rest: &AtRest) -> Option<Ask> {
        if let Some(before) = self.held.rests(rest, wall.log().len()) {
            wall.doubt_before(before);
        }
        let ask = self.choose(wall, rest);
        if let Some(ask) = &ask {
            self.held.asks(ask);
        }
        ask
    }

    fn choose(&mut self, wall: &mut Wall, rest: &AtRest) -> Option<Ask> {
        if matches!(rest.reason, DoneReason::Bumper | DoneReason::Stalled) {
            if let Some(ask) = self.leave(rest) {
                return Some(ask);
            }
            if self.doing != Doing::BackingOff {
                return Some(self.back_off());
            }
        }
        if self.doing != Doing::Looking {
            self.swept = None;
        }
        match self.doing {
            Doing::Arrived | Doing::Stepping => Some(self.after_step(wall, rest)),
            Doing::Looking => {
                self.judge_look(wall, rest);
                self.face(wall, rest)
            }
            Doing::Facing(step) if rest.reason == DoneReason::Complete => {
                Some(self.step(self.watched(step, rest.closed)))
            }
            Doing::Leaving => Some(self.back_out("held between things: backing out")),
            // A turn that was cut short: the direction is chosen anew.
            Doing::Clearing | Doing::BackingOff | Doing::Facing(_) => self.face(wall, rest),
        }
    }

    /// Whether `sensor` has just seen something known.
    fn is_known(&self, wall: &Wall, sensor: usize) -> bool {
        let seen = wall.near().rev().find(|seen| seen.sensor == Some(sensor));
        seen.is_some_and(|seen| {
            self.known.iter().any(|ring| ring.distance(seen.point) < SAME_THING)
        })
    }

    fn after_step(&mut self, wall: &mut Wall, rest: &AtRest) -> Ask {
        let closed_by = match rest.reason {
            DoneReason::Guard { sensor, rising: true } => Some(sensor),
            _ => None,
        };
        if let Some(sensor) = closed_by {
            self.stride = SHORTEST_STRIDE;
            self.ended = false;
            if Some(sensor) == self.roles.front || Some(sensor) == self.roles.ahead {
                return self.clear(sensor);
            }
            if Some(sensor) == self.roles.across
                && !self.is_known(wall, sensor)
                && self.refuses(rest)
            {
                self.bar(wall, sensor, rest);
                wall.pull_in(sensor, self.body + BESIDE);
                wall.leave_beyond(rest.pose);
                return self.back_out("too narrow between two things: backing out");
            }
        }
        if let DoneReason::Guard { rising: false, .. } = rest.reason {
            self.stride = SHORTEST_STRIDE;
            let tip = wall.near().next_back().filter(|seen| seen.kind == ContactKind::Edge);
            self.tip = tip.map(|seen| (seen.point, rest.pose.direction()));
            self.ended = self.tip.is_some();
        }
        // Something is already close ahead of the wall: a swing could not see it close again.
        if let Some(ahead) = self.roles.ahead
            && rest.closed.has(ahead)
        {
            return self.clear(ahead);
        }
        self.looked_from = rest.pose.heading;
        self.look()
    }

    fn turn(&mut self, towards_wall: f64, guard: Guard, doing: Doing, why: &'static str) -> Ask {
        self.doing = doing;
        Ask {
            motion: Motion::Turn { angle: towards_wall * self.side.sign(), rate: f64::INFINITY },
            guard,
            why,
        }
    }

    fn clear(&mut self, sensor: usize) -> Ask {
        let guard = Guard { fall: SwitchSet::only(sensor), ..Guard::default() };
        self.turn(-1.2, guard, Doing::Clearing, "something ahead: turning until it is clear")
    }

    fn face(&mut self, wall: &mut Wall, rest: &AtRest) -> Option<Ask> {
        let mut step = if self.ended { ROUND_CORNER } else { self.stride };
        // Bars first: what is seen is newer.
        let bars: Vec<Seen> = self.bars(rest).collect();
        let seen = |bars: &[Seen], sure: bool| -> Vec<Seen> {
            let near = wall.near().filter(|seen| !sure || seen.kind == ContactKind::Range);
            bars.iter().copied().chain(near.map(Sighting::seen)).collect()
        };
        // Where a touch was is a guess, and what bars a gap stands nowhere: neither must hold the robot on all
        // sides.
        let about = [(&bars[..], false), (&bars[..], true), (&[][..], false), (&[][..], true)];
        let swept = self.swept.as_ref();
        let along = if self.doing == Doing::Looking { self.looked_from } else { rest.pose.heading };
        let roll = |step: f64, ended: bool| {
            about.into_iter().find_map(|(bars, sure)| {
                let seen = seen(bars, sure);
                self.rolling.direction(&seen, rest.pose, step, ended, swept, along)
            })
        };
        let mut found = roll(step, self.ended)?;
        if !self.ended && found.frontier.is_some_and(|frontier| frontier.ended) {
            self.ended = true;
            self.stride = SHORTEST_STRIDE;
            step = ROUND_CORNER;
            found = roll(step, true)?;
        }
        self.frontier = found.frontier;
        step = found.step;
        let turn = self.the_way_round(found.heading - rest.pose.heading);
        if turn.abs() < 0.015 {
            return Some(self.step(self.watched(step, rest.closed)));
        }
        self.doing = Doing::Facing(step);
        Some(Ask {
            motion: Motion::Turn { angle: turn, rate: f64::INFINITY },
            guard: Guard::default(),
            why: if self.ended { "rolling round a corner" } else { "facing along the wall" },
        })
    }

    /// The turn by `by` radians, or a whole turn more or less: away from the wall when it is large.
    /// In a dead end the robot must turn away from the wall, never through it, or the turns of a
    /// lap would not add up to one.
    fn the_way_round(&self, by: f64) -> f64 {
        let towards = angle::wrap(by) * self.side.sign();
        self.side.sign() * if towards > MOST_TOWARDS { towards - angle::TAU } else { towards }
    }

    /// How far to step: a wall that its own switch does not see is not watched either, and a long
    /// step would lead away from it unnoticed. A robot without such a switch steps over no gap that it fits
    /// through.
    fn watched(&self, step: f64, closed: SwitchSet) -> f64 {
        match self.roles.wall {
            Some(wall) if closed.has(wall) => step,
            Some(_) => step.min(ROUND_CORNER),
            None => step.min(self.reach),
        }
    }

    fn step(&mut self, length: f64) -> Ask {
        self.doing = Doing::Stepping;
        let fall = if self.ended { SwitchSet::EMPTY } else { Roles::set(&[self.roles.wall]) };
        Ask {
            motion: Motion::Move { distance: length, speed: f64::INFINITY },
            guard: Guard {
                rise: Roles::set(&[
                    self.roles.front,
                    self.roles.ahead,
                    self.roles.off,
                    self.roles.across,
                ]),
                fall,
            },
            why: if self.ended { "a step round the corner" } else { "a step along the wall" },
        }
    }

    /// Radius of the body, metres.
    #[must_use]
    pub fn body(&self) -> f64 {
        self.body
    }

    /// The gap at which the wall is followed, metres from the body.
    #[must_use]
    pub fn gap(&self) -> f64 {
        self.gap
    }
}
