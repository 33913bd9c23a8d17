//! Finds the segments near a place without looking at all of them: buckets over their box.

use super::raster::Grid;
use super::segment::Segment;
use super::{Point, Vector};

/// Segments sorted into square buckets.
#[derive(Debug, Clone, PartialEq)]
pub struct SegmentIndex {
    segments: Vec<Segment>,
    grid: Grid,
    /// Where each bucket's list begins in `entries`; one more than there are buckets.
    starts: Vec<u32>,
    entries: Vec<u32>,
}

/// A segment is listed in every bucket whose centre is nearer than this share of the pitch; half
/// a diagonal and a little more, so that no bucket it passes is left out.
const HALF_DIAGONAL: f64 = 0.708;

impl SegmentIndex {
    /// Sorts `segments` into buckets of `pitch` metres.
    #[must_use]
    pub fn new(segments: Vec<Segment>, pitch: f64) -> Self {
        let first = segments.first().map_or_else(Point::origin, |s| s.from);
        let (low, high) = segments.iter().fold((first, first), |(low, high), s| {
            let (a, b) = (s.from, s.to());
            (low.inf(&a).inf(&b), high.sup(&a).sup(&b))
        });
        let size = high - low;
        // A pitch that would make millions of buckets is widened.
        let pitch = pitch.max((size.x * size.y / 250_000.0).sqrt());
        let grid = Grid::over(low, high, pitch, pitch);
        let mut listed: Vec<(u32, u32)> = Vec::with_capacity(segments.len() * 3);
        for (number, segment) in segments.iter().enumerate() {
            grid.stadium_runs(segment, pitch * HALF_DIAGONAL, |row, first, last| {
                let row = row * grid.width;
                listed.extend((first..=last).map(|x| ((row + x) as u32, number as u32)));
            });
        }
        let mut starts = vec![0_u32; grid.len() + 1];
        for &(bucket, _) in &listed {
            starts[bucket as usize + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        let mut cursor = starts.clone();
        let mut entries = vec![0; listed.len()];
        for (bucket, number) in listed {
            let slot = &mut cursor[bucket as usize];
            entries[*slot as usize] = number;
            *slot += 1;
        }
        Self { segments, grid, starts, entries }
    }

    /// All segments, in the order given.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Calls `visit` with the number of every segment that may lie within `radius` of `around`;
    /// some more than once, some further away.
    pub fn near(&self, around: &Segment, radius: f64, mut visit: impl FnMut(usize)) {
        // Every point belongs to the bucket whose centre is nearest, half a diagonal away at most.
        let reach = radius + self.grid.cell * HALF_DIAGONAL;
        self.grid.stadium_runs(around, reach, |row, first, last| {
            let row = row * self.grid.width;
            let from = self.starts[row + first] as usize;
            let to = self.starts[row + last + 1] as usize;
            for &number in &self.entries[from..to] {
                visit(number as usize);
            }
        });
    }

    /// Distance from `p` to the nearest segment, if that is below `most` metres; else `most`.
    #[must_use]
    pub fn distance(&self, p: Point, most: f64) -> f64 {
        // Look close by first: most answers are found there, and a far look costs its area.
        let mut radius = (self.grid.cell * 0.5).min(most);
        let point = Segment::new(p, p);
        loop {
            let mut best = radius * radius;
            self.near(&point, radius, |k| {
                best = best.min(self.segments[k].distance_squared(p));
            });
            if best < radius * radius || radius >= most {
                return best.sqrt();
            }
            radius = (radius * 2.0).min(most);
            if radius > self.farthest(p) {
                return self.brute(p).min(most);
            }
        }
    }

    /// [`SegmentIndex::distance`] in one look: quicker when `most` is a close bound.
    #[must_use]
    pub fn distance_within(&self, p: Point, most: f64) -> f64 {
        self.distance_between(p, 0.0, most)
    }

    /// The same for those who do not care how much nearer than `least` metres the nearest is: any
    /// distance up to that may be told for it, and the look ends there.
    #[must_use]
    pub fn distance_between(&self, p: Point, least: f64, most: f64) -> f64 {
        let enough = if least > 0.0 { least * least } else { 0.0 };
        let grid = &self.grid;
        let half_diagonal = grid.cell * HALF_DIAGONAL;
        let at = (p - grid.origin) / grid.cell;
        let nearest = at.y.round().clamp(0.0, grid.height as f64 - 1.0) as usize;
        let mut best = most * most;
        // Row by row away from `p`: what was found near by cuts what has to be looked at farther off.
        let mut look = |row: usize| {
            let off = (row as f64 - at.y) * grid.cell;
            let reach = best.sqrt() + half_diagonal;
            let square = reach * reach - off * off;
            let half = square.max(0.0).sqrt() / grid.cell;
            let (low, high) = ((at.x - half).ceil().max(0.0), (at.x + half).floor());
            if high >= low && low < grid.width as f64 {
                let (first, last) = (low as usize, (high as usize).min(grid.width - 1));
                let row = row * grid.width;
                let listed =
                    self.starts[row + first] as usize..self.starts[row + last + 1] as usize;
                for &number in &self.entries[listed] {
                    best = best.min(self.segments[number as usize].distance_squared(p));
                    if best <= enough {
                        break;
                    }
                }
            }
            square >= 0.0 && best > enough
        };
        // Each until nothing of the next row can be nearer.
        let _ = (nearest..grid.height).find(|row| !look(*row));
        let _ = (0..nearest).rev().find(|row| !look(*row));
        best.sqrt()
    }

    /// Distance from the segment `s` to the nearest one, if that is below `most`; else `most`.
    #[must_use]
    pub fn gap(&self, s: &Segment, most: f64) -> f64 {
        let mut best = most * most;
        self.near(s, most, |k| {
            if best > 0.0 {
                best = best.min(self.segments[k].gap_squared(s));
            }
        });
        best.sqrt()
    }

    /// No bucket is further from `p` than this, metres.
    fn farthest(&self, p: Point) -> f64 {
        let size = Vector::new(self.grid.width as f64, self.grid.height as f64) * self.grid.cell;
        (p - self.grid.origin).norm() + size.norm()
    }

    fn brute(&self, p: Point) -> f64 {
        self.segments.iter().map(|s| s.distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fan() -> Vec<Segment> {
        (0..40)
            .map(|k| {
                let k = f64::from(k);
                let from = Point::new(0.37 * k % 5.0, 0.83 * k % 3.0);
                Segment::new(from, from + Vector::new(0.5 - 0.03 * k, 0.02 * k))
            })
            .collect()
    }

    #[test]
    fn distances_agree_with_measuring_all_segments() {
        let segments = fan();
        let index = SegmentIndex::new(segments, 0.25);
        for i in -20_i32..80 {
            for j in -20_i32..50 {
                let p = Point::new(f64::from(i) * 0.1003, f64::from(j) * 0.1007);
                let want = index.brute(p);
                let got = index.distance(p, f64::INFINITY);
                assert!((got - want).abs() < 1e-12, "{got} instead of {want} at {p}");
                let capped = index.distance(p, 0.3);
                assert!((capped - want.min(0.3)).abs() < 1e-12, "capped at {p}");
            }
        }
    }

    #[test]
    fn gaps_agree_with_measuring_all_segments() {
        let segments = fan();
        let index = SegmentIndex::new(segments.clone(), 0.25);
        for k in 0..200 {
            let k = f64::from(k);
            let from = Point::new(0.71 * k % 6.0 - 0.5, 0.29 * k % 4.0 - 0.5);
            let s = Segment::new(from, Point::new(0.53 * k % 5.0, 0.47 * k % 3.0));
            let want = segments
                .iter()
                .map(|other| other.gap_squared(&s))
                .fold(f64::INFINITY, f64::min)
                .sqrt();
            assert!((index.gap(&s, 10.0) - want).abs() < 1e-12, "{s:?}");
        }
    }
}
