//! The covariance of all that the survey keeps the error of: the head (pose and robot), whose rows every step
//! of the way changes, and the knots. What head and knots have in common is brought up to the last step only
//! when it is needed; and of every two rows of which one is a knot's only the later one's row holds what they
//! have in common. Knows nothing of what the rows stand for.

use super::motion::Onward;
use super::{FIRST_KNOT, Head};
use nalgebra::{DMatrix, DVector};

/// Every two rows have one variance in common, and each entry is kept once but for those of the head.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Covariance {
    /// Above the diagonal only the head's entries hold.
    entries: DMatrix<f64>,
    /// What the steps since then make of the head's rows, where those meet a knot's; see [`Covariance::settle`].
    onward: Head,
    lags: bool,
}

impl Covariance {
    /// Of a head alone, whose rows have nothing in common.
    pub(super) fn new(variances: &[f64; FIRST_KNOT]) -> Self {
        let diagonal = DVector::from_row_slice(variances);
        Self { entries: DMatrix::from_diagonal(&diagonal), onward: Head::identity(), lags: false }
    }

    fn size(&self) -> usize {
        self.entries.nrows()
    }

    /// What the errors of two rows have in common.
    pub(super) fn of(&self, row: usize, column: usize) -> f64 {
        let (late, early) = (row.max(column), row.min(column));
        match (late < FIRST_KNOT, early < FIRST_KNOT) {
            (false, true) if self.lags => {
                (0..FIRST_KNOT).map(|k| self.onward[(early, k)] * self.entries[(late, k)]).sum()
            }
            (true, _) => self.entries[(row, column)],
            _ => self.entries[(late, early)],
        }
    }

    /// An entry of the head, which alone is changed one by one. Whoever changes one changes its mirror image.
    pub(super) fn head(&mut self, row: usize, column: usize) -> &mut f64 {
        debug_assert!(row.max(column) < FIRST_KNOT, "of the head");
        &mut self.entries[(row, column)]
    }

    /// A step changes the head's rows: those among each other at once, those with the knots when they are needed.
    pub(super) fn step(&mut self, onward: &Onward) {
        for column in 0..FIRST_KNOT {
            let new = onward.apply(|k| self.entries[(k, column)]);
            for (row, value) in Onward::ROWS.into_iter().zip(new) {
                self.entries[(row, column)] = value;
            }
            let new = onward.apply(|k| self.onward[(k, column)]);
            for (row, value) in Onward::ROWS.into_iter().zip(new) {
                self.onward[(row, column)] = value;
            }
        }
        for row in 0..FIRST_KNOT {
            let new = onward.apply(|k| self.entries[(row, k)]);
            for (column, value) in Onward::ROWS.into_iter().zip(new) {
                self.entries[(row, column)] = value;
            }
        }
        self.lags = true;
    }

    /// Brings what the knots' errors have in common with those of the head up to the last step. Each step
    /// changes a few rows of that by the same rule, so that many can be taken at once.
    pub(super) fn settle(&mut self) {
        if !std::mem::take(&mut self.lags) {
            return;
        }
        let onward = std::mem::replace(&mut self.onward, Head::identity());
        let knots = self.size() - FIRST_KNOT;
        let new = Onward::ROWS.map(|row| {
            let mut sum = DVector::zeros(knots);
            for k in (0..FIRST_KNOT).filter(|&k| onward[(row, k)] != 0.0) {
                add(onward[(row, k)], &self.column(k)[FIRST_KNOT..], sum.as_mut_slice());
            }
            sum
        });
        for (row, new) in Onward::ROWS.into_iter().zip(new) {
            self.entries.view_mut((FIRST_KNOT, row), (knots, 1)).copy_from(&new);
        }
    }

    fn column(&self, column: usize) -> &[f64] {
        let size = self.size();
        &self.entries.as_slice()[column * size..][..size]
    }

    /// What all rows have in common with a weighed sum of some; settled first.
    pub(super) fn with(&self, sum: &[(usize, f64)]) -> DVector<f64> {
        debug_assert!(!self.lags, "settled first");
        let mut common = DVector::zeros(self.size());
        let all = common.as_mut_slice();
        for &(index, weight) in sum {
            // What comes before a knot's row is in the row; the head's columns are whole.
            let before = if index < FIRST_KNOT { 0 } else { index };
            for (k, common) in all[..before].iter_mut().enumerate() {
                *common += weight * self.entries[(index, k)];
            }
            add(weight, &self.column(index)[before..], &mut all[before..]);
        }
        common
    }

    /// The variance of a weighed sum of rows.
    pub(super) fn spread(&self, sum: &[(usize, f64)]) -> f64 {
        sum.iter().map(|(i, v)| sum.iter().map(|(j, w)| self.of(*i, *j) * v * w).sum::<f64>()).sum()
    }

    /// Something was measured with which the rows have `common` in common, of variance `spread`: they err less.
    pub(super) fn measured(&mut self, common: &DVector<f64>, spread: f64) {
        debug_assert!(!self.lags, "settled first");
        let (size, common) = (self.size(), common.as_slice());
        for (k, column) in self.entries.as_mut_slice().chunks_exact_mut(size).enumerate() {
            let first = if k < FIRST_KNOT { 0 } else { k };
            add(-1.0 / spread * common[k], &common[first..], &mut column[first..]);
        }
    }

    /// Three more rows, with nothing in common with the others, of such a variance.
    pub(super) fn extend(&mut self, variance: f64) {
        self.settle();
        let size = self.size();
        self.resize(size + 3);
        for k in size..size + 3 {
            self.entries[(k, k)] = variance;
        }
    }

    /// Without its last three rows.
    pub(super) fn shorten(&mut self) {
        self.settle();
        self.resize(self.size() - 3);
    }

    fn resize(&mut self, size: usize) {
        self.entries = std::mem::take(&mut self.entries).resize(size, size, 0.0);
    }

    /// Three more rows that err as the first three do.
    pub(super) fn repeat(&mut self) {
        let size = self.size();
        self.extend(0.0);
        for k in 0..3 {
            for other in 0..size {
                self.entries[(size + k, other)] = self.of(other, k);
            }
            for other in 0..=k {
                self.entries[(size + k, size + other)] = self.entries[(k, other)];
            }
        }
    }

    /// Makes the first three rows those sums of knots' rows.
    pub(super) fn take_place(&mut self, sums: &[Vec<(usize, f64)>; 3]) {
        self.settle();
        let common = sums.each_ref().map(|sum| self.with(sum));
        for (k, common) in common.iter().enumerate() {
            for other in 3..self.size() {
                self.entries[(other, k)] = common[other];
            }
            for other in 3..FIRST_KNOT {
                self.entries[(k, other)] = common[other];
            }
            for (l, sum) in sums.iter().enumerate() {
                self.entries[(k, l)] =
                    sum.iter().map(|(other, weight)| common[*other] * weight).sum();
            }
        }
    }
}

/// Adds `weight` times `what` to `sum`: on plain slices, where a machine does several entries at a time.
fn add(weight: f64, what: &[f64], sum: &mut [f64]) {
    for (sum, what) in sum.iter_mut().zip(what) {
        *sum += weight * what;
    }
}

#[cfg(test)]
mod tests {
    use super::super::Step;
    use super::*;
    use crate::geometry::Pose;
    use crate::mapping::map::Spun;
    use nalgebra::DMatrix;

    /// The same with all entries kept and always up to date.
    struct Plain(DMatrix<f64>);

    impl Plain {
        fn step(&mut self, onward: &Onward) {
            let size = self.0.nrows();
            let mut by = DMatrix::identity(size, size);
            for k in 0..FIRST_KNOT {
                let unit = onward.apply(|row| f64::from(u8::from(row == k)));
                for (row, value) in Onward::ROWS.into_iter().zip(unit) {
                    by[(row, k)] = value;
                }
            }
            self.0 = &by * &self.0 * by.transpose();
        }

        fn row(&self, sum: &[(usize, f64)]) -> DMatrix<f64> {
            let mut row = DMatrix::zeros(1, self.0.nrows());
            for (k, weight) in sum {
                row[(0, *k)] += weight;
            }
            row
        }

        fn measured(&mut self, sum: &[(usize, f64)], variance: f64) {
            let common = &self.0 * self.row(sum).transpose();
            let spread = (self.row(sum) * &common)[(0, 0)] + variance;
            self.0 -= &common * common.transpose() / spread;
        }

        fn put(&mut self, map: &DMatrix<f64>) {
            self.0 = map * &self.0 * map.transpose();
        }
    }

    fn check(lazy: &Covariance, plain: &Plain, after: &str) {
        assert_eq!(lazy.size(), plain.0.nrows(), "{after}");
        for i in 0..lazy.size() {
            for j in 0..lazy.size() {
                let (got, want) = (lazy.of(i, j), plain.0[(i, j)]);
                assert!(
                    (got - want).abs() < 1e-12 * (1.0 + want.abs()),
                    "{got} not {want} at {i}, {j} {after}"
                );
            }
        }
    }

    /// A step of the way: ahead and a turn.
    fn onward(ahead: f64, turn: f64) -> Onward {
        let to = Pose::new(ahead, 0.1 * ahead, turn);
        let step = Step {
            from: Pose::new(0.0, 0.0, 0.0),
            to,
            seconds: 0.5,
            spun: (Spun::default(), Spun::default()),
        };
        Onward::over(&step)
    }

    #[test]
    fn what_is_kept_once_and_brought_up_late_is_what_it_is_kept_whole() {
        let variances = [1e-4, 2e-4, 3e-4, 1e-3, 2e-3, 0.5, 4e-3, 1e-4];
        let mut lazy = Covariance::new(&variances);
        let mut plain = Plain(DMatrix::from_diagonal(&DVector::from_row_slice(&variances)));
        for round in 0..4 {
            for k in 1..4 {
                let onward = onward(0.3 * f64::from(k), 0.2 - 0.1 * f64::from(round));
                lazy.step(&onward);
                plain.step(&onward);
            }
            check(&lazy, &plain, "on the way");
            // A knot where the pose is, ...
            let size = plain.0.nrows();
            let mut twice = DMatrix::identity(size + 3, size);
            (0..3).for_each(|k| twice[(size + k, k)] = 1.0);
            lazy.repeat();
            plain.put(&twice);
            check(&lazy, &plain, "with one more knot");
            // ... of which something is seen later on, beside the pose and another knot.
            lazy.step(&onward(0.4, 0.3));
            plain.step(&onward(0.4, 0.3));
            let sum = [(0, 0.6), (2, -0.2), (FIRST_KNOT + 1, -0.6), (size + 2, 0.4), (7, 0.1)];
            lazy.settle();
            let common = lazy.with(&sum);
            let whole = &plain.0 * plain.row(&sum).transpose();
            assert!((&common - whole.column(0)).norm() < 1e-12);
            assert!((lazy.spread(&sum) - (plain.row(&sum) * whole)[(0, 0)]).abs() < 1e-12);
            lazy.measured(&common, lazy.spread(&sum) + 1e-5);
            plain.measured(&sum, 1e-5);
            check(&lazy, &plain, "after a measurement");
        }
        // Three rows of their own, and without them again.
        let (kept, size) = (lazy.clone(), plain.0.nrows());
        lazy.extend(2.0);
        let mut wide = plain.0.clone().resize(size + 3, size + 3, 0.0);
        (size..size + 3).for_each(|k| wide[(k, k)] = 2.0);
        check(&lazy, &Plain(wide), "extended");
        lazy.shorten();
        assert_eq!(lazy, kept);
        // The pose is found beside two knots.
        let sums = [0, 1, 2].map(|k| vec![(FIRST_KNOT + k, 0.3), (size - 3 + k, 0.7)]);
        let mut found = DMatrix::identity(size, size);
        for (k, sum) in sums.iter().enumerate() {
            found.row_mut(k).copy_from(&plain.row(sum));
        }
        lazy.step(&onward(0.2, 0.0));
        plain.step(&onward(0.2, 0.0));
        lazy.take_place(&sums);
        plain.put(&found);
        check(&lazy, &plain, "found");
    }
}
