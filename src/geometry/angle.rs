//! Angles and the transcendental functions that go with them, the same bits on every machine.

use super::Vector;
pub use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// The same direction as `angle`, in (-π, π].
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    if angle > -PI && angle <= PI {
        return angle;
    }
    let turned = angle - TAU * (angle / TAU).round();
    if turned <= -PI { turned + TAU } else { turned }
}

/// The same direction as `angle`, in [0, 2π).
#[must_use]
pub fn wrap_positive(angle: f64) -> f64 {
    let turned = angle - TAU * (angle / TAU).floor();
    if turned >= TAU { 0.0 } else { turned }
}

/// Sine of `angle` in radians.
#[must_use]
pub fn sin(angle: f64) -> f64 {
    libm::sin(angle)
}

/// Cosine of `angle` in radians.
#[must_use]
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// Tangent of `angle` in radians.
#[must_use]
pub fn tan(angle: f64) -> f64 {
    libm::tan(angle)
}

/// Arc sine; the argument is clamped to [-1, 1], so rounding never makes it not a number.
#[must_use]
pub fn asin(sine: f64) -> f64 {
    libm::asin(sine.clamp(-1.0, 1.0))
}

/// Arc cosine; the argument is clamped to [-1, 1], so rounding never makes it not a number.
#[must_use]
pub fn acos(cosine: f64) -> f64 {
    libm::acos(cosine.clamp(-1.0, 1.0))
}

/// Arc tangent.
#[must_use]
pub fn atan(slope: f64) -> f64 {
    libm::atan(slope)
}

/// Direction of (x, y), in (-π, π].
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Length of (x, y).
#[must_use]
pub fn hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// Unit vector in the direction `angle`.
#[must_use]
pub fn unit(angle: f64) -> Vector {
    let (sine, cosine) = libm::sincos(angle);
    Vector::new(cosine, sine)
}

/// Direction of `v`, in (-π, π].
#[must_use]
pub fn of(v: Vector) -> f64 {
    libm::atan2(v.y, v.x)
}

/// The widest angle between two of the `bearings` (radians, in (-π, π]) that are next to each other all the
/// way round; a whole turn where there are none.
#[must_use]
pub fn widest_gap(mut bearings: Vec<f64>) -> f64 {
    bearings.sort_by(f64::total_cmp);
    let around = match bearings[..] {
        [first, .., last] => first + TAU - last,
        _ => TAU,
    };
    bearings.windows(2).map(|two| two[1] - two[0]).fold(around, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_widest_gap_may_lie_across_the_back() {
        assert!((widest_gap(vec![0.5, -1.0, 1.0]) - (TAU - 2.0)).abs() < 1e-12);
        assert!((widest_gap(vec![3.0, 0.0, -3.0]) - 3.0).abs() < 1e-12);
        assert_eq!(widest_gap(vec![0.3]), TAU);
        assert_eq!(widest_gap(Vec::new()), TAU);
    }

    #[test]
    fn wrap_keeps_the_direction_and_the_range() {
        for k in -50..=50 {
            let angle = f64::from(k) * 0.37;
            let wrapped = wrap(angle);
            assert!(wrapped > -PI && wrapped <= PI, "{angle} became {wrapped}");
            assert!((unit(angle) - unit(wrapped)).norm() < 1e-12, "{angle} became {wrapped}");
            let positive = wrap_positive(angle);
            assert!((0.0..TAU).contains(&positive), "{angle} became {positive}");
            assert!((unit(angle) - unit(positive)).norm() < 1e-12, "{angle} became {positive}");
        }
        assert_eq!(wrap(PI), PI);
        assert!((wrap(-PI) - PI).abs() < 1e-15, "{}", wrap(-PI));
    }
}
