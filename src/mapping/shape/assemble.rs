//! Puts runs and joints together into a closed ring, and makes sure that it does not cross
//! itself: where it would, the fit gives way to the contacts themselves. Knows nothing of what the ring is of.

use super::Sample;
use super::chord::{Floor, is_chord};
use super::corner::{Joint, Judge};
use super::gap::TOUCHING;
use super::plain::plain;
use super::segment::{Model, Run};
use super::untangle::{crossing, untangled};
use crate::geometry::simple::crossings;
use crate::geometry::{Piece, Point, Ring, angle, cross};

/// Pieces shorter than this are left out, metres.
const SHORTEST: f64 = 5e-4;
/// Chords stand for arcs within this when crossings are looked for, metres.
const SAGITTA: f64 = 0.001;

/// A piece no longer than this, metres, that turns back by more than this, radians, is a spike.
const SPIKE: f64 = 0.02;
const FOLDED: f64 = 178.0 * angle::PI / 180.0;
/// An arc that sweeps more than this is one whose ends have passed each other, radians: a round room
/// with something thin at its wall is one arc of nearly a whole turn.
const ALL_ROUND: f64 = angle::TAU - 0.005;

/// A corner of the ring and the bulge of the piece that leaves it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Vertex {
    pub(super) at: Point,
    pub(super) bulge: f64,
    /// The run that the piece belongs to; links belong to the run before them.
    pub(super) run: usize,
}

/// Which loops an outline that crosses itself is freed of, beside those of up to a metre. They are of something
/// that hangs on the wall, and are turned over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loops {
    /// Those where sides cross that were touched: noise has laid the faces of a thin wall through each other.
    /// What only gaps join to the wall may stand apart.
    Touched,
    /// All.
    All,
}

/// How freely a run may be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Freedom {
    /// Corners beyond the contacts.
    Fit,
    /// The same, inner corners not as far: where something thin turns, its back may be as near to them as noise
    /// is wide.
    Short,
    /// The fitted piece, but linked to its neighbours contact to contact.
    Linked,
    /// The contacts themselves.
    Contacts,
}

/// The ring of `runs`, freed of such `loops`; none when no simple one can be made.
pub(super) fn ring(judge: &Judge<'_>, runs: &[Run], loops: Loops) -> Option<Ring> {
    let touched: Vec<(Point, Point)> = judge.samples.iter().map(|s| (s.point, s.from)).collect();
    // The floor is on the left, whatever the outline is of.
    let crosses_gap = |&(from, to): &(Point, Point)| {
        let side = Piece::with_bulge(from, to, 0.0);
        is_chord(&side, Floor::Inside, &touched, &(TOUCHING..f64::INFINITY))
    };
    let turned = |sides: [(Point, Point); 2]| loops == Loops::All || !sides.iter().all(crosses_gap);
    let mut freedom = vec![Freedom::Fit; runs.len()];
    for _ in 0..60 {
        let vertices = clean(without_small_loops(tidy(draw(judge, runs, &freedom))));
        let made = to_ring(&vertices);
        let (points, owners) = chords(&made);
        let Some(&(i, k)) = crossings(&points).first() else {
            let plain = to_ring(&clean(plain(vertices.clone(), judge)));
            let simple = crossings(&chords(&plain).0).is_empty();
            return (vertices.len() >= 2).then_some(if simple { plain } else { made });
        };
        let (a, b) = (vertices[owners[i]].run, vertices[owners[k]].run);
        // The run with fewer contacts is the doubtful one.
        let size = |n: usize| runs[n].last - runs[n].first;
        let (doubtful, other) = if size(a) <= size(b) { (a, b) } else { (b, a) };
        if !restrain(&mut freedom, doubtful) && !restrain(&mut freedom, other) {
            return untangled(points, turned);
        }
    }
    let made = to_ring(&tidy(draw(judge, runs, &freedom)));
    untangled(chords(&made).0, turned)
}

/// A simple ring from `ring`, which corrections of its corners may have made cross itself: loops of a
/// few centimetres go first, and if that is not enough, the shorter loop at each crossing; none when
/// those are no small loops.
pub(super) fn simple(ring: &Ring) -> Option<Ring> {
    without_crossings(ring, false)
}

/// The same, with large loops turned over: what was simple before it was corrected has faces of something thin
/// that were laid through each other, and no island.
pub(super) fn with_faces_parted(ring: &Ring) -> Option<Ring> {
    without_crossings(ring, true)
}

fn without_crossings(ring: &Ring, turned: bool) -> Option<Ring> {
    let is_simple = |ring: &Ring| crossings(&chords(ring).0).is_empty();
    let vertex = |piece: &Piece| Vertex { at: piece.from(), bulge: piece.bulge(), run: 0 };
    let vertices = clean(ring.pieces.iter().map(vertex).collect());
    if vertices.len() == ring.pieces.len() && is_simple(ring) {
        return Some(ring.clone());
    }
    let made = to_ring(&without_small_loops(vertices));
    if is_simple(&made) { Some(made) } else { untangled(chords(&made).0, |_| turned) }
}

/// One step less freedom for a run; false when it has none left.
fn restrain(freedom: &mut [Freedom], run: usize) -> bool {
    let next = match freedom[run] {
        Freedom::Fit => Freedom::Short,
        Freedom::Short => Freedom::Linked,
        Freedom::Linked | Freedom::Contacts => Freedom::Contacts,
    };
    let changed = next != freedom[run];
    freedom[run] = next;
    changed
}

/// What may be handed over: no piece of no length, which would hide a spike, and no spike.
fn clean(vertices: Vec<Vertex>) -> Vec<Vertex> {
    without_spikes(tidy(vertices))
}

/// Leaves out corners at which a straight piece goes back the way it came: the last bit of a face or a stray
/// contact, and nothing that stands there. Rounded, the two would lie on each other.
fn without_spikes(mut vertices: Vec<Vertex>) -> Vec<Vertex> {
    let is_spike = |vertices: &[Vertex], k: usize| {
        let count = vertices.len();
        let (before, next) = (vertices[(k + count - 1) % count], vertices[(k + 1) % count]);
        let (there, back) = (vertices[k].at - before.at, next.at - vertices[k].at);
        let straight = before.bulge == 0.0 && vertices[k].bulge == 0.0;
        let short = there.norm().min(back.norm()) < SPIKE;
        straight && short && angle::atan2(cross(there, back), there.dot(&back)).abs() > FOLDED
    };
    while vertices.len() > 3
        && let Some(k) = (0..vertices.len()).find(|&k| is_spike(&vertices, k))
    {
        vertices.remove(k);
    }
    vertices
}

/// Cuts off loops of a few centimetres where two straight pieces cross: what contacts out of
/// order leave at a corner.
fn without_small_loops(mut vertices: Vec<Vertex>) -> Vec<Vertex> {
    const SMALL: f64 = 0.15;
    for _ in 0..50 {
        let (points, owners) = chords(&to_ring(&vertices));
        let count = points.len();
        let end = |n: usize| points[(n + 1) % count];
        // From the crossing along the one side, round, and along the other one back to it.
        let loop_length = |i: usize, k: usize, at: Point| -> f64 {
            let between = (i + 1..i + 1 + (k + count - i - 1) % count).map(|n| n % count);
            let round: f64 = between.map(|n| (end(n) - points[n]).norm()).sum();
            (end(i) - at).norm() + round + (points[k] - at).norm()
        };
        let small = crossings(&points).into_iter().find_map(|(i, k)| {
            let straight = |n: usize| vertices[owners[n]].bulge == 0.0;
            let at = crossing(points[i], end(i), points[k], end(k))?;
            let (from, to) = if loop_length(i, k, at) < SMALL {
                (i, k)
            } else if loop_length(k, i, at) < SMALL {
                (k, i)
            } else {
                return None;
            };
            (straight(i) && straight(k)).then_some((owners[from], owners[to], at))
        });
        let Some((from, to, at)) = small else {
            return vertices;
        };
        // Vertices after `from` up to and with `to` go; the piece of `to` leaves from the crossing.
        let total = vertices.len();
        let removed = (to + total - from) % total;
        if removed + 3 > total {
            return vertices;
        }
        vertices.rotate_left((from + 1) % total);
        let run = vertices[removed - 1].run;
        vertices.drain(..removed);
        vertices.insert(0, Vertex { at, bulge: 0.0, run });
    }
    vertices
}

/// All vertices of the ring.
fn draw(judge: &Judge<'_>, runs: &[Run], freedom: &[Freedom]) -> Vec<Vertex> {
    let count = runs.len();
    let joints: Vec<Joint> = (0..count)
        .map(|k| {
            let next = (k + 1) % count;
            let (run, next) = ((&runs[k], freedom[k]), (&runs[next], freedom[next]));
            match run.1.max(next.1) {
                Freedom::Fit => judge.joint(run.0, next.0),
                Freedom::Short => judge.short_joint(run.0, next.0),
                Freedom::Linked | Freedom::Contacts => judge.link(run.0, next.0),
            }
        })
        .collect();
    let mut vertices = Vec::new();
    for (k, run) in runs.iter().enumerate() {
        let (start, end) = (joints[(k + count - 1) % count].start, joints[k].end);
        if freedom[k] == Freedom::Contacts {
            let contacts = &judge.samples[run.first..=run.last];
            vertices.extend(contacts.iter().map(|s| Vertex { at: s.point, bulge: 0.0, run: k }));
            continue;
        }
        let contacts = &judge.samples[run.first..=run.last];
        vertices.push(Vertex { at: start, bulge: bulge(&run.model, contacts, start, end), run: k });
        vertices.push(Vertex { at: end, bulge: 0.0, run: k });
    }
    vertices
}

/// tan(sweep / 4) of the arc from `start` to `end` through the middle of the fitted one, on which the
/// `contacts` lie: none where its ends have passed each other, and it would go all the way round.
fn bulge(model: &Model, contacts: &[Sample], start: Point, end: Point) -> f64 {
    let Model::Arc { center, radius, hollow } = *model else {
        return 0.0;
    };
    let (a, b) = (angle::of(start - center), angle::of(end - center));
    let sweep = if hollow { angle::wrap_positive(b - a) } else { -angle::wrap_positive(a - b) };
    let middle = center + angle::unit(a + sweep / 2.0) * radius;
    let chord = end - start;
    let bearing = |sample: &Sample| angle::of(sample.point - center);
    let step = |two: &[Sample]| angle::wrap(bearing(&two[1]) - bearing(&two[0]));
    let seen: f64 = contacts.windows(2).map(step).sum();
    let unseen = sweep.abs() - seen.abs();
    if chord.norm() < SHORTEST || sweep.abs() > ALL_ROUND || unseen > angle::PI {
        return 0.0;
    }
    -2.0 * cross(chord, middle - start) / chord.norm_squared()
}

/// Without pieces of no length, and without corners in straight stretches.
fn tidy(mut vertices: Vec<Vertex>) -> Vec<Vertex> {
    let mut k = 0;
    while vertices.len() > 2 && k < vertices.len() {
        let next = (k + 1) % vertices.len();
        let same = (vertices[next].at - vertices[k].at).norm() < SHORTEST;
        if same {
            // The piece that leaves the later one counts.
            let at = vertices[k].at;
            vertices[next].at = at;
            vertices.remove(k);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
    vertices
}

fn to_ring(vertices: &[Vertex]) -> Ring {
    let count = vertices.len();
    let pieces = (0..count)
        .map(|k| Piece::with_bulge(vertices[k].at, vertices[(k + 1) % count].at, vertices[k].bulge))
        .collect();
    Ring { pieces }
}

/// The ring as points, and for each the piece that the edge leaving it belongs to.
fn chords(ring: &Ring) -> (Vec<Point>, Vec<usize>) {
    let mut points = Vec::new();
    let mut owners = Vec::new();
    for (index, piece) in ring.pieces.iter().enumerate() {
        let single = Ring { pieces: vec![*piece] };
        let part = single.to_points(SAGITTA);
        owners.extend(std::iter::repeat_n(index, part.len()));
        points.extend(part);
    }
    (points, owners)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thing_whose_neck_crosses_itself_stays_on_the_map() {
        // A box of 16 by 15 cm in a room of 4 x 3 m, 20 cm off the wall: the sides of its neck changed
        // places.
        let corners = [
            (0.0, 0.0),
            (1.995, 0.0),
            (2.005, 0.08),
            (2.005, 0.2),
            (1.92, 0.21),
            (1.92, 0.36),
            (2.08, 0.36),
            (2.08, 0.21),
            (1.995, 0.2),
            (1.995, 0.08),
            (2.005, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ];
        let points: Vec<Point> = corners.iter().map(|(x, y)| Point::new(*x, *y)).collect();
        let crossed = Ring::polygon(&points);
        assert!(!crossings(&crossed.to_points(SAGITTA)).is_empty());
        let mended = simple(&crossed).expect("a neck that is open");
        assert!(crossings(&mended.to_points(SAGITTA)).is_empty());
        assert!((mended.area() - 11.975).abs() < 0.005, "{}", mended.area());
    }

    #[test]
    fn an_inner_corner_of_something_thin_goes_as_far_as_its_back_allows() {
        // Two boards of 2 cm at a right angle, seen up to 11 cm from their inner corner; where they nearly meet,
        // the switches saw into the gap between them from behind.
        let faces = [
            [(0.11, 0.0), (0.6, 0.0)],
            [(0.6, -0.002), (0.6, -0.018)],
            [(0.6, -0.02), (-0.004, -0.02)],
            [(-0.005, -0.018), (0.003, 0.002)],
            [(0.002, 0.002), (-0.018, -0.005)],
            [(-0.02, -0.004), (-0.02, 0.6)],
            [(-0.018, 0.6), (-0.002, 0.6)],
            [(0.0, 0.6), (0.0, 0.11)],
        ];
        let (mut samples, mut runs) = (Vec::new(), Vec::new());
        for [a, b] in faces.map(|face| face.map(|(x, y)| Point::new(x, y))) {
            let direction = (b - a).normalize();
            let away = crate::geometry::perp(direction) * 0.15;
            let first = samples.len();
            samples.extend((0..9).map(|k| {
                let point = a + (b - a) * (f64::from(k) / 8.0);
                Sample { point, from: point + away, weight: 1.0, edges: Vec::new() }
            }));
            let model = Model::Line { center: a, direction };
            runs.push(Run { first, last: samples.len() - 1, model });
        }
        let judge = Judge { samples: &samples, sigma: 0.0015, reach: 0.16 };
        let made = ring(&judge, &runs, Loops::All).expect("an outline");
        assert!(crossings(&made.to_points(SAGITTA)).is_empty());
        assert!(made.distance(Point::new(0.025, 0.0)) < 1e-9, "{made:?}");
        assert!(made.distance(Point::new(0.0, 0.025)) < 1e-9, "{made:?}");
        assert!(!made.reversed().contains(Point::new(0.04, 0.04)), "{made:?}");
    }

    #[test]
    fn an_arc_whose_ends_have_passed_each_other_does_not_go_all_the_way_round() {
        let model = Model::Arc { center: Point::origin(), radius: 0.2, hollow: false };
        let on = |bearing: f64| Point::origin() + angle::unit(bearing) * 0.2;
        let sample = |bearing: f64| Sample {
            point: on(bearing),
            from: on(bearing) * 2.0,
            weight: 1.0,
            edges: Vec::new(),
        };
        let seen = [1.0, 0.7, 0.4, 0.2].map(sample);
        let arc = Piece::with_bulge(on(1.0), on(0.2), bulge(&model, &seen, on(1.0), on(0.2)));
        assert!((arc.length() - 0.16).abs() < 1e-9, "{arc:?}");
        assert_eq!(bulge(&model, &seen, on(0.5), on(0.6)), 0.0, "5 radians that nobody saw");
        // What was gone round nearly all the way is drawn all the way.
        let round: Vec<Sample> = (0..12).map(|k| sample(6.0 - 0.5 * f64::from(k))).collect();
        let arc = Piece::with_bulge(on(6.0), on(0.5), bulge(&model, &round, on(6.0), on(0.5)));
        assert!((arc.length() - 1.1).abs() < 1e-9, "{arc:?}");
    }

    #[test]
    fn a_piece_that_goes_back_on_the_one_before_is_left_out() {
        let folded = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (3.5, 3.0), (3.505, 3.00005), (0.0, 3.0)];
        let mended =
            simple(&Ring::polygon(&folded.map(|(x, y)| Point::new(x, y)))).expect("a room");
        assert_eq!(mended.pieces.len(), 5, "{mended:?}");
        assert!((mended.area() - 12.0).abs() < 0.001, "{}", mended.area());
        // A board seen from both sides and not at its end is no spike.
        let board =
            [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (2.001, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)];
        let board = Ring::polygon(&board.map(|(x, y)| Point::new(x, y)));
        assert_eq!(simple(&board), Some(board));
    }

    #[test]
    fn a_board_whose_faces_have_changed_places_at_its_foot_is_no_small_loop() {
        // What lies between the faces is short; the faces are not.
        let corners = [
            (0.0, 0.0),
            (0.41, 0.004),
            (0.404, 1.215),
            (0.419, 1.209),
            (0.408, 0.002),
            (2.4, 0.0),
            (2.4, 2.4),
            (0.0, 2.4),
        ];
        let at = |(x, y)| Vertex { at: Point::new(x, y), bulge: 0.0, run: 0 };
        let crossed: Vec<Vertex> = corners.map(at).to_vec();
        assert!(!crossings(&chords(&to_ring(&crossed)).0).is_empty());
        assert_eq!(without_small_loops(crossed).len(), corners.len(), "the board is gone");
    }

    #[test]
    fn faces_of_a_long_board_that_corrections_laid_through_each_other_are_parted() {
        let corners = [
            (0.0, 0.0),
            (2.0, 0.0),
            (1.999, 0.9),
            (2.004, 0.9),
            (2.002, 0.6),
            (1.999, 0.3),
            (2.01, 0.0),
            (4.0, 0.0),
            (4.0, 3.0),
            (0.0, 3.0),
        ];
        let crossed = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        assert!(!crossings(&crossed.to_points(SAGITTA)).is_empty());
        assert_eq!(simple(&crossed), None, "no small loop");
        let parted = with_faces_parted(&crossed).expect("a room with a board");
        assert!(crossings(&parted.to_points(SAGITTA)).is_empty());
        assert!(parted.pieces.iter().any(|piece| piece.from().y == 0.9), "{parted:?}");
        assert!((parted.area() - 12.0).abs() < 0.01, "{}", parted.area());
    }

    #[test]
    fn a_corner_that_was_moved_across_its_neighbours_is_cut_off_and_the_rest_stays() {
        let corners = [(0.0, 0.0), (4.0, 0.0), (4.05, 0.03), (4.0, -0.02), (4.0, 3.0), (0.0, 3.0)];
        let crossed = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        assert!(!crossings(&crossed.to_points(SAGITTA)).is_empty());
        let mended = simple(&crossed).expect("a small loop");
        assert!(crossings(&mended.to_points(SAGITTA)).is_empty());
        assert!((mended.area() - 12.0).abs() < 0.01, "{}", mended.area());
        let square =
            Ring::polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)].map(|(x, y)| Point::new(x, y)));
        assert_eq!(simple(&square), Some(square));
    }
}
