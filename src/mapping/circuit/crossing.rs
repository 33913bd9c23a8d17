//! Where a lap may have come back to its beginning, for each drift that the gyro may have, and what
//! odometry was off by then.

use super::{Anchor, Closure, SHORTEST_LAP};
use crate::geometry::{angle, rotate};
use crate::mapping::drift::Drifting;
use crate::mapping::map::Misclosure;

/// A lap without its drift ends facing this near to where it began, radians: following a wall turns
/// the robot to and fro.
const FACING: f64 = 0.17;

/// A crossing of the line through a place near the beginning.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    pub(super) from: Anchor,
    pub(super) rate: f64,
    /// Where on the step, 0 to 1.
    pub(super) share: f64,
    /// How unlikely it is to be the end of the lap.
    cost: f64,
}

/// Of all crossings of a line through one of `anchors`, for any of `drifts`, the one that is the most
/// likely end of the lap; the robot has driven `travelled` metres by now.
pub(super) fn best<'a>(
    anchors: &[Anchor],
    drifts: impl Iterator<Item = &'a Drifting>,
    travelled: f64,
) -> Option<Crossing> {
    drifts
        .flat_map(|one| anchors.iter().filter_map(|from| crossing(from, one, travelled)))
        .min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Whether the last step closes the lap that began at `anchor`, if the gyro drifts like that.
fn crossing(anchor: &Anchor, step: &Drifting, travelled: f64) -> Option<Crossing> {
    let lap = travelled - anchor.travelled;
    if lap < SHORTEST_LAP {
        return None;
    }
    let behind = anchor.pose.to_local(step.before.position);
    let past = anchor.pose.to_local(step.now.position);
    // The step that began at the anchor does not cross its line, whatever rounding says.
    if behind.x > -1e-6 || past.x < 0.0 {
        return None;
    }
    let share = behind.x / (behind.x - past.x);
    let lateral = behind.y + (past.y - behind.y) * share;
    let heading = step.before.heading + angle::wrap(step.now.heading - step.before.heading) * share;
    let turned = angle::wrap(heading - anchor.pose.heading).abs();
    // Wide enough for the drift of a long lap; whether it is the same place the overlap decides.
    // With a drift taken out, what the gyro walked at random besides is left.
    let gate = if step.rate == 0.0 {
        (0.05 + 0.004 * lap).min(0.4)
    } else {
        (0.05 + 0.007 * lap).min(0.9)
    };
    let facing = if step.rate == 0.0 { (25.0 + 0.1 * lap).min(40.0).to_radians() } else { FACING };
    let cost = (turned / FACING).powi(2) + (lateral / gate).powi(2) + (step.rate / LIKELY).powi(2);
    let near = lateral.abs() < gate && turned < facing;
    near.then_some(Crossing { from: *anchor, rate: step.rate, share, cost })
}

/// What a gyro is likely to drift, radians per second (20 degrees an hour).
const LIKELY: f64 = 1.0e-4;

impl Misclosure {
    /// What odometry was off by in all, of a lap from which a drift was taken out: that, and what was
    /// left of it.
    pub(super) fn with(self, wound: &(Anchor, Anchor), closure: &Closure) -> Self {
        let of = |from: &Anchor, to: &Anchor| {
            (to.pose.position - from.pose.position, to.pose.heading - from.pose.heading)
        };
        let (way, turn) = of(&wound.0, &wound.1);
        let (unwound_way, unwound_turn) = of(&closure.from, &closure.to);
        let back = angle::wrap(wound.0.pose.heading - closure.from.pose.heading);
        let off = way - rotate(unwound_way, back);
        Self {
            dx: self.dx + off.x,
            dy: self.dy + off.y,
            heading: self.heading + angle::wrap(turn - unwound_turn),
            ..self
        }
    }
}
