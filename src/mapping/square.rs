//! Squaring: walls that are nearly at right angles to each other made exactly so, as an option. Rooms are
//! built square more often than not, and a gyro that wandered by a degree is not; but nobody measured the
//! right angles, so what was mapped is kept beside, and the squaring is undone by leaving it away.
//!
//! Works on a finished outline and on nothing else: the robot drives, and corrects its pose, by what it
//! saw.

use crate::geometry::simple::crossings;
use crate::geometry::{Piece, Point, Ring, Vector, angle, cross, meeting};
use serde::{Deserialize, Serialize};

/// Walls shorter than this say nothing of a direction, metres.
const SHORTEST: f64 = 0.2;
/// A wall farther than this from the axes was built so, radians.
const NEARLY: f64 = 0.052;
/// Corners are not moved farther than this, metres.
const FARTHEST: f64 = 0.06;
/// The room has axes when the walls agree on them to this share (resultant length).
const AGREED: f64 = 0.6;
/// Chords stand for arcs within this, metres.
const SAGITTA: f64 = 0.001;
/// Two walls that meet at less than this go on straight (sine): no corner to intersect them in.
const STRAIGHT: f64 = 0.35;

/// What squaring changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Squared {
    /// Direction of the walls' axis, radians from +x, above -45 and up to 45 degrees.
    pub axis: f64,
    /// How many walls lie along the axis or across it now ...
    pub walls: usize,
    /// ... and how many straight walls do not, and stay as they were.
    pub left: usize,
    /// The farthest that a wall was turned, radians.
    pub turned: f64,
    /// The farthest that a corner was moved, metres.
    pub moved: f64,
    /// The outline as it was mapped.
    pub before: Ring,
}

/// How far a direction is from the nearest axis, radians.
fn off_axis(direction: f64, axis: f64) -> f64 {
    let quarter = angle::PI / 2.0;
    let off = direction - axis;
    off - (off / quarter).round() * quarter
}

/// The direction, or the one at right angles to it, that most of the walls lie along; none when they do
/// not agree.
fn axis(walls: &[(f64, f64)]) -> Option<f64> {
    let all: f64 = walls.iter().map(|(length, _)| length).sum();
    let mean = |counts: &dyn Fn(f64) -> bool| -> Vector {
        let counted = walls.iter().filter(|(_, direction)| counts(*direction));
        counted.map(|(length, direction)| angle::unit(4.0 * direction) * *length).sum()
    };
    let first = mean(&|_| true);
    if all <= 0.0 || first.norm() < AGREED * all {
        return None;
    }
    let rough = angle::of(first) / 4.0;
    let fine = mean(&|direction| off_axis(direction, rough).abs() < 2.0 * NEARLY);
    Some(angle::of(fine) / 4.0)
}

/// A straight wall as an unbounded line.
#[derive(Clone, Copy)]
struct Line {
    at: Point,
    along: Vector,
}

impl Line {
    fn foot(&self, p: Point) -> Point {
        self.at + self.along * self.along.dot(&(p - self.at))
    }
}

/// `outline` with its nearly square walls square, and what that changed; none when there is nothing to
/// square.
#[must_use]
pub fn square(outline: &Ring) -> Option<(Ring, Squared)> {
    let straight: Vec<Option<f64>> = outline
        .pieces
        .iter()
        .map(|piece| match piece {
            Piece::Line { from, to } if piece.length() >= SHORTEST => Some(angle::of(to - from)),
            _ => None,
        })
        .collect();
    let walls: Vec<(f64, f64)> = outline
        .pieces
        .iter()
        .zip(&straight)
        .filter_map(|(piece, direction)| Some((piece.length(), (*direction)?)))
        .collect();
    let axis = axis(&walls)?;
    let mut turns: Vec<Option<f64>> = straight
        .iter()
        .map(|direction| direction.map(|d| off_axis(d, axis)).filter(|off| off.abs() < NEARLY))
        .collect();
    // A corner that would be moved too far shows that its walls are not what they seem; so do walls that would cross,
    // the faces of a thin board for one.
    let corners = loop {
        let corners = corners(outline, &turns);
        let far = (0..corners.len())
            .find(|k| (corners[*k] - outline.pieces[*k].from()).norm() > FARTHEST);
        let before = |k: usize| (k + corners.len() - 1) % corners.len();
        let wrong = match far {
            Some(k) => vec![before(k), k],
            None => crossed(&through(outline, &corners)),
        };
        if wrong.iter().all(|k| turns[*k].is_none()) {
            break corners;
        }
        for k in wrong {
            turns[k] = None;
        }
    };
    let count = turns.iter().flatten().count();
    if count < 2 {
        return None;
    }
    let made = through(outline, &corners);
    if !crossed(&made).is_empty() {
        return None;
    }
    let moves = outline.pieces.iter().zip(&corners).map(|(piece, to)| (to - piece.from()).norm());
    let squared = Squared {
        axis,
        walls: count,
        left: walls.len() - count,
        turned: turns.iter().flatten().fold(0.0, |most, turn| turn.abs().max(most)),
        moved: moves.fold(0.0, f64::max),
        before: outline.clone(),
    };
    Some((made, squared))
}

/// The pieces of `ring` that cross another, and those beside them, whose walls the corners hang on as well.
fn crossed(ring: &Ring) -> Vec<usize> {
    let (points, count) = (ring.to_points(SAGITTA), ring.pieces.len());
    let piece = |edge: usize| {
        let middle = nalgebra::center(&points[edge], &points[(edge + 1) % points.len()]);
        ring.nearest(middle).map(|foot| foot.piece)
    };
    let pieces = crossings(&points).into_iter().flat_map(|(i, k)| [piece(i), piece(k)]).flatten();
    pieces.flat_map(|k| [(k + count - 1) % count, k, (k + 1) % count]).collect()
}

/// The corners, each where its piece begins, once the walls are turned by `turns`.
fn corners(outline: &Ring, turns: &[Option<f64>]) -> Vec<Point> {
    let count = outline.pieces.len();
    let mut lines: Vec<Option<(Line, bool)>> = outline
        .pieces
        .iter()
        .zip(turns)
        .map(|(piece, turn)| match piece {
            Piece::Line { from, to } => {
                let direction = angle::of(to - from) - turn.unwrap_or(0.0);
                let line = Line { at: from + (to - from) / 2.0, along: angle::unit(direction) };
                Some((line, turn.is_some()))
            }
            Piece::Arc { .. } => None,
        })
        .collect();
    let lengths: Vec<f64> = outline.pieces.iter().map(Piece::length).collect();
    join_straight(&mut lines, &lengths);
    (0..count)
        .map(|k| {
            let corner = outline.pieces[k].from();
            match (lines[(k + count - 1) % count], lines[k]) {
                (Some((a, square_a)), Some((b, square_b))) if square_a || square_b => {
                    if cross(a.along, b.along).abs() > STRAIGHT {
                        return a.at + a.along * meeting(a.at, a.along, b.at, b.along);
                    }
                    match (square_a, square_b) {
                        (true, false) => a.foot(corner),
                        (false, true) => b.foot(corner),
                        _ => a.foot(corner) + (b.foot(corner) - a.foot(corner)) / 2.0,
                    }
                }
                (Some((wall, true)), None) | (None, Some((wall, true))) => wall.foot(corner),
                _ => corner,
            }
        })
        .collect()
}

/// Square walls of these `lengths` that go on straight are one wall: on one line, where the longer ones are.
/// Each on its own would have to come to the other where they meet, and be square no longer.
fn join_straight(lines: &mut [Option<(Line, bool)>], lengths: &[f64]) {
    let count = lines.len();
    let goes_on = |lines: &[Option<(Line, bool)>], k: usize| {
        let (before, here) = (lines[(k + count - 1) % count], lines[k]);
        matches!((before, here), (Some((a, true)), Some((b, true)))
            if cross(a.along, b.along).abs() <= STRAIGHT && a.along.dot(&b.along) > 0.0)
    };
    for first in 0..count {
        if goes_on(lines, first) || !goes_on(lines, (first + 1) % count) {
            continue;
        }
        let more = (first + 1..first + count).take_while(|k| goes_on(lines, k % count)).count();
        let wall: Vec<usize> = (first..=first + more).map(|k| k % count).collect();
        let Some((Line { at: begin, along }, _)) = lines[first] else { continue };
        let whole: f64 = wall.iter().map(|k| lengths[*k]).sum();
        let of_all = wall.iter().filter_map(|k| Some((lines[*k]?.0, lengths[*k])));
        let off = of_all.map(|(line, length)| (line.at - begin) * (length / whole));
        let line = Line { at: begin + off.sum::<Vector>(), along };
        for k in wall {
            lines[k] = Some((line, true));
        }
    }
}

/// The pieces of `outline` through other corners; an arc keeps its bulge, or its middle.
fn through(outline: &Ring, corners: &[Point]) -> Ring {
    let pieces = outline.pieces.iter().enumerate().map(|(k, piece)| match piece {
        Piece::Arc { .. } if corners.len() == 1 => *piece,
        _ => piece.between(corners[k], corners[(k + 1) % corners.len()], |p| p),
    });
    Ring { pieces: pieces.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(corners: &[(f64, f64)]) -> Ring {
        Ring::polygon(&corners.iter().map(|(x, y)| Point::new(*x, *y)).collect::<Vec<_>>())
    }

    /// Whether every two walls that meet do so at a right angle.
    fn is_square(ring: &Ring) -> bool {
        let count = ring.pieces.len();
        (0..count).all(|k| {
            let (a, b) = (ring.pieces[k].tangent(0.5), ring.pieces[(k + 1) % count].tangent(0.5));
            a.dot(&b).abs() < 1e-9
        })
    }

    #[test]
    fn a_crooked_l_becomes_square_and_says_by_how_much() {
        let crooked =
            ring(&[(0.0, 0.0), (4.0, 0.03), (4.02, 2.0), (2.0, 1.98), (1.99, 3.0), (0.01, 3.02)]);
        let (square, told) = square(&crooked).expect("something to square");
        assert!(is_square(&square), "{square:?}");
        assert_eq!((told.walls, told.left), (6, 0));
        assert!((0.005..0.02).contains(&told.turned), "{told:?}");
        assert!((0.002..0.04).contains(&told.moved), "{told:?}");
        assert_eq!(told.before, crooked, "what was mapped is kept");
        assert!((square.area() / crooked.area() - 1.0).abs() < 0.005);
        let (again, more) = super::square(&square).expect("square it stays");
        assert!(more.moved < 1e-9 && more.turned < 1e-9, "{more:?}");
        assert!(again.pieces.len() == square.pieces.len());
    }

    #[test]
    fn a_turned_room_keeps_its_own_axes() {
        let turn = |x: f64, y: f64| {
            let by = angle::unit(0.5);
            (by.x * x - by.y * y, by.y * x + by.x * y)
        };
        let room = ring(&[turn(0.0, 0.0), turn(4.0, 0.02), turn(4.0, 3.0), turn(0.02, 3.0)]);
        let (square, told) = square(&room).expect("something to square");
        assert!(is_square(&square));
        assert!((told.axis - 0.5).abs() < 0.005, "{told:?}");
    }

    #[test]
    fn what_was_built_at_another_angle_stays() {
        // A corner cut off at 45 degrees, and one wall 10 degrees askew.
        let room =
            ring(&[(0.0, 0.0), (4.0, 0.02), (4.0, 2.0), (3.0, 3.0), (1.0, 3.0), (0.0, 2.83)]);
        let (square, told) = square(&room).expect("something to square");
        assert_eq!((told.walls, told.left), (4, 2));
        let cut = square.pieces[2].tangent(0.5);
        assert!((angle::of(cut) - 0.75 * angle::PI).abs() < 0.02, "{cut:?}");
        let askew = square.pieces[4].tangent(0.5);
        assert!((angle::of(-askew) - 0.1685).abs() < 0.01, "{askew:?}");
    }

    #[test]
    fn square_walls_that_go_on_straight_are_one_line() {
        let kinked = ring(&[(0.0, 0.0), (2.0, 0.0), (4.0, 0.08), (4.0, 3.0), (0.0, 3.0)]);
        let (square, told) = square(&kinked).expect("something to square");
        assert_eq!((told.walls, told.left), (5, 0));
        for piece in &square.pieces {
            let off = off_axis(angle::of(piece.tangent(0.5)), told.axis);
            assert!(off.abs() < 1e-9, "{off} {square:?}");
        }
        // The same from another corner on, with the kink where the ring begins.
        let turned = ring(&[(2.0, 0.0), (4.0, 0.08), (4.0, 3.0), (0.0, 3.0), (0.0, 0.0)]);
        let (other, _) = super::square(&turned).expect("something to square");
        assert!((other.area() - square.area()).abs() < 1e-9);
    }

    #[test]
    fn the_faces_of_a_thin_board_do_not_cross() {
        // A board of 8 mm that leans by 1.4 degrees, with the floor on its right lower: turned about their middles
        // its faces change sides.
        let board = [(2.0, 0.0), (2.03, 1.2), (2.038, 1.2), (1.983, -1.0)];
        let walls = [(4.0, -1.0), (4.0, 3.0), (0.0, 3.0)];
        let room: Vec<(f64, f64)> = [(0.0, 0.0)].into_iter().chain(board).chain(walls).collect();
        let (square, told) = square(&ring(&room)).expect("the other walls are square");
        assert_eq!(crossings(&square.to_points(SAGITTA)), []);
        assert!((2..7).contains(&told.walls), "{told:?}");
    }

    #[test]
    fn rooms_without_right_angles_are_left_alone() {
        let hexagon: Vec<(f64, f64)> = (0..6)
            .map(|k| {
                let at = angle::unit(f64::from(k) * angle::PI / 3.0) * 2.0;
                (at.x, at.y)
            })
            .collect();
        assert_eq!(square(&ring(&hexagon)), None);
        assert_eq!(square(&Ring::circle(Point::new(1.0, 2.0), 1.5)), None);
        assert_eq!(square(&Ring::default()), None);
    }

    #[test]
    fn walls_that_end_in_an_arc_are_squared_and_the_arc_follows() {
        // A stadium: two parallel walls, nearly, and two half circles.
        let (a, b) = (Point::new(0.0, 0.0), Point::new(3.0, 0.03));
        let (c, d) = (Point::new(3.0, 2.0), Point::new(0.0, 2.0));
        let room = Ring {
            pieces: vec![
                Piece::Line { from: a, to: b },
                Piece::with_bulge(b, c, 1.0),
                Piece::Line { from: c, to: d },
                Piece::with_bulge(d, a, 1.0),
            ],
        };
        let (square, told) = square(&room).expect("something to square");
        assert_eq!(told.walls, 2);
        let (one, other) = (square.pieces[0].tangent(0.5), square.pieces[2].tangent(0.5));
        assert!(cross(one, other).abs() < 1e-9);
        for k in 0..4 {
            let gap = square.pieces[k].to() - square.pieces[(k + 1) % 4].from();
            assert!(gap.norm() < 1e-9, "the ring stays closed");
        }
    }
}
