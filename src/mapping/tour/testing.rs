//! A room with its plan and a robot in it, for the tests of the tour.

use crate::geometry::{Point, Pose, Ring};
use crate::mapping::floor::Coverage;
use crate::mapping::map::{LineStatus, PathPoint, Phase, RoomMap, Spun};
use crate::mapping::odometry::Tracker;
use crate::mapping::plan::{self, PlanRequest};
use crate::mapping::settings::Settings;
use crate::mapping::shape;

/// A room 3 m long and 1 m wide, along which the robot went `aside` metres from a wall; with the lines of
/// its plan driven, for all that is believed.
pub(super) fn room_gone_along(aside: f64) -> (Settings, RoomMap, Tracker) {
    let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 1.0), (0.0, 1.0)];
    let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
    let shape = shape::identify(outline, &[]);
    let settings = Settings::new(Pose::new(0.16, aside, 0.0));
    let mut plan = plan::make(&PlanRequest {
        shape: &shape,
        objects: &[],
        driven: &Coverage::new(),
        from: settings.start.position,
        settings: &settings,
    });
    for line in &mut plan.lines {
        line.status = LineStatus::Driven;
    }
    let (shape, plan) = (Some(shape), Some(plan));
    let map = RoomMap { shape, plan, hidden_disc: Some(0.1), ..RoomMap::default() };
    let mut tracker = Tracker::new(&settings.chassis, settings.start);
    tracker.path_mut().extend((0..=268_u32).map(|k| PathPoint {
        pose: Pose::new(0.16 + f64::from(k) * 0.01, aside, 0.0),
        time_us: u64::from(k) * 50_000,
        rested_us: 0,
        spun: Spun::default(),
        phase: Phase::Objects,
        carried: false,
    }));
    (settings, map, tracker)
}
