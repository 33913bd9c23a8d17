//! Where the centre has been, kept as few straight segments: what the hidden disc is measured
//! against while the robot drives. How far a raster's cells are from there grows with the path; what a disc is it
//! leaves to `hidden`, and why the robot drove there it does not know.

use super::{Floor, HiddenDisc, Unswept};
use crate::geometry::raster::{Grid, squared_distances};
use crate::geometry::{Point, Segment, Vector, cross};

/// A path driven is kept as straight segments that stray no more than this from it, metres.
const STRAIGHT: f64 = 0.001;

/// Where the centre has been: grows as the robot drives.
#[derive(Debug, Clone, Default)]
pub struct Coverage {
    segments: Vec<Segment>,
    run: Option<Run>,
    measured: Option<Measured>,
}

/// How far the cells of a raster are from where the centre had been when somebody last asked.
#[derive(Debug, Clone)]
struct Measured {
    grid: Grid,
    /// Segments that are in it, the first of all.
    segments: usize,
    /// Square metres.
    squared: Vec<f32>,
}

impl Measured {
    fn begin(grid: &Grid) -> Self {
        Self { grid: grid.clone(), segments: 0, squared: vec![f32::INFINITY; grid.len()] }
    }
}

/// The straight run that the path is on: where it began, where it has come to, and the directions
/// (a wedge between two vectors) that pass all places in between closely enough.
#[derive(Debug, Clone, Copy)]
struct Run {
    from: Point,
    to: Point,
    right: Option<(Vector, Vector)>,
}

impl Coverage {
    /// Nothing driven yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What driving along `path` covers.
    #[must_use]
    pub fn of(path: &[Point]) -> Self {
        let mut coverage = Self::new();
        coverage.add(path);
        coverage
    }

    /// Adds a piece of path of its own, not joined to what came before.
    pub fn add(&mut self, path: &[Point]) {
        self.lift();
        for &p in path {
            self.push(p);
        }
    }

    /// Adds the straight way from `a` to `b`.
    pub fn add_line(&mut self, a: Point, b: Point) {
        self.lift();
        self.segments.push(Segment::new(a, b));
    }

    /// Adds the way from the last place to `p`.
    pub fn push(&mut self, p: Point) {
        let Some(run) = self.run else {
            self.run = Some(Run { from: p, to: p, right: None });
            return;
        };
        if let Some(longer) = run.extended(p) {
            self.run = Some(longer);
            return;
        }
        self.segments.push(Segment::new(run.from, run.to));
        let fresh = Run { from: run.to, to: run.to, right: None };
        self.run = Some(fresh.extended(p).unwrap_or(fresh));
    }

    /// Ends the piece of path: the next place begins a new one.
    pub fn lift(&mut self) {
        if let Some(run) = self.run.take() {
            self.segments.push(Segment::new(run.from, run.to));
        }
    }

    /// The path as straight segments.
    #[must_use]
    pub fn segments(&self) -> Vec<Segment> {
        let open = self.run.map(|run| Segment::new(run.from, run.to));
        self.segments.iter().copied().chain(open).collect()
    }

    /// The largest disc left on `floor`; none when every place is swept.
    #[must_use]
    pub fn largest(&self, floor: &Floor) -> Option<HiddenDisc> {
        Unswept::new(floor, self.segments()).spots(0.0, 1).pop()
    }

    /// The largest disc around each place that is left, from `diameter` metres up, largest first.
    #[must_use]
    pub fn spots(&self, floor: &Floor, diameter: f64) -> Vec<HiddenDisc> {
        Unswept::new(floor, self.segments()).spots(diameter, usize::MAX)
    }

    /// The discs of [`Coverage::spots`], and the largest disc that is left at all; none when every
    /// place is swept. Asked again on the same floor it measures only what was driven since then.
    #[must_use]
    pub fn spots_and_largest(
        &mut self,
        floor: &Floor,
        diameter: f64,
    ) -> (Vec<HiddenDisc>, Option<HiddenDisc>) {
        let unswept = self.unswept(floor);
        let spots = unswept.spots(diameter, usize::MAX);
        let largest = spots.first().copied().or_else(|| unswept.spots(0.0, 1).pop());
        (spots, largest)
    }

    fn unswept<'a>(&mut self, floor: &'a Floor) -> Unswept<'a> {
        let known = self.measured.take().filter(|known| known.grid == floor.grid);
        let mut known = known.unwrap_or_else(|| Measured::begin(&floor.grid));
        bring_near(&mut known.squared, &known.grid, &self.segments[known.segments..]);
        known.segments = self.segments.len();
        let path = self.segments();
        let mut squared = known.squared.clone();
        // The run that the path is on may yet grow.
        bring_near(&mut squared, &known.grid, &path[known.segments..]);
        self.measured = Some(known);
        Unswept::at(floor, path, &squared)
    }
}

/// Lowers squared distances to those from `more` segments where these are nearer.
fn bring_near(squared: &mut [f32], grid: &Grid, more: &[Segment]) {
    if more.is_empty() {
        return;
    }
    for (value, square) in squared.iter_mut().zip(squared_distances(grid, more)) {
        *value = value.min(square);
    }
}

impl Run {
    /// This run led on to `p`, if one straight line still passes all of its places.
    fn extended(&self, p: Point) -> Option<Self> {
        let way = p - self.from;
        let length = way.norm();
        if length <= STRAIGHT {
            let near = (self.to - self.from).norm() <= STRAIGHT;
            return near.then_some(Self { to: p, ..*self });
        }
        // A run never turns back on itself.
        if (p - self.to).dot(&way) < 0.0 {
            return None;
        }
        let side = crate::geometry::perp(way) * (STRAIGHT / length);
        let (mut right, mut left) = (way - side, way + side);
        if let Some((r, l)) = self.right {
            if cross(r, way) < 0.0 || cross(way, l) < 0.0 {
                return None;
            }
            if cross(right, r) > 0.0 {
                right = r;
            }
            if cross(l, left) > 0.0 {
                left = l;
            }
        }
        Some(Self { to: p, right: Some((right, left)), ..*self })
    }
}

#[cfg(test)]
mod tests {
    use super::super::rooms;
    use super::*;
    use crate::geometry::angle;

    #[test]
    fn asked_again_it_says_what_it_would_say_the_first_time() {
        let room = rooms::rectangle(6.0, 4.0);
        let boxed = rooms::boxed(2.0, 1.5, 2.5, 2.0);
        let wider = rooms::rectangle(6.0, 4.1);
        let floors =
            [rooms::floor(&room, &[]), rooms::floor(&room, &[&boxed]), rooms::floor(&wider, &[])];
        let mut coverage = Coverage::of(&rooms::lap(&room, 0.145));
        for k in 0..12_u32 {
            // Further along a line with each answer, then on another one; of a floor with an object, too, and of one
            // whose raster lies elsewhere.
            let (line, along) = (f64::from(k / 4), 1.0 + f64::from(k % 4));
            coverage.push(Point::new(along, 0.6 + 0.9 * line));
            if k % 4 == 3 {
                coverage.lift();
            }
            let floor = &floors[[0, 0, 0, 1, 1, 2, 2, 0, 1, 2, 2, 2][k as usize]];
            let again = coverage.unswept(floor).field;
            assert!(again == Unswept::new(floor, coverage.segments()).field, "after {k}");
        }
    }

    #[test]
    fn a_path_of_many_places_is_kept_as_few_segments_close_to_it() {
        let path: Vec<Point> = (0..2000)
            .map(|k| {
                let turn = f64::from(k) * 0.001;
                Point::new(1.0, 1.0) + angle::unit(turn) * 0.8
            })
            .collect();
        let kept = Coverage::of(&path).segments();
        assert!(kept.len() < 40, "{} segments", kept.len());
        for p in path {
            let off = kept.iter().map(|s| s.distance_squared(p)).fold(1.0, f64::min).sqrt();
            assert!(off <= 1.5 * STRAIGHT, "{off} m off the path");
        }
    }
}
