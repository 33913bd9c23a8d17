//! What the lines of the plan could not sweep: the hidden disc is looked for and driven through, one line
//! at a time, until it is down to α. Geometry and the plan's list of lines; how a line is driven it does not
//! know.

use super::drive::{Drive, best_chord};
use super::{ROOM, Scene, Tour};
use crate::geometry::Point;
use crate::mapping::event::EventKind;
use crate::mapping::map::{LineStatus, PlanLine};

/// The disc is brought this far below α, since the pose is never quite known, metres.
const PROMISE_MARGIN: f64 = 0.045;
/// Extra lines at most, so that a tour always ends.
const MOST_EXTRA: usize = 60;

impl Tour {
    /// A line through the largest disc that is still hidden, if it is too large.
    pub(super) fn extra_line(&mut self, scene: &mut Scene<'_>) -> Option<Drive> {
        let path = scene.tracker.path();
        for point in &path[self.covered..] {
            if self.sure.was_astray(point.time_us) {
                self.coverage.lift();
                continue;
            }
            if point.carried {
                self.coverage.lift();
            }
            self.coverage.push(point.pose.position);
        }
        self.covered = path.len();
        let target = self.alpha - PROMISE_MARGIN;
        let clearance = self.chassis.radius + ROOM;
        let coverage = self.coverage.clone();
        let given_up = self.given_up.clone();
        let extra = self.extra;
        let floor = self.floor(scene.rest.pose.position);
        let (spots, largest) = coverage.spots_and_largest(floor, target.max(0.05));
        scene.map.hidden_disc = Some(largest.map_or(0.0, |disc| disc.diameter));
        scene.map.hidden_at = largest.map(|disc| disc.at);
        if extra >= MOST_EXTRA {
            return None;
        }
        let spot = spots
            .iter()
            .filter(|spot| given_up.iter().all(|p| (p - spot.at).norm() > 0.06))
            .max_by(|a, b| a.diameter.total_cmp(&b.diameter))?;
        let at = spot.at;
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
