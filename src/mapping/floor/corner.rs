//! How deep the body reaches into corners: the floor that it touches ends in arcs of its own
//! radius around the last places where its centre can be.

use super::Floor;
use crate::geometry::{Point, Segment, Vector};

/// Places on the rim of the centre's floor are accepted this much short of the radius, metres.
const ROUNDING: f64 = 1e-7;

impl Floor {
    /// Whether the centre can be within the body's radius of `p`, as far as the raster tells.
    pub(super) fn touches_near(&self, p: Point) -> bool {
        self.any_touchable(p, self.radius + self.grid.cell)
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

    /// Distance from `p`, where the body cannot be centred, to the nearest place that it cannot
    /// touch, metres: its radius less the way from `p` to the nearest place of the centre.
    /// Negative where it cannot touch.
    pub(super) fn corner_depth(&self, p: Point) -> f64 {
        let mut near: Vec<usize> = Vec::new();
        let here = Segment::new(p, p);
        self.walls.near(&here, 2.0 * self.radius, |k| {
            let square = self.walls.segments()[k].distance_squared(p);
            if square < 4.0 * self.radius * self.radius && !near.contains(&k) {
                near.push(k);
            }
        });
        let walls: Vec<Segment> = near.iter().map(|&k| self.walls.segments()[k]).collect();
        let mut rim = Rim {
            floor: self,
            walls: &walls,
            p,
            best: self.radius + 0.05,
        };
        let curves = rim.curves();
        for (k, a) in curves.iter().enumerate() {
            rim.offer(a.nearest(p));
            for b in &curves[..k] {
                for meeting in a.meetings(b).into_iter().flatten() {
                    rim.offer(meeting);
                }
            }
        }
        self.radius - rim.best
    }
}

/// Looks for the place of the centre's floor nearest to `p`.
struct Rim<'a> {
    floor: &'a Floor,
    walls: &'a [Segment],
    p: Point,
    /// Distance to the nearest place so far, metres.
    best: f64,
}

impl Rim<'_> {
    /// What bounds the centre's floor: a wall moved inwards, a circle around a wall's end.
    fn curves(&self) -> Vec<Curve> {
        let radius = self.floor.radius;
        let mut curves = Vec::with_capacity(3 * self.walls.len());
        for wall in self.walls {
            let normal = crate::geometry::perp(wall.along / wall.length());
            // Either side: outlines come in both orientations, and the wrong side never fits.
            curves.push(Curve::Line(Segment::new(
                wall.from + normal * radius,
                wall.to() + normal * radius,
            )));
            curves.push(Curve::Line(Segment::new(
                wall.from - normal * radius,
                wall.to() - normal * radius,
            )));
            curves.push(Curve::Circle(wall.from, radius));
        }
        curves
    }

    fn offer(&mut self, q: Point) {
        let off = (q - self.p).norm();
        if off >= self.best {
            return;
        }
        let room = self.floor.radius - ROUNDING;
        let fits = self
            .walls
            .iter()
            .all(|wall| wall.distance_squared(q) >= room * room);
        // The tip of a sharp corner may hold no cell for a while.
        if fits && self.floor.any_touchable(q, 4.0 * self.floor.grid.cell) {
            self.best = off;
        }
    }
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
    let turn = crate::geometry::cross(a.along, b.along);
    if turn.abs() < 1e-9 * a.length() * b.length() {
        return None;
    }
    let t = crate::geometry::cross(b.from - a.from, b.along) / turn;
    Some(a.from + a.along * t)
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
