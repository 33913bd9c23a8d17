//! Which places still need the robot to come near, one bit each, and how many of them a line
//! serves. A line serves a convex stadium, hence one run of bits in each row: counting is quick
//! enough to weigh thousands of lines against each other.

use crate::geometry::raster::Grid;
use crate::geometry::{Point, Segment};
use crate::mapping::floor::{Floor, Unswept};

/// The places where a disc larger than asked for could still hide.
#[derive(Debug, Clone)]
pub(super) struct Need {
    grid: Grid,
    /// Words of 64 bits in a row.
    words: usize,
    bits: Vec<u64>,
    /// A line this near serves a place, metres.
    radius: f64,
}

impl Need {
    /// Places of every `stride`-th cell where the disc left over by `unswept` has a radius above
    /// `over`; a line within `over` + r + d of a place serves it. Places that no body can touch
    /// are left out.
    pub(super) fn new(floor: &Floor, unswept: &Unswept<'_>, over: f64, stride: usize) -> Self {
        let fine = &floor.grid;
        let grid = Grid {
            origin: fine.origin,
            cell: fine.cell * stride as f64,
            width: fine.width.div_ceil(stride),
            height: fine.height.div_ceil(stride),
        };
        let words = grid.width.div_ceil(64);
        let mut bits = vec![0; words * grid.height];
        for y in 0..grid.height {
            for x in 0..grid.width {
                let cell = y * stride * fine.width + x * stride;
                if f64::from(unswept.field[cell]) <= over {
                    continue;
                }
                // In corners the raster holds an upper bound only.
                if floor.touchable[cell] || unswept.radius(fine.point(cell)) > over {
                    bits[y * words + x / 64] |= 1 << (x % 64);
                }
            }
        }
        Self { grid, words, bits, radius: over + floor.reach }
    }

    /// Whether nothing is needed any more.
    pub(super) fn is_empty(&self) -> bool {
        self.bits.iter().all(|&word| word == 0)
    }

    /// The places that a line's pieces would serve if all were needed.
    pub(super) fn span(&self, pieces: &[Segment]) -> Span {
        let mut words = Vec::with_capacity(64);
        for piece in pieces {
            self.grid.stadium_runs(piece, self.radius, |row, first, last| {
                let (mut word, mut from) = (first / 64, first % 64);
                while word < last / 64 {
                    words.push(((row * self.words + word) as u32, u64::MAX << from));
                    (word, from) = (word + 1, 0);
                }
                let mask = (u64::MAX << from) & (u64::MAX >> (63 - last % 64));
                words.push(((row * self.words + word) as u32, mask));
            });
        }
        Span(words)
    }

    /// How many places a line serves.
    pub(super) fn gain(&self, span: &Span) -> usize {
        let mut count = 0;
        for (word, mask) in span.words() {
            let served = self.bits[word] & mask;
            // Most words are served out soon, and counting bits is dear without an instruction for it.
            if served != 0 {
                count += served.count_ones() as usize;
            }
        }
        count
    }

    /// Strikes out the places that a line serves; whether there were any.
    pub(super) fn serve(&mut self, span: &Span) -> bool {
        let mut any = false;
        for (word, mask) in span.words() {
            any |= self.bits[word] & mask != 0;
            self.bits[word] &= !mask;
        }
        any
    }

    /// Calls `visit` with the index of every place that a line serves.
    pub(super) fn served(&self, span: &Span, mut visit: impl FnMut(usize)) {
        for (word, mask) in span.words() {
            let mut left = self.bits[word] & mask;
            while left != 0 {
                visit(word * 64 + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
    }

    /// The places still needed: index and where.
    pub(super) fn places(&self) -> Vec<(usize, Point)> {
        let mut places = Vec::new();
        for (word, &bits) in self.bits.iter().enumerate() {
            let mut left = bits;
            while left != 0 {
                let index = word * 64 + left.trailing_zeros() as usize;
                places.push((index, self.point(index)));
                left &= left - 1;
            }
        }
        places
    }

    /// Where the place with this index is.
    fn point(&self, index: usize) -> Point {
        let row = self.words * 64;
        self.grid.center(index % row, index / row)
    }

    /// Whether the place with this index is still needed.
    pub(super) fn has(&self, index: usize) -> bool {
        self.bits[index / 64] >> (index % 64) & 1 == 1
    }

    /// Gives a place up.
    pub(super) fn drop(&mut self, index: usize) {
        self.bits[index / 64] &= !(1 << (index % 64));
    }

    /// Room for one count for every index.
    pub(super) fn len(&self) -> usize {
        self.bits.len() * 64
    }

    /// The stretch of `piece` between the first and the last place that it serves.
    pub(super) fn trimmed(&self, piece: &Segment) -> Option<(Point, Point)> {
        let length = piece.length();
        let along = piece.along / length;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        self.served(&self.span(std::slice::from_ref(piece)), |index| {
            let at = (self.point(index) - piece.from).dot(&along).clamp(0.0, length);
            (low, high) = (low.min(at), high.max(at));
        });
        (low <= high).then(|| (piece.from + along * low, piece.from + along * high))
    }
}

/// The places within reach of a line's pieces, as words of the raster and their bits: worked out
/// once, and counted again and again as fewer of them are needed.
#[derive(Debug, Clone)]
pub(super) struct Span(Vec<(u32, u64)>);

impl Span {
    fn words(&self) -> impl Iterator<Item = (usize, u64)> + '_ {
        self.0.iter().map(|&(word, mask)| (word as usize, mask))
    }
}
