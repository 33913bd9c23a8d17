//! What lies on the floor under the map proper: the trajectory and the lines of the plan, drawn thinner
//! the more of them there are, so that a large hall does not fill with them.

use super::super::RunRecord;
use super::super::picture::Frame;
use super::Options;
use super::pens::{self, Pen};
use crate::geometry::Ring;
use crate::mapping::map::stretches;

/// Trajectory and plan each cover no more than this share of the floor, as far as pens can be thinned.
const MOST_COVERED: f64 = 0.08;
/// The thinnest pen, pixels.
const THINNEST: f64 = 0.35;

/// How much thinner than usual lines are drawn, as shares of the usual widths.
#[derive(Debug, Clone, Copy)]
pub(super) struct Background {
    trajectory: f64,
    plan: f64,
}

impl Background {
    /// For a picture of the given map.
    pub(super) fn of(
        record: &RunRecord<'_>,
        options: &Options,
        frame: &Frame,
        wall: Option<&Ring>,
    ) -> Self {
        let sheet = frame.width * frame.height;
        let floor = wall.map_or(sheet, |ring| ring.area().abs() * frame.scale * frame.scale);
        let share = |metres: f64, width: f64| {
            let covered = metres * frame.scale * width;
            // Nothing driven covers nothing.
            (MOST_COVERED * floor / covered.max(1.0)).clamp(THINNEST / width, 1.0)
        };
        let map = record.map;
        let driven: f64 = stretches(&map.path)
            .flat_map(|stretch| stretch.windows(2))
            .map(|pair| (pair[1].pose.position - pair[0].pose.position).norm())
            .sum();
        let drawn = map.plan.iter().flat_map(|plan| pens::of_lines(plan, options));
        let planned: f64 = drawn
            .map(|(line, _)| line.drive.unwrap_or((line.start, line.end)))
            .map(|(from, to)| (to - from).norm())
            .sum();
        Self {
            trajectory: share(driven, pens::TRAJECTORY.width),
            plan: share(planned, pens::OF_PLAN[0].width),
        }
    }

    /// The pen of the trajectory.
    pub(super) fn trajectory(&self) -> Pen {
        pens::TRAJECTORY.thinned(self.trajectory)
    }

    /// A pen of the plan.
    pub(super) fn plan(&self, pen: &Pen) -> Pen {
        pen.thinned(self.plan)
    }
}
