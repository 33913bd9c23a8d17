//! What the lines of the plan could not sweep: the hidden disc is looked for and driven through, one line
//! at a time, until it is down to α. Geometry and the plan's list of lines; how a line is driven it does not
//! know.

use super::drive::{Drive, best_chord};
use super::{ROOM, Scene, Tour};
use crate::geometry::{Point, Ring};
use crate::mapping::event::EventKind;
use crate::mapping::floor::{Coverage, Floor, HiddenDisc};
use crate::mapping::map::{LineStatus, PathPoint, PlanLine, RoomMap};
use crate::mapping::odometry::Tracker;

/// The disc is brought this far below α, since the pose is never quite known, metres.
const PROMISE_MARGIN: f64 = 0.045;
/// Extra lines at most, so that a tour always ends.
const MOST_EXTRA: usize = 60;

impl Tour {
    /// Adds what the body swept along `path`, where it was sure to be there.
    fn sweep(&self, path: &[PathPoint], coverage: &mut Coverage) {
        for point in path {
            if self.sure.was_astray(point.time_us) {
                coverage.lift();
                continue;
            }
            if point.carried {
                coverage.lift();
            }
            coverage.push(point.pose.position);
        }
    }

    /// Measures anew what is hidden on the `map`, now that all of it was adjusted: the trajectory went
    /// elsewhere than was believed when it was driven.
    pub fn measure_hidden(&self, tracker: &Tracker, map: &mut RoomMap) {
        let (Some(_), Some(shape)) = (map.hidden_disc, &map.shape) else { return };
        let objects: Vec<&Ring> = map.objects.iter().map(|object| &object.outline).collect();
        let from = tracker.pose().position;
        let floor = Floor::new(&shape.outline, &objects, &self.chassis, from);
        let mut coverage = Coverage::new();
        self.sweep(tracker.path(), &mut coverage);
        let (_, largest) = coverage.spots_and_largest(&floor, self.alpha);
        map.hidden_disc = Some(largest.map_or(0.0, |disc| disc.diameter));
        map.hidden_at = largest.map(|disc| disc.at);
    }

    /// The discs that are still hidden and too large, largest first; the map is told of the largest that is left.
    fn still_hidden(&mut self, scene: &mut Scene<'_>) -> Vec<HiddenDisc> {
        let path = scene.tracker.path();
        let mut coverage = std::mem::replace(&mut self.coverage, Coverage::new());
        self.sweep(&path[self.covered..], &mut coverage);
        self.covered = path.len();
        let target = self.alpha - PROMISE_MARGIN;
        let floor = self.floor(scene.rest.pose.position);
        let (spots, largest) = coverage.spots_and_largest(floor, target.max(0.05));
        self.coverage = coverage;
        scene.map.hidden_disc = Some(largest.map_or(0.0, |disc| disc.diameter));
        scene.map.hidden_at = largest.map(|disc| disc.at);
        spots
    }

    /// A line through the largest disc that is still hidden, if it is too large.
    pub(super) fn extra_line(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        let spots = self.still_hidden(scene);
        if self.extra >= MOST_EXTRA {
            return None;
        }
        let spot = spots
            .iter()
            .filter(|spot| self.given_up.iter().all(|p| (p - spot.at).norm() > 0.06))
            .max_by(|a, b| a.diameter.total_cmp(&b.diameter))?;
        let at = spot.at;
        let clearance = self.chassis.radius + ROOM;
        let floor = self.floor(scene.rest.pose.position);
        let chord = best_chord(floor, at, spot.diameter, clearance);
        self.extra += 1;
        self.given_up.push(at);
        let (from, to) = chord.unwrap_or((at, at));
        let near = |p: &Point| (p - scene.rest.pose.position).norm();
        let (from, to) = if near(&to) < near(&from) { (to, from) } else { (from, to) };
        let plan = scene.map.plan.as_mut()?;
        let id = plan.lines.iter().map(|line| line.id).max().unwrap_or(0) + 1;
        plan.lines.push(PlanLine {
            id,
            part: 0,
            vertex: 0,
            start: from,
            end: to,
            angle: 0.0,
            drive: Some((from, to)),
            status: LineStatus::Driving,
            reason: None,
        });
        scene.tell.push(EventKind::LineBegan { id, backwards: false });
        Some(Drive::new(id, from, to))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::super::testing::room_gone_along;
    use super::*;
    use crate::mapping::follow::AtRest;
    use crate::mapping::survey::Survey;
    use crate::robot::{DoneReason, SwitchSet};

    /// What is hidden there.
    fn hidden(aside: f64) -> f64 {
        let (settings, mut map, tracker) = room_gone_along(aside);
        let tour = Tour::new(&settings, &map, &Survey::new(0.003));
        tour.measure_hidden(&tracker, &mut map);
        map.hidden_disc.expect("measured")
    }

    #[test]
    fn what_is_hidden_is_measured_where_the_robot_has_been_after_all() {
        // The switches reach 0.16 m to either side.
        let (along_the_middle, nearer_to_one_wall) = (hidden(0.5), hidden(0.3));
        assert!((along_the_middle - 0.34).abs() < 0.02, "{along_the_middle}");
        assert!((nearer_to_one_wall - 0.54).abs() < 0.02, "{nearer_to_one_wall}");
    }

    #[test]
    fn of_the_rest_what_is_hidden_is_driven_through_and_no_line_again() {
        let (settings, mut map, mut tracker) = room_gone_along(0.3);
        let mut survey = Survey::new(0.003);
        survey.mark(settings.start.position, 0);
        let lines = map.plan.as_ref().map_or(0, |plan| plan.lines.len());
        let mut tour = Tour::new(&settings, &map, &survey).of_the_rest(&settings, &map, &survey);
        assert!((tour.share() - 1.0).abs() < 1e-9, "the plan itself is driven");
        let mut told = Vec::new();
        let rest =
            AtRest { pose: settings.start, closed: SwitchSet::EMPTY, reason: DoneReason::Complete };
        let next = tour.next(&mut Scene {
            tracker: &mut tracker,
            survey: &mut survey,
            rest,
            map: &mut map,
            tell: &mut told,
        });
        assert!(matches!(next, Turn::Go(_)));
        let begun: Vec<_> = told
            .iter()
            .filter_map(|kind| match kind {
                EventKind::LineBegan { id, .. } => Some(*id as usize),
                _ => None,
            })
            .collect();
        assert_eq!(begun, [lines + 1], "a line of its own: {told:?}");
    }
}
