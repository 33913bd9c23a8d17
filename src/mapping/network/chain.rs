//! Normal equations of a chain of states with a border of unknowns that are the same all along it, and
//! their solution.
//!
//! Each state hangs together with the one before it, the border with any of them, but with few at each
//! place. So the chain is cut into pieces: the inside of a piece is eliminated on the border that it
//! meets, what remains (the cuts and the border) is solved as a whole, and the inside follows
//! (substructuring, Przemieniecki 1963; the Helmert blocking of surveyors). The order of all sums is
//! fixed, so that the result is the same on every machine.

use nalgebra::{Cholesky, Const, DMatrix, DVector, Dyn, OMatrix, SMatrix, SVector};

/// Unknowns of one state.
pub(super) const STATE: usize = 4;
/// States from one cut to the next, at least, ...
const PIECE: usize = 48;
/// ... and more where there would be more cuts than about this: the whole, which is solved as one, grows with
/// them.
const MOST_CUTS: usize = 50;
/// Unknowns of the border that one equation speaks of, at most.
const MOST: usize = 5;

type State = SVector<f64, STATE>;
type Block = SMatrix<f64, STATE, STATE>;
/// What a state has in common with the outside of its piece.
type Wide = OMatrix<f64, Const<STATE>, Dyn>;

/// One linear equation: what is `off` grows with these unknowns, and should be nothing but for its variance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Equation {
    off: f64,
    weight: f64,
    /// States that follow each other, the later one second.
    nodes: [Option<(usize, State)>; 2],
    border: [(usize, f64); MOST],
    terms: usize,
}

impl Equation {
    /// Something is `off` with `variance`.
    pub(super) fn of(off: f64, variance: f64) -> Self {
        Self { off, weight: 1.0 / variance, nodes: [None; 2], border: [(0, 0.0); MOST], terms: 0 }
    }

    /// It grows with state `index` as `by` says; of two states the earlier one comes first.
    pub(super) fn node(mut self, index: usize, by: State) -> Self {
        let free = usize::from(self.nodes[0].is_some());
        self.nodes[free] = Some((index, by));
        self
    }

    /// It grows with an unknown of the border.
    pub(super) fn border(mut self, index: usize, by: f64) -> Self {
        if by != 0.0 {
            self.border[self.terms] = (index, by);
            self.terms += 1;
        }
        self
    }
}

/// A state in the normal equations.
#[derive(Debug, Clone)]
struct Node {
    own: Block,
    /// With the state before: rows of this one.
    before: Block,
    beside: Vec<(usize, State)>,
    right: State,
}

/// The normal equations.
#[derive(Debug, Clone)]
pub(super) struct Normal {
    nodes: Vec<Node>,
    border: DMatrix<f64>,
    right: DVector<f64>,
}

impl Normal {
    /// No equations yet for so many states and unknowns of the border.
    pub(super) fn new(states: usize, border: usize) -> Self {
        let node = Node {
            own: Block::zeros(),
            before: Block::zeros(),
            beside: Vec::new(),
            right: State::zeros(),
        };
        Self {
            nodes: vec![node; states],
            border: DMatrix::zeros(border, border),
            right: DVector::zeros(border),
        }
    }

    /// One more equation.
    pub(super) fn add(&mut self, equation: &Equation) {
        let (weight, off) = (equation.weight, equation.off);
        let border = &equation.border[..equation.terms];
        for &(index, by) in equation.nodes.iter().flatten() {
            let node = &mut self.nodes[index];
            node.own += by * by.transpose() * weight;
            node.right -= by * (weight * off);
            for &(column, share) in border {
                let term = by * (weight * share);
                match node.beside.iter_mut().find(|(known, _)| *known == column) {
                    Some((_, sum)) => *sum += term,
                    None => node.beside.push((column, term)),
                }
            }
        }
        if let [Some((_, first)), Some((index, second))] = equation.nodes {
            self.nodes[index].before += second * first.transpose() * weight;
        }
        for &(row, by) in border {
            self.right[row] -= by * weight * off;
            for &(column, share) in border {
                self.border[(row, column)] += by * share * weight;
            }
        }
    }

    /// The states and the border that satisfy all equations best; none where they leave something open.
    pub(super) fn solve(&self) -> Option<(Vec<State>, DVector<f64>)> {
        self.solve_in_pieces(PIECE.max(self.nodes.len() / MOST_CUTS))
    }

    /// The same, with a cut after every `piece` states.
    fn solve_in_pieces(&self, piece: usize) -> Option<(Vec<State>, DVector<f64>)> {
        let Reduced { whole, right, pieces, cuts } = self.reduced(piece)?;
        // Only the lower triangle was filled below the cuts; that is what is read.
        let solution = whole.cholesky()?.solve(&right);
        let mut states = vec![State::zeros(); self.nodes.len()];
        for (k, &cut) in cuts.iter().enumerate() {
            states[cut] = solution.fixed_rows::<STATE>(STATE * k).into_owned();
        }
        for piece in &pieces {
            piece.follow(&solution, &mut states);
        }
        let shift = STATE * cuts.len();
        Some((states, solution.rows(shift, self.right.len()).into_owned()))
    }

    /// What is left when the inside of all pieces is eliminated.
    fn reduced(&self, piece: usize) -> Option<Reduced> {
        let count = self.nodes.len();
        let cuts: Vec<usize> = (0..count)
            .step_by(piece)
            .chain(
                (count > 0 && !(count - 1).is_multiple_of(piece)).then_some(count.wrapping_sub(1)),
            )
            .collect();
        let shift = STATE * cuts.len();
        let size = shift + self.right.len();
        let mut whole = DMatrix::zeros(size, size);
        let mut right = DVector::zeros(size);
        whole.view_mut((shift, shift), self.border.shape()).copy_from(&self.border);
        right.rows_mut(shift, self.right.len()).copy_from(&self.right);
        for (k, &cut) in cuts.iter().enumerate() {
            let (node, row) = (&self.nodes[cut], STATE * k);
            whole.fixed_view_mut::<STATE, STATE>(row, row).copy_from(&node.own);
            right.fixed_rows_mut::<STATE>(row).copy_from(&node.right);
            for (column, term) in &node.beside {
                add_row(&mut whole, shift + column, row, term);
            }
        }
        let mut pieces = Vec::with_capacity(cuts.len());
        for (k, ends) in cuts.windows(2).enumerate() {
            let piece = Piece::between(&self.nodes, ends[0], ends[1], (STATE * k, shift))?;
            piece.leave(&mut whole, &mut right);
            pieces.push(piece);
        }
        Some(Reduced { whole, right, pieces, cuts })
    }

    /// How well the unknowns of the border are known; none where the equations leave something open.
    pub(super) fn sureness(&self) -> Option<Sureness> {
        let reduced = self.reduced(PIECE.max(self.nodes.len() / MOST_CUTS))?;
        let shift = STATE * reduced.cuts.len();
        Some(Sureness { whole: reduced.whole.cholesky()?, shift })
    }
}

/// The equations of the cuts and the border.
struct Reduced {
    whole: DMatrix<f64>,
    right: DVector<f64>,
    pieces: Vec<Piece>,
    cuts: Vec<usize>,
}

/// The covariance of the border.
pub(super) struct Sureness {
    whole: Cholesky<f64, Dyn>,
    shift: usize,
}

impl Sureness {
    /// The covariance times `of`, which has a row for each unknown of the border.
    pub(super) fn times(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        let mut right = DMatrix::zeros(self.shift + of.nrows(), of.ncols());
        right.rows_mut(self.shift, of.nrows()).copy_from(of);
        self.whole.solve(&right).rows(self.shift, of.nrows()).into_owned()
    }
}

/// Adds `term` to what row `row` of the lower triangle has in common with the state whose rows begin at
/// `column`.
fn add_row(whole: &mut DMatrix<f64>, row: usize, column: usize, term: &State) {
    for (k, value) in term.iter().enumerate() {
        whole[(row, column + k)] += value;
    }
}

/// Takes the products of the columns of two off the lower triangle of `left`.
fn take_off(left: &mut DMatrix<f64>, one: &Wide, other: &Wide) {
    let (ones, others) =
        (one.as_slice().as_chunks::<STATE>().0, other.as_slice().as_chunks::<STATE>().0);
    let size = left.nrows();
    for (k, (column, other)) in left.as_mut_slice().chunks_exact_mut(size).zip(others).enumerate() {
        for (entry, one) in column[k..].iter_mut().zip(&ones[k..]) {
            *entry -= one.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
        }
    }
}

/// What was eliminated of one state: the inverse of its own block, and what it had in common with the next
/// state and with the outside, and its right-hand side, all of that times the inverse.
#[derive(Debug, Clone)]
struct Gone {
    next: Block,
    outside: Wide,
    right: State,
}

/// The states between two cuts, eliminated.
#[derive(Debug, Clone)]
struct Piece {
    first: usize,
    /// Rows of the outside in the whole: those of the cut before, then of the border it meets.
    rows: Vec<usize>,
    gone: Vec<Gone>,
    /// What is left on the outside, its lower triangle.
    left: DMatrix<f64>,
    left_right: DVector<f64>,
    /// What is left on the cut after: its own, with the outside, and its right-hand side.
    own: Block,
    across: Wide,
    right: State,
    last_row: usize,
}

impl Piece {
    /// Eliminates the states of `nodes` between the cuts `from` and `to`; the rows of the first begin at
    /// `row`, those of the border at `shift`.
    fn between(
        nodes: &[Node],
        from: usize,
        to: usize,
        (row, shift): (usize, usize),
    ) -> Option<Self> {
        let mut columns: Vec<usize> = nodes[from + 1..to]
            .iter()
            .flat_map(|node| node.beside.iter().map(|(column, _)| *column))
            .collect();
        columns.sort_unstable();
        columns.dedup();
        let rows: Vec<usize> =
            (row..row + STATE).chain(columns.iter().map(|column| shift + column)).collect();
        let outside = rows.len();
        let place = |column: usize| columns.binary_search(&column).ok().map(|k| STATE + k);
        let mut left = DMatrix::zeros(outside, outside);
        let mut left_right = DVector::zeros(outside);
        // What the state in hand has in common with the outside; at first with the cut before.
        let mut with = Wide::zeros(outside);
        with.fixed_view_mut::<STATE, STATE>(0, 0).copy_from(&nodes[from + 1].before);
        let (mut own, mut right) = (Block::zeros(), State::zeros());
        let mut gone = Vec::with_capacity(to - from);
        for index in from + 1..to {
            let node = &nodes[index];
            own += node.own;
            right += node.right;
            for (column, term) in &node.beside {
                let place = place(*column)?;
                for k in 0..STATE {
                    with[(k, place)] += term[k];
                }
            }
            let inverse = own.cholesky()?.inverse();
            let next = nodes[index + 1].before;
            let outside_gone = inverse * &with;
            let right_gone = inverse * right;
            take_off(&mut left, &with, &outside_gone);
            left_right.gemv_tr(-1.0, &outside_gone, &right, 1.0);
            let next_gone = inverse * next.transpose();
            // On to the next state.
            own = -next * next_gone;
            right = -next * right_gone;
            with = -next * &outside_gone;
            gone.push(Gone { next: next_gone, outside: outside_gone, right: right_gone });
        }
        let last_row = row + STATE;
        Some(Self {
            first: from + 1,
            rows,
            gone,
            left,
            left_right,
            own,
            across: with,
            right,
            last_row,
        })
    }

    /// Adds what is left to the `whole`: lower triangle, where the border comes after all cuts.
    fn leave(&self, whole: &mut DMatrix<f64>, right: &mut DVector<f64>) {
        for (i, &row) in self.rows.iter().enumerate() {
            right[row] += self.left_right[i];
            for (j, &column) in self.rows[..=i].iter().enumerate() {
                whole[(row, column)] += self.left[(i, j)];
            }
        }
        for k in 0..STATE {
            let row = self.last_row + k;
            right[row] += self.right[k];
            for l in 0..STATE {
                whole[(row, self.last_row + l)] += self.own[(k, l)];
            }
            for (j, &other) in self.rows.iter().enumerate() {
                let (row, column) = (row.max(other), row.min(other));
                whole[(row, column)] += self.across[(k, j)];
            }
        }
    }

    /// The states inside, once the outside is known.
    fn follow(&self, solution: &DVector<f64>, states: &mut [State]) {
        let outside =
            DVector::from_iterator(self.rows.len(), self.rows.iter().map(|&r| solution[r]));
        for (k, gone) in self.gone.iter().enumerate().rev() {
            let index = self.first + k;
            let by: State = SVector::from_iterator((&gone.outside * &outside).iter().copied());
            states[index] = gone.right - gone.next * states[index + 1] - by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of `states` whose equations come from a small generator, with `border` unknowns.
    fn chain(states: usize, border: usize) -> (Normal, DMatrix<f64>, DVector<f64>) {
        let mut normal = Normal::new(states, border);
        let size = STATE * states + border;
        let (mut whole, mut right) = (DMatrix::zeros(size, size), DVector::zeros(size));
        let mut seed: u32 = 7;
        let mut chance = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(seed >> 8) / f64::from(1 << 24) - 0.5
        };
        let mut add = |nodes: &[usize], columns: &[usize], normal: &mut Normal| {
            let mut row = DVector::zeros(size);
            let (off, variance) = (chance(), 0.5 + chance().abs());
            let mut equation = Equation::of(off, variance);
            for &node in nodes {
                let by = State::from_fn(|_, _| chance());
                row.fixed_rows_mut::<STATE>(STATE * node).copy_from(&by);
                equation = equation.node(node, by);
            }
            for &column in columns {
                let by = chance();
                row[STATE * states + column] += by;
                equation = equation.border(column, by);
            }
            normal.add(&equation);
            whole += &row * row.transpose() / variance;
            right -= &row * (off / variance);
        };
        for column in 0..border {
            add(&[], &[column], &mut normal);
        }
        for node in 0..states {
            for _ in 0..=STATE {
                add(&[node], &[node % border, (node * 7 + 3) % border], &mut normal);
                if node > 0 {
                    add(&[node - 1, node], &[(node / 9) % border], &mut normal);
                }
            }
        }
        (normal, whole, right)
    }

    #[test]
    fn cut_into_pieces_the_chain_has_the_solution_that_it_has_as_a_whole() {
        for states in [2, 3, PIECE, PIECE + 1, PIECE + 2, 3 * PIECE + 5] {
            let (normal, whole, right) = chain(states, 11);
            let whole = whole.cholesky().expect("nothing is open");
            let all = whole.solve(&right);
            let inverse = whole.inverse();
            let covariance = inverse.view((STATE * states, STATE * states), (11, 11));
            for piece in [PIECE, 7, 2 * PIECE] {
                let (nodes, border) = normal.solve_in_pieces(piece).expect("nothing is open");
                for (k, node) in nodes.iter().enumerate() {
                    let off = (all.fixed_rows::<STATE>(STATE * k) - node).norm();
                    assert!(off < 1e-8, "state {k} of {states} by {piece}: {off}");
                }
                let off = (all.rows(STATE * states, 11) - border).norm();
                assert!(off < 1e-8, "border of {states} by {piece}: {off}");
            }
            let sure = normal.sureness().expect("nothing is open");
            let off = (sure.times(&DMatrix::identity(11, 11)) - covariance).norm();
            assert!(off < 1e-8, "covariance of the border of {states}: {off}");
        }
    }

    #[test]
    fn what_is_left_open_has_no_solution() {
        let mut normal = Normal::new(3, 1);
        normal.add(&Equation::of(1.0, 1.0).node(0, State::new(1.0, 0.0, 0.0, 0.0)));
        assert!(normal.solve().is_none());
    }
}
