//! Least-squares lines and circles from running sums, so that a fit over one more point costs
//! the same however many there are already. Knows nothing of where the points come from.

use super::{Point, Vector, angle};

/// Weighted sums over points, up to the fourth order, about a fixed origin near the points.
#[derive(Debug, Clone, Copy)]
pub struct Moments {
    origin: Point,
    weight: f64,
    x: f64,
    y: f64,
    xx: f64,
    xy: f64,
    yy: f64,
    xz: f64,
    yz: f64,
    zz: f64,
}

/// A straight fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineFit {
    /// The weighted mean of the points, which lies on the line.
    pub center: Point,
    /// Unit direction; its sign is arbitrary.
    pub direction: Vector,
    /// Weighted sum of squared distances of the points from the line, square metres.
    pub residual: f64,
}

/// A circular fit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircleFit {
    /// Centre.
    pub center: Point,
    /// Radius, metres.
    pub radius: f64,
    /// Weighted sum of squared distances of the points from the circle (to first order), square
    /// metres.
    pub residual: f64,
}

/// Sums about the mean of the points: all that the fits need.
struct Central {
    mean: Vector,
    xx: f64,
    xy: f64,
    yy: f64,
    xz: f64,
    yz: f64,
    zz: f64,
}

impl Moments {
    /// No points yet; `origin` should lie near those to come, or precision is lost.
    #[must_use]
    pub fn new(origin: Point) -> Self {
        Self {
            origin,
            weight: 0.0,
            x: 0.0,
            y: 0.0,
            xx: 0.0,
            xy: 0.0,
            yy: 0.0,
            xz: 0.0,
            yz: 0.0,
            zz: 0.0,
        }
    }

    /// The sums over all of `points`, each with weight one.
    #[must_use]
    pub fn of(points: &[Point]) -> Self {
        let mut moments = Self::new(points.first().copied().unwrap_or_else(Point::origin));
        for &p in points {
            moments.add(p, 1.0);
        }
        moments
    }

    /// One more point.
    pub fn add(&mut self, p: Point, weight: f64) {
        let v = p - self.origin;
        let z = v.norm_squared();
        self.weight += weight;
        self.x += weight * v.x;
        self.y += weight * v.y;
        self.xx += weight * v.x * v.x;
        self.xy += weight * v.x * v.y;
        self.yy += weight * v.y * v.y;
        self.xz += weight * v.x * z;
        self.yz += weight * v.y * z;
        self.zz += weight * z * z;
    }

    fn central(&self) -> Central {
        let n = self.weight;
        let (mx, my) = (self.x / n, self.y / n);
        let square = mx * mx + my * my;
        let z = self.xx + self.yy;
        let (sx, sy) = (self.x, self.y);
        let across = |sum_cz: f64, cx: f64, cy: f64, sum_c: f64, mean: f64| {
            let whole = sum_cz - 2.0 * mx * cx - 2.0 * my * cy + square * sum_c;
            whole - mean * (z - 2.0 * mx * sx - 2.0 * my * sy + n * square)
        };
        Central {
            mean: Vector::new(mx, my),
            xx: self.xx - n * mx * mx,
            xy: self.xy - n * mx * my,
            yy: self.yy - n * my * my,
            xz: across(self.xz, self.xx, self.xy, sx, mx),
            yz: across(self.yz, self.xy, self.yy, sy, my),
            zz: self.zz + 4.0 * mx * mx * self.xx + 4.0 * my * my * self.yy + n * square * square
                - 4.0 * mx * self.xz
                - 4.0 * my * self.yz
                + 2.0 * square * z
                + 8.0 * mx * my * self.xy
                - 4.0 * square * (mx * sx + my * sy),
        }
    }

    /// The line of total least squares; none for fewer than two distinct points.
    #[must_use]
    pub fn line(&self) -> Option<LineFit> {
        if self.weight <= 0.0 {
            return None;
        }
        let c = self.central();
        let half = (c.xx - c.yy) / 2.0;
        let spread = angle::hypot(half, c.xy);
        let middle = f64::midpoint(c.xx, c.yy);
        if middle + spread < 1e-12 {
            return None;
        }
        // The eigenvector of the larger eigenvalue, from whichever form does not cancel.
        let along = if half >= 0.0 {
            Vector::new(half + spread, c.xy)
        } else {
            Vector::new(c.xy, spread - half)
        };
        let direction = along.try_normalize(0.0).unwrap_or_else(Vector::x);
        Some(LineFit {
            center: self.origin + c.mean,
            direction,
            residual: (middle - spread).max(0.0),
        })
    }

    /// The circle of Taubin's algebraic fit; none where the points lie on a line.
    #[must_use]
    pub fn circle(&self) -> Option<CircleFit> {
        if self.weight <= 0.0 {
            return None;
        }
        let c = self.central();
        let n = self.weight;
        let (mxx, mxy, myy) = (c.xx / n, c.xy / n, c.yy / n);
        let (mxz, myz, mzz) = (c.xz / n, c.yz / n, c.zz / n);
        let mz = mxx + myy;
        let det = mxx * myy - mxy * mxy;
        let var_z = mzz - mz * mz;
        // Taubin's characteristic cubic, by Newton's method from zero (Chernov 2010, section 5.10).
        let a3 = 4.0 * mz;
        let a2 = -3.0 * mz * mz - mzz;
        let a1 = var_z * mz + 4.0 * det * mz - mxz * mxz - myz * myz;
        let a0 = mxz * (mxz * myy - myz * mxy) + myz * (myz * mxx - mxz * mxy) - var_z * det;
        let mut root = 0.0;
        let mut value = f64::INFINITY;
        for _ in 0..20 {
            let now = a0 + root * (a1 + root * (a2 + root * a3));
            let slope = a1 + root * (2.0 * a2 + 3.0 * root * a3);
            if now.abs() > value || slope == 0.0 {
                break;
            }
            value = now.abs();
            let step = now / slope;
            root -= step;
            if step.abs() <= 1e-12 * root.abs() || !root.is_finite() {
                break;
            }
        }
        let scale = 2.0 * (root * root - root * mz + det);
        if scale.abs() < 1e-15 * mz * mz || !root.is_finite() {
            return None;
        }
        let a = (mxz * (myy - root) - myz * mxy) / scale;
        let b = (myz * (mxx - root) - mxz * mxy) / scale;
        let radius = (a * a + b * b + mz).sqrt();
        let k = a * a + b * b - radius * radius;
        let square =
            mzz + 4.0 * a * a * mxx + 4.0 * b * b * myy + k * k - 4.0 * a * mxz - 4.0 * b * myz
                + 2.0 * k * mz
                + 8.0 * a * b * mxy;
        (radius.is_finite() && radius < 1e6).then(|| CircleFit {
            center: self.origin + c.mean + Vector::new(a, b),
            radius,
            residual: (n * square / (4.0 * radius * radius)).max(0.0),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_away_line_is_found_with_its_residual() {
        let direction = angle::unit(2.2);
        let normal = crate::geometry::perp(direction);
        let points: Vec<Point> = (0..40)
            .map(|k| {
                let off = if k % 2 == 0 { 0.001 } else { -0.001 };
                Point::new(25.0, -31.0) + direction * (f64::from(k) * 0.05) + normal * off
            })
            .collect();
        let fit = Moments::of(&points).line().unwrap();
        let tilt = crate::geometry::cross(fit.direction, direction).abs();
        assert!(tilt < 1e-3, "tilt {tilt}");
        assert!((fit.residual - 40e-6).abs() < 1e-6, "{}", fit.residual);
    }

    #[test]
    fn a_far_away_arc_is_found_with_its_residual() {
        let center = Point::new(28.0, 19.0);
        for (radius, span) in [(0.3, 1.0), (2.0, 0.5), (5.0, 6.2)] {
            let points: Vec<Point> = (0..60)
                .map(|k| {
                    let off = if k % 2 == 0 { 0.0005 } else { -0.0005 };
                    center + angle::unit(1.0 + span * f64::from(k) / 60.0) * (radius + off)
                })
                .collect();
            let fit = Moments::of(&points).circle().unwrap();
            assert!((fit.center - center).norm() < 0.01 * radius, "{fit:?}");
            assert!((fit.radius - radius).abs() < 0.01 * radius, "{fit:?}");
            assert!((fit.residual - 60.0 * 25e-8).abs() < 2e-6, "{fit:?}");
        }
    }

    #[test]
    fn points_on_a_line_make_no_small_circle() {
        let points: Vec<Point> = (0..9).map(|k| Point::new(f64::from(k) * 0.1, 1.0)).collect();
        let fit = Moments::of(&points).circle();
        assert!(fit.is_none_or(|c| c.radius > 1e3), "{fit:?}");
        assert!(Moments::of(&points[..1]).line().is_none());
    }
}
