//! Driving one line: from way point to way point, with what is met on the way told apart; and how a
//! line ends.

use super::drive::{Aim, Drive, Purpose};
use super::{Doing, MOST_BUMPS, REACHED, ROOM, Scene, Tour, finish};
use crate::geometry::{Point, angle};
use crate::mapping::event::EventKind;
use crate::mapping::follow::{Ask, AtRest, STRIDE};
use crate::mapping::map::{LineReason, LineStatus};
use crate::mapping::survey::Survey;
use crate::mapping::wall::Sighting;
use crate::robot::{DoneReason, Guard, Motion, SwitchSet};
use std::collections::VecDeque;

/// Of a line that is not driven from end to end, no less than this is spoken of, metres.
const NOTED: f64 = 0.05;

/// Stopped so near to where the line before was given up, metres, by what the map has elsewhere, the robot is not
/// where it believes it is ...
const SAME_STOP: f64 = 0.1;
/// ... and if it was, and is stopped again no farther off than this, metres, a thing is mapped too small.
const TOO_SMALL: f64 = 0.6;

/// Where lines were given up because what is mapped stopped the robot.
#[derive(Debug, Clone, Default)]
pub(super) struct Stops {
    last: Option<Point>,
    /// Where that made it doubt its place.
    odd: Vec<Point>,
}

impl Stops {
    /// One more, and whether that says that the robot is somewhere else.
    fn are_odd(&mut self, here: Point) -> bool {
        let near = |p: &Point, within: f64| (p - here).norm() < within;
        let again = self.last.replace(here).is_some_and(|p| near(&p, SAME_STOP));
        let odd = again && !self.odd.iter().any(|p| near(p, TOO_SMALL));
        if odd {
            self.odd.push(here);
        }
        odd
    }
}

impl Tour {
    pub(super) fn drive(
        &mut self,
        mut drive: Box<Drive>,
        reason: Option<DoneReason>,
        scene: &mut Scene<'_>,
    ) -> Option<Ask> {
        // Wherever it has to leave the line, it goes on from there.
        if reason.is_some() {
            self.driven += drive.come_to(scene.rest.pose.position);
        }
        match reason {
            Some(DoneReason::Guard { sensor, rising: true }) => {
                if let Some(seen) =
                    self.wall.log().iter().rev().find(|s| s.sensor == Some(sensor)).copied()
                {
                    let fixed = self.fixed_by == Some(seen.time_us);
                    if !fixed && !self.is_charted(scene.survey, seen.point) {
                        let name = self.chassis.sensors[sensor].name.clone();
                        let bearing = self.chassis.sensors[sensor].angle;
                        return self.meet(drive, seen, bearing, name, scene);
                    }
                    if self.chart.distance(seen.point).1.is_none() {
                        scene.tell.push(EventKind::NearBoundary);
                    }
                }
            }
            Some(DoneReason::Bumper | DoneReason::Stalled) => return self.bumped(drive, scene),
            _ => {}
        }
        if reason == Some(DoneReason::Complete)
            && drive.purpose == Purpose::Line
            && let Some(bearings) = self.bearings_under_way(drive.stops, scene)
        {
            drive.stops += 1;
            drive.way.clear();
            self.suspended = Some(drive);
            self.doing = Doing::Driving(Box::new(bearings));
            return None;
        }
        if drive.way.is_empty() && !self.plan_piece(&mut drive, scene.rest.pose.position) {
            match drive.purpose {
                Purpose::Line => {}
                Purpose::Bearings => {
                    self.doing = Doing::Choosing;
                    if !drive.left_out.is_some() {
                        self.begin_to_feel(scene);
                    }
                    return None;
                }
                Purpose::Tie => {
                    self.doing = Doing::Choosing;
                    if !drive.left_out.is_some() {
                        self.begin_shuttle();
                    }
                    return None;
                }
            }
            let why = drive.left_out.reason();
            let status = if why.is_some() { LineStatus::Blocked } else { LineStatus::Driven };
            self.end_line(&drive, status, why, scene);
            return None;
        }
        self.towards(drive, &scene.rest)
    }

    /// Something stopped the robot: what is not mapped is gone round, and before what is mapped it backs off, so often.
    fn bumped(&mut self, mut drive: Box<Drive>, scene: &mut Scene<'_>) -> Option<Ask> {
        drive.bumps += 1;
        let seen = self.wall.log().last().copied();
        if let Some(seen) = seen
            && !self.is_charted(scene.survey, seen.point)
        {
            return self.meet(drive, seen, 0.0, "bumper".to_owned(), scene);
        }
        if drive.bumps < MOST_BUMPS {
            self.doing = Doing::BackingOff(drive);
            return Some(Ask {
                motion: Motion::Move { distance: -0.04, speed: f64::INFINITY },
                guard: Guard::default(),
                why: "touched something mapped: backing off",
            });
        }
        let here = scene.rest.pose.position;
        if self.stops.are_odd(here) && self.may_doubt_again() {
            self.doing = Doing::Driving(drive);
            self.go_astray(here, None, scene);
            return None;
        }
        let wall = |seen: Sighting| self.chart.distance(seen.point).1.is_none();
        let why =
            if seen.is_some_and(wall) { LineReason::NoClearance } else { LineReason::ObjectOnLine };
        self.end_line(&drive, LineStatus::Blocked, Some(why), scene);
        None
    }

    /// Whether a contact at `p` is of something mapped, as far as is known.
    fn is_charted(&self, survey: &Survey, p: Point) -> bool {
        let (distance, whose) = self.chart.distance(p);
        distance < self.chart.tolerance(survey, p, whose)
    }

    /// The next motion towards the next way point; none when it was reached.
    fn towards(&mut self, mut drive: Box<Drive>, rest: &AtRest) -> Option<Ask> {
        while let Some(&goal) = drive.way.front() {
            let off = goal - rest.pose.position;
            let distance = off.norm();
            if distance > REACHED {
                let turn = angle::wrap(angle::of(off) - rest.pose.heading);
                let on_line = drive.aim == Aim::Line;
                let slack = (0.004 / distance).clamp(0.008, 0.2);
                let ask = if turn.abs() > slack {
                    Ask {
                        motion: Motion::Turn { angle: turn, rate: f64::INFINITY },
                        guard: Guard::default(),
                        why: if on_line { "facing along the line" } else { "facing along the way" },
                    }
                } else {
                    let distance = distance.min(STRIDE);
                    Ask {
                        motion: Motion::Move { distance, speed: f64::INFINITY },
                        guard: Guard { rise: self.watched(), fall: SwitchSet::EMPTY },
                        why: if on_line { "driving the line" } else { "on the way to the line" },
                    }
                };
                self.doing = Doing::Driving(drive);
                return Some(ask);
            }
            drive.way.pop_front();
            if drive.way.is_empty() && drive.aim == Aim::Line {
                self.driven += drive.piece_end - drive.done;
                drive.done = drive.piece_end;
            }
        }
        self.doing = Doing::Driving(drive);
        None
    }

    /// All switches but those that look back.
    fn watched(&self) -> SwitchSet {
        self.chassis
            .sensors
            .iter()
            .enumerate()
            .fold(SwitchSet::EMPTY, |set, (index, mount)| set.with(index, mount.angle.abs() < 1.8))
    }

    /// Finds the next free piece of the line, or the way to it; false when the line is done with.
    fn plan_piece(&mut self, drive: &mut Drive, at: Point) -> bool {
        let clearance = self.chassis.radius + ROOM;
        let length = (drive.to - drive.from).norm();
        let floor = self.floor(at);
        for _ in 0..40 {
            let Some((begin, end)) = drive.free_piece(floor, clearance - 0.004) else {
                if length - drive.done > NOTED {
                    drive.leave_out(drive.done, length, floor, clearance);
                } else if drive.has_lost_its_spot() {
                    drive.left_out.cut_off();
                }
                return false;
            };
            if begin - drive.done > NOTED {
                drive.leave_out(drive.done, begin, floor, clearance);
            }
            let (first, last) = (drive.at(begin), drive.at(end));
            drive.done = begin;
            if (first - at).norm() < 2.0 * REACHED {
                drive.way = VecDeque::from([last]);
                drive.aim = Aim::Line;
                drive.piece_end = end;
                return true;
            }
            if let Some(way) = floor.route(at, first, clearance - 0.01) {
                drive.way = way.into_iter().skip(1).collect();
                drive.aim = Aim::Way;
                return true;
            }
            drive.left_out.cut_off();
            drive.done = end + 0.01;
        }
        false
    }

    pub(super) fn end_line(
        &mut self,
        drive: &Drive,
        status: LineStatus,
        reason: Option<LineReason>,
        scene: &mut Scene<'_>,
    ) {
        self.doing = Doing::Choosing;
        if drive.purpose != Purpose::Line {
            return;
        }
        self.driven += ((drive.to - drive.from).norm() - drive.done).max(0.0);
        let line =
            scene.map.plan.as_mut().and_then(|p| p.lines.iter_mut().find(|l| l.id == drive.id));
        if let Some(line) = line {
            finish(line, status, reason);
            self.sure.ended(drive.id, drive.backwards, scene.tracker.time_us());
        }
        scene.tell.push(match reason {
            None => EventKind::LineDriven { id: drive.id },
            Some(reason) => EventKind::LineEnded { id: drive.id, reason },
        });
        if drive.again {
            // Two-pass contour: the same line the other way, with the object on the same hand.
            self.queue.push_front((drive.id, !drive.backwards));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::super::testing::room_gone_along;
    use super::*;
    use crate::mapping::map::PlanLine;

    #[test]
    fn stops_are_odd_where_two_in_a_row_are_in_one_place_and_once_there() {
        let mut stops = Stops::default();
        let odd = [0.0, 0.5, 0.52, 0.5, 0.55, 3.0, 3.05].map(|x| stops.are_odd(Point::new(x, 0.0)));
        assert_eq!(odd, [false, false, true, false, false, false, true]);
    }

    #[test]
    fn a_robot_that_mapped_things_stop_twice_in_one_place_is_not_where_it_believes() {
        let (settings, mut map, mut tracker) = room_gone_along(0.3);
        let mut survey = Survey::new(0.003);
        survey.mark(settings.start.position, 0);
        let lines = map.plan.iter_mut().flat_map(|plan| &mut plan.lines);
        lines.for_each(|line: &mut PlanLine| line.status = LineStatus::Planned);
        let mut tour = Tour::new(&settings, &map, &survey);
        let (mut told, mut reason) = (Vec::new(), DoneReason::Complete);
        // Whatever it sets out for, something stops it, and nothing that would be new is seen.
        let astray = (0..100).any(|_| {
            let rest = AtRest { pose: settings.start, closed: SwitchSet::EMPTY, reason };
            let scene = &mut Scene {
                tracker: &mut tracker,
                survey: &mut survey,
                rest,
                map: &mut map,
                tell: &mut told,
            };
            let turn = tour.next(scene);
            reason = DoneReason::Stalled;
            matches!(turn, Turn::Astray(_))
        });
        let ended = told.iter().filter(|kind| matches!(kind, EventKind::LineEnded { .. })).count();
        assert!(astray && ended == 1, "{told:?}");
    }
}
