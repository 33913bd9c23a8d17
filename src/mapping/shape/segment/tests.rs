//! A square room whose contacts err as they do.

use super::*;

const SIGMA: f64 = 0.0015;

/// The four walls of 2 m, a contact every 0.1 m but none within 0.1 m of a corner.
fn square() -> Vec<Sample> {
    let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)].map(|(x, y)| Point::new(x, y));
    let wall = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % 4]);
        (1..20).map(move |n| a + (b - a) * (f64::from(n) * 0.05))
    };
    (0..4).flat_map(wall).map(sample).collect()
}

fn sample(point: Point) -> Sample {
    Sample { point, from: Point::new(1.0, 1.0), weight: 1.0, edges: Vec::new() }
}

/// The same with `odd` in the corner between the second and the third wall.
fn with(odd: &[(f64, f64)]) -> Vec<Sample> {
    let mut samples = square();
    let at = 2 * 19;
    samples.splice(at..at, odd.iter().map(|(x, y)| sample(Point::new(*x, *y))));
    samples
}

#[test]
fn four_walls_are_four_runs() {
    assert_eq!(runs(&mut square(), SIGMA).len(), 4);
}

#[test]
fn stray_contacts_in_a_corner_are_no_wall_of_their_own() {
    // Nearly four standard deviations off the wall, 7 mm from the next.
    let found = runs(&mut with(&[(1.9985, 1.92), (1.9943, 1.926)]), SIGMA);
    assert_eq!(found.len(), 4, "{found:?}");
}

#[test]
fn a_corner_that_is_cut_off_is_a_wall() {
    let found = runs(&mut with(&[(1.96, 1.94), (1.95, 1.95), (1.94, 1.96)]), SIGMA);
    assert_eq!(found.len(), 5, "{found:?}");
}

#[test]
fn the_end_of_a_wall_that_was_looked_at_too_seldom_is_of_the_wall() {
    // Of the third wall nothing was seen for 0.72 m between a look into the corner and the next.
    let mut samples = square();
    let third = 2 * 19;
    let seen = [(1.92, 2.0), (1.82, 2.001)].map(|(x, y)| sample(Point::new(x, y)));
    samples.splice(third..third + 9, seen);
    let found = runs(&mut samples, SIGMA);
    assert_eq!(found.len(), 4, "{found:?}");
    let mut begins = found.iter().map(|run| samples[run.first].point);
    assert!(begins.any(|p| p == Point::new(1.92, 2.0)), "{found:?}");
}

#[test]
fn a_contact_that_stands_out_shortly_before_a_corner_turns_no_end_of_the_wall_aside() {
    // Four standard deviations off, and three more within 15 mm before the corner: with the one that stands out they
    // would be a wall of 50 mm askew.
    let mut samples = square();
    let end = 3 * 19;
    let seen = [(0.062, 1.9935), (0.022, 2.0), (0.013, 1.9995), (0.01, 2.0003)];
    samples.splice(end - 1..end, seen.map(|(x, y)| sample(Point::new(x, y))));
    let found = runs(&mut samples, SIGMA);
    assert_eq!(found.len(), 4, "{found:?}");
}
