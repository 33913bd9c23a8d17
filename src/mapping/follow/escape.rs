//! What the follower does where it cannot go on along the wall: off what it bumped into, out of a gap that
//! is too narrow, out of where it is held. Which of these it is in, the follower decides.

use super::roles::Roles;
use super::{Ask, AtRest, Doing, Follower, SHORTEST_STRIDE};
use crate::geometry::{Point, angle};
use crate::mapping::lay::Seen;
use crate::mapping::wall::Wall;
use crate::robot::{Guard, Motion};

/// Out of a gap that is too narrow the robot backs this far, metres.
const BACK_OUT: f64 = 0.12;
/// Bars are looked at within this, metres.
const NEAR: f64 = 0.6;

impl Follower {
    pub(super) fn back_off(&mut self) -> Ask {
        self.doing = Doing::BackingOff;
        self.stride = SHORTEST_STRIDE;
        Ask {
            motion: Motion::Move { distance: -0.03, speed: f64::INFINITY },
            guard: Guard { rise: Roles::set(&[self.roles.back]), ..Guard::default() },
            why: "touched something: backing off",
        }
    }

    /// Whether to go no deeper into a gap with both sides within the switches' reach. What leads out of
    /// it again on the other hand would find it too narrow, so it is never entered; but a robot that
    /// stands between has to go on somewhere, and where it came in it gets out.
    ///
    /// A gap just as wide as the reach may be found too narrow the one time and not the other. On one way
    /// round it stays what it was, or the robot would be led on to the other side of it and never back:
    /// gone through, it is gone through again; refused, it is barred.
    pub(super) fn refuses(&mut self, rest: &AtRest) -> bool {
        if self.squeezing || !self.roles.wall.is_some_and(|wall| rest.closed.has(wall)) {
            return false;
        }
        // As far ahead as it would back out, and as far behind.
        let off = rest.pose.direction() * BACK_OUT;
        let (ahead, behind) = (rest.pose.position + off, rest.pose.position - off);
        let leads_on = self.held.comes_from(ahead) || self.held.went_through(behind, ahead);
        !leads_on && self.held.refuses(rest.pose.position)
    }

    /// The gap that the robot refuses, between the wall at its hand and what `sensor` saw across, is closed
    /// to it.
    pub(super) fn bar(&mut self, wall: &Wall, sensor: usize, rest: &AtRest) {
        let across = wall.near().rev().find(|seen| seen.sensor == Some(sensor));
        let Some(across) = across.map(|seen| seen.point) else { return };
        let hand = rest.pose.heading + self.side.sign() * angle::FRAC_PI_2;
        let beside = rest.pose.position + angle::unit(hand) * (self.body + self.gap);
        self.held.bar(beside, across);
    }

    /// What bars the gaps near the robot.
    pub(super) fn bars(&self, rest: &AtRest) -> impl Iterator<Item = Seen> {
        let here = rest.pose.position;
        let near = move |bar: &Point| (bar - here).norm() < NEAR;
        let bars = self.held.bars().filter(move |bar| !self.squeezing && near(bar));
        bars.map(move |at| Seen { at, towards: here - at })
    }

    /// Bumped again and again in one place, the robot is held between things, and every step it thinks
    /// free leads it against one of them. The way it came was free: it leaves by that, its back first,
    /// where no bumper is held by what it touches.
    pub(super) fn leave(&mut self, rest: &AtRest) -> Option<Ask> {
        let here = rest.pose.position;
        let inward = angle::of(here - self.held.bump(here)?);
        self.doing = Doing::Leaving;
        Some(Ask {
            motion: Motion::Turn {
                angle: angle::wrap(inward - rest.pose.heading),
                rate: f64::INFINITY,
            },
            guard: Guard::default(),
            why: "held between things: leaving by the way it came",
        })
    }

    pub(super) fn back_out(&mut self, why: &'static str) -> Ask {
        self.doing = Doing::BackingOff;
        self.stride = SHORTEST_STRIDE;
        Ask {
            motion: Motion::Move { distance: -BACK_OUT, speed: f64::INFINITY },
            guard: Guard { rise: Roles::set(&[self.roles.back]), ..Guard::default() },
            why,
        }
    }
}
