//! Where the body really was at the instants of the believed trajectory. This is the one place
//! through which simulator truth comes, on its way to `true_path` in the GeoJSON.

use crate::geometry::{Pose, angle};
use crate::mapping::map::PathPoint;

/// The true pose at each vertex of `path`, from true poses in order of time (microseconds);
/// between two of them it is interpolated, before the first and after the last it is that one.
/// None when nothing is known of the truth.
#[must_use]
pub fn along(path: &[PathPoint], truth: &[(u64, Pose)]) -> Option<Vec<Pose>> {
    if truth.is_empty() {
        return None;
    }
    Some(path.iter().map(|point| at(truth, point.time_us)).collect())
}

fn at(truth: &[(u64, Pose)], time_us: u64) -> Pose {
    let after = truth.partition_point(|&(time, _)| time < time_us);
    let (end, to) = truth[after.min(truth.len() - 1)];
    let (begin, from) = truth[after.saturating_sub(1)];
    if end <= begin || time_us >= end {
        return to;
    }
    let share = time_us.saturating_sub(begin) as f64 / (end - begin) as f64;
    Pose {
        position: from.position + (to.position - from.position) * share,
        heading: angle::wrap(from.heading + angle::wrap(to.heading - from.heading) * share),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mapping::map::Phase;

    fn path(times: &[u64]) -> Vec<PathPoint> {
        let point = |&time_us: &u64| PathPoint {
            rested_us: 0,
            spun: crate::mapping::map::Spun::default(),
            pose: Pose::new(0.0, 0.0, 0.0),
            time_us,
            phase: Phase::Boundary,
            carried: false,
        };
        times.iter().map(point).collect()
    }

    #[test]
    fn the_truth_is_taken_at_the_same_instants() {
        let truth = [
            (10, Pose::new(0.0, 0.0, 3.1)),
            (20, Pose::new(1.0, 2.0, -3.1)),
            (20, Pose::new(1.0, 2.0, -3.1)),
            (40, Pose::new(1.0, 4.0, -3.1)),
        ];
        let found = along(&path(&[5, 10, 15, 20, 30, 50]), &truth).expect("truth");
        let x: Vec<f64> = found.iter().map(|pose| pose.position.x).collect();
        let y: Vec<f64> = found.iter().map(|pose| pose.position.y).collect();
        assert_eq!(x, [0.0, 0.0, 0.5, 1.0, 1.0, 1.0]);
        assert_eq!(y, [0.0, 0.0, 1.0, 2.0, 3.0, 4.0]);
        let halfway = found[2].heading;
        assert!((halfway.abs() - angle::PI).abs() < 1e-9, "turned the long way: {halfway}");
        assert!(along(&path(&[5]), &[]).is_none(), "no truth was made up");
    }
}
