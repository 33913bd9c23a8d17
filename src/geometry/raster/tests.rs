//! The raster beside the slow and obvious way.

use super::*;
use crate::geometry::Ring;
use crate::geometry::segment::chords;

fn ell() -> Vec<Segment> {
    let at = |x: f64, y: f64| Point::new(x, y);
    chords(
        &Ring::polygon(&[
            at(0.0, 0.0),
            at(4.0, 0.3),
            at(4.0, 1.5),
            at(2.0, 1.5),
            at(2.1, 3.0),
            at(0.0, 3.0),
        ]),
        1e-3,
    )
}

#[test]
fn the_transform_agrees_with_measuring_every_segment_from_every_cell() {
    let segments = ell();
    let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.037, 0.1);
    let field = squared_distances(&grid, &segments);
    for (cell, &square) in field.iter().enumerate() {
        let at = grid.point(cell);
        let want =
            segments.iter().map(|s| s.distance_squared(at)).fold(f64::INFINITY, f64::min).sqrt();
        let got = f64::from(square).sqrt();
        assert!((got - want).abs() < 1e-4, "{got} instead of {want} at {at}");
    }
}

#[test]
fn runs_of_a_stadium_are_the_cells_within_its_radius() {
    let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.05, 0.0);
    let ends = [
        ((1.0, 1.0), (3.0, 2.0)),
        ((1.0, 1.0), (3.0, 1.0)),
        ((2.0, 0.0), (2.0, 4.0)),
        ((3.0, 0.2), (-1.0, 2.9)),
        ((1.01, 1.02), (1.01, 1.02)),
    ];
    for (a, b) in ends {
        let segment = Segment::new(Point::new(a.0, a.1), Point::new(b.0, b.1));
        let mut seen = vec![false; grid.len()];
        grid.stadium_runs(&segment, 0.28, |row, first, last| {
            seen[row * grid.width + first..=row * grid.width + last].fill(true);
        });
        let mut in_two = vec![0; grid.len()];
        let mut count = |row: usize, first: usize, last: usize| {
            in_two[row * grid.width + first..=row * grid.width + last]
                .iter_mut()
                .for_each(|n| *n += 1);
        };
        grid.rim_runs(&segment, (0.0, 0.15), &mut count);
        grid.rim_runs(&segment, (0.15, 0.28), &mut count);
        assert!(in_two.iter().zip(&seen).all(|(n, seen)| *n == i32::from(*seen)), "{a:?} to {b:?}");
        for (cell, &found) in seen.iter().enumerate() {
            let off = segment.distance_squared(grid.point(cell)).sqrt() - 0.28;
            if off.abs() > 1e-9 {
                assert_eq!(found, off < 0.0, "{a:?} to {b:?}, at {}", grid.point(cell));
            }
        }
    }
}

#[test]
fn cells_inside_are_those_the_ring_contains() {
    let segments = ell();
    let ring = Ring::polygon(&segments.iter().map(|s| s.from).collect::<Vec<_>>());
    let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.0411, 0.1);
    for (cell, &marked) in inside(&grid, &segments).iter().enumerate() {
        let at = grid.point(cell);
        if ring.distance(at) > 1e-9 {
            assert_eq!(marked, ring.contains(at), "at {at}");
        }
    }
}

/// Where a vertex lies on a row of cells, the row has as many cells inside as the rows beside it.
#[test]
fn a_row_through_a_vertex_loses_none_of_its_cells() {
    for k in 0..300 {
        let y = 0.05 + 0.01 * f64::from(k % 240) + 1e-3 * f64::from(k / 240);
        let corners = [
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (2.15, 3.0),
            (2.15, y),
            (2.0, y),
            (2.0, 3.0),
            (0.0, 3.0),
        ];
        let ring = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        for margin in [0.0, 0.1, 0.35] {
            let grid = Grid::over(Point::new(0.0, 0.0), Point::new(4.0, 3.0), 0.05, margin);
            let marked = inside(&grid, &chords(&ring, 1e-3));
            for (cell, marked) in marked.into_iter().enumerate() {
                let at = grid.point(cell);
                assert!(
                    marked == ring.contains(at) || ring.distance(at) < 1e-6,
                    "{at} in the room with its wall down to {y}"
                );
            }
        }
    }
}
