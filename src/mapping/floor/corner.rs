//! How deep the body reaches into corners: the floor that it touches ends in arcs of its own
//! radius around the last places where its centre can be.

use super::Floor;
use crate::geometry::{Point, Segment, Vector, cross, meeting};

/// Places on the rim of the centre's floor are accepted this much short of the radius, metres.
const ROUNDING: f64 = 1e-7;

impl Floor {
    /// Whether the centre can be within the body's radius of `p` or of a place close to it, as far
    /// as the raster tells: where the raster's maximum lies, the true one need not.
    pub(super) fn touches_near(&self, p: Point) -> bool {
        self.any_touchable(p, self.radius + 3.0 * self.grid.cell)
    }

    fn any_touchable(&self, p: Point, radius: f64) -> bool {
        let mut found = false;
        let grid = &self.grid;
        grid.stadium_runs(&Segment::new(p, p), radius, |row, first, last| {
            let row = row * grid.width;
            found |= self.touchable[row + first..=row + last].contains(&true);
        });
        found
    }

    /// The corner around `p`, good for places within [`Corner::SPAN`] of it.
    pub(super) fn corner(&self, p: Point) -> Corner {
        let span = 2.0 * self.radius + Corner::SPAN;
        let mut near: Vec<usize> = Vec::new();
        self.walls.near(&Segment::new(p, p), span, |k| near.push(k));
        near.sort_unstable();
        near.dedup();
        let walls: Vec<Segment> = near
            .into_iter()
            .map(|k| self.walls.segments()[k])
            .filter(|wall| wall.distance_squared(p) < span * span)
            .collect();
        let mut corner = Corner {
            around: p,
            radius: self.radius,
            curves: curves(&walls, self.radius),
            walls,
            tips: Vec::new(),
        };
        corner.find_tips(self);
        corner
    }
}

/// The walls around one place, and what of the centre's floor they leave.
pub(super) struct Corner {
    around: Point,
    radius: f64,
    walls: Vec<Segment>,
    /// What bounds the centre's floor: walls moved inwards, circles around their ends.
    curves: Vec<Curve>,
    /// Where two of those meet on its rim.
    tips: Vec<Point>,
}

impl Corner {
    /// How far from its middle a corner can be asked, metres.
    const SPAN: f64 = 0.06;

    /// Whether `p` is close enough to be asked about.
    pub(super) fn covers(&self, p: Point) -> bool {
        (p - self.around).norm_squared() < Self::SPAN * Self::SPAN
    }

    /// Distance from `p`, where the body cannot be centred, to the nearest place that it cannot
    /// touch, metres: its radius less the way from `p` to the nearest place of the centre.
    /// Negative where it cannot touch.
    pub(super) fn depth(&self, p: Point) -> f64 {
        let far = self.radius + 0.05;
        let mut best = far * far;
        for tip in &self.tips {
            best = best.min((tip - p).norm_squared());
        }
        for curve in &self.curves {
            let foot = curve.nearest(p);
            let off = (foot - p).norm_squared();
            if off < best && self.fits(foot) {
                best = off;
            }
        }
        self.radius - best.sqrt()
    }

    fn fits(&self, q: Point) -> bool {
        let room = self.radius - ROUNDING;
        self.walls.iter().all(|wall| wall.distance_squared(q) >= room * room)
    }

    fn find_tips(&mut self, floor: &Floor) {
        let span = self.radius + Self::SPAN;
        let mut tips = Vec::new();
        for (k, a) in self.curves.iter().enumerate() {
            for b in &self.curves[..k] {
                for q in a.meetings(b).into_iter().flatten() {
                    let near = (q - self.around).norm_squared() < span * span;
                    // The tip of a sharp corner may hold no cell for a while.
                    if near && self.fits(q) && floor.any_touchable(q, 4.0 * floor.grid.cell) {
                        tips.push(q);
                    }
                }
            }
        }
        self.tips = tips;
        // Feet on curves are taken only where the centre can be at all.
        if !floor.any_touchable(self.around, span + floor.grid.cell) {
            self.curves.clear();
        }
    }
}

/// Walls moved inwards by the radius (the boundary runs counter-clockwise), and circles around
/// their ends.
fn curves(walls: &[Segment], radius: f64) -> Vec<Curve> {
    let mut curves = Vec::with_capacity(2 * walls.len());
    for wall in walls {
        let inwards = crate::geometry::perp(wall.along / wall.length()) * radius;
        curves.push(Curve::Line(Segment::new(wall.from + inwards, wall.to() + inwards)));
        curves.push(Curve::Circle(wall.from, radius));
    }
    curves
}

enum Curve {
    Line(Segment),
    Circle(Point, f64),
}

impl Curve {
    fn nearest(&self, p: Point) -> Point {
        match self {
            Self::Line(segment) => segment.nearest(p),
            Self::Circle(center, radius) => {
                let away = (p - center).try_normalize(1e-12);
                center + away.unwrap_or_else(Vector::x) * *radius
            }
        }
    }

    /// Where two curves meet; lines are taken as endless, what lies beyond does not fit anyway.
    fn meetings(&self, other: &Self) -> [Option<Point>; 2] {
        match (self, other) {
            (Self::Line(a), Self::Line(b)) => [lines_meet(a, b), None],
            (Self::Line(line), Self::Circle(c, r)) | (Self::Circle(c, r), Self::Line(line)) => {
                line_meets_circle(line, *c, *r)
            }
            (Self::Circle(c, r), Self::Circle(d, _)) => circles_meet(*c, *d, *r),
        }
    }
}

fn lines_meet(a: &Segment, b: &Segment) -> Option<Point> {
    if cross(a.along, b.along).abs() < 1e-9 * a.length() * b.length() {
        return None;
    }
    Some(a.from + a.along * meeting(a.from, a.along, b.from, b.along))
}

fn line_meets_circle(line: &Segment, center: Point, radius: f64) -> [Option<Point>; 2] {
    let along = line.along / line.length();
    let foot = line.from + along * (center - line.from).dot(&along);
    let square = radius * radius - (foot - center).norm_squared();
    if square < 0.0 {
        return [None, None];
    }
    let half = along * square.sqrt();
    [Some(foot + half), Some(foot - half)]
}

fn circles_meet(a: Point, b: Point, radius: f64) -> [Option<Point>; 2] {
    let way = b - a;
    let square = radius * radius - way.norm_squared() / 4.0;
    let Some(along) = way.try_normalize(1e-9) else {
        return [None, None];
    };
    if square < 0.0 {
        return [None, None];
    }
    let middle = a + way / 2.0;
    let half = crate::geometry::perp(along) * square.sqrt();
    [Some(middle + half), Some(middle - half)]
}
