//! Cuts the ordered contacts into runs that one line or one arc explains, by dynamic programming:
//! the cheapest explanation of all contacts, where each run costs a fixed penalty and each
//! contact the square of its distance in units of the noise. Knows nothing of corners.

use super::Sample;
use super::corner::heading;
use crate::geometry::fit::{CircleFit, LineFit, Moments};
use crate::geometry::{Point, Vector, angle, cross};

/// What a straight run or a lone contact costs.
const LINE_PENALTY: f64 = 11.0;
/// What a circular run costs: it has one number more, and should not replace a corner.
const ARC_PENALTY: f64 = 18.0;
/// Longest run that is tried, in contacts; longer ones come from merging.
const LONGEST: usize = 220;
/// Fewest contacts that may make an arc.
const ARC_CONTACTS: usize = 7;
/// An arc must span this much at least, radians: 25 degrees.
pub(super) const ARC_SPAN: f64 = 25.0 * angle::PI / 180.0;
/// Two neighbours on one piece may lie this far apart at most, metres: along a straight wall the
/// robot looks every half metre ...
const WIDEST_GAP: f64 = 0.65;
/// ... and along a round one no farther than this share of its radius.
pub(super) const WIDEST_ON_ARC: f64 = 0.5;
/// The end of a straight wall, in a corner, lies no farther than this from the rest of what was seen of the
/// wall, metres: one look between them that told nothing.
const UNSEEN: f64 = 1.0;
/// Contacts that stand out of an otherwise straight wall, and are taken for mistaken ones, are no more
/// than this many ...
const MOST_MISTAKEN: usize = 2;
/// ... no farther from it than this, metres: nothing that stands out so little has so few contacts ...
const MISTAKEN_BY: f64 = 0.08;
/// ... and the wall has at least so many to either side.
const LEAST_BESIDE: usize = 3;
/// The same for contacts in a corner, in standard deviations of a contact: how far chance puts one off its
/// wall, and how far apart two may be that are no wall of their own.
const BY_CHANCE: f64 = 5.0;
const NO_WALL: f64 = 10.0;
/// Smallest radius of an arc with the floor inside it, metres: the body could not have been there
/// otherwise.
const HOLLOW_RADIUS: f64 = 0.25;
/// Smallest radius of an arc that bulges into the floor, metres.
const BULGE_RADIUS: f64 = 0.03;
/// Largest radius that is told from a straight wall, metres.
const LARGEST_RADIUS: f64 = 40.0;

/// What explains a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Model {
    /// Nothing but the contact itself.
    Lone(Point),
    /// A straight wall through `center`, travelled along the unit vector `direction`.
    Line { center: Point, direction: Vector },
    /// A circular wall; `hollow` when the floor lies inside the circle (counter-clockwise way).
    Arc { center: Point, radius: f64, hollow: bool },
}

/// Contacts `first..=last` and what explains them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) model: Model,
}

impl Run {
    /// Distance of `p` from the (unbounded) line or circle, metres.
    pub(super) fn distance(&self, p: Point) -> f64 {
        match self.model {
            Model::Lone(at) => (p - at).norm(),
            Model::Line { center, direction } => cross(direction, p - center).abs(),
            Model::Arc { center, radius, .. } => ((p - center).norm() - radius).abs(),
        }
    }
}

/// The runs of `samples`, which are rotated so that no run wraps round their end. `sigma` is the
/// noise of a contact, metres.
pub(super) fn runs(samples: &mut [Sample], sigma: f64) -> Vec<Run> {
    let mut found = cheapest(samples, sigma);
    // The seam was arbitrary: begin again where a run ends, far from it.
    if let Some(run) = found.get(found.len() / 2) {
        let shift = run.first;
        samples.rotate_left(shift);
        found = cheapest(samples, sigma);
    }
    merge(samples, &mut found, sigma);
    while pass_over(samples, &mut found, sigma)
        || pass_over_between(samples, &mut found, sigma)
        || pass_over_at_corner(samples, &mut found, sigma)
    {
        merge(samples, &mut found, sigma);
    }
    merge_over_seam(samples, &mut found, sigma);
    found
}

#[derive(Clone, Copy)]
struct Step {
    cost: f64,
    from: usize,
    model: Model,
}

fn cheapest(samples: &[Sample], sigma: f64) -> Vec<Run> {
    let count = samples.len();
    let start = Step { cost: 0.0, from: 0, model: Model::Lone(Point::origin()) };
    let unknown = Step { cost: f64::INFINITY, ..start };
    let mut best = vec![unknown; count + 1];
    best[0] = start;
    for i in 0..count {
        extend(samples, sigma, i, &mut best);
    }
    let mut runs = Vec::new();
    let mut end = count;
    while end > 0 {
        let step = best[end];
        runs.push(Run { first: step.from, last: end - 1, model: step.model });
        end = step.from;
    }
    runs.reverse();
    runs
}

/// Tries all runs that begin at contact `i`.
fn extend(samples: &[Sample], sigma: f64, i: usize, best: &mut [Step]) {
    let base = best[i].cost;
    let mut offer = |end: usize, cost: f64, model: Model| {
        if base + cost < best[end].cost {
            best[end] = Step { cost: base + cost, from: i, model };
        }
    };
    offer(i + 1, LINE_PENALTY, Model::Lone(samples[i].point));
    let mut moments = Moments::new(samples[i].point);
    moments.add(samples[i].point, samples[i].weight);
    let unit = sigma * sigma;
    let mut hopeless = 0;
    for k in i + 1..samples.len().min(i + LONGEST) {
        if (samples[k].point - samples[k - 1].point).norm() > WIDEST_GAP {
            break;
        }
        moments.add(samples[k].point, samples[k].weight);
        let mut fits = false;
        if let Some(line) = moments.line() {
            let cost = line.residual / unit;
            fits |= cost < 4.0 * (k - i + 4) as f64;
            offer(
                k + 1,
                LINE_PENALTY + cost,
                line_model(&line, samples[i].point, samples[k].point),
            );
        }
        if k - i + 1 >= ARC_CONTACTS
            && let Some(circle) = moments.circle()
        {
            let cost = circle.residual / unit;
            let close = cost < 4.0 * (k - i + 4) as f64;
            fits |= close;
            if close && let Some(model) = arc_model(&circle, &samples[i..=k]) {
                offer(k + 1, ARC_PENALTY + cost, model);
            }
        }
        hopeless = if fits || k - i < ARC_CONTACTS { 0 } else { hopeless + 1 };
        if hopeless > 4 {
            break;
        }
    }
}

fn line_model(line: &LineFit, first: Point, last: Point) -> Model {
    let forward = line.direction.dot(&(last - first)) >= 0.0;
    Model::Line {
        center: line.center,
        direction: if forward { line.direction } else { -line.direction },
    }
}

/// The arc that a circle makes of a run; none where the radius, the span or the gaps between the
/// contacts forbid one.
fn arc_model(circle: &CircleFit, samples: &[Sample]) -> Option<Model> {
    if circle.radius > LARGEST_RADIUS || circle.radius < BULGE_RADIUS {
        return None;
    }
    let bearing = |s: &Sample| s.point - circle.center;
    let (first, last) = (samples.first()?, samples.last()?);
    let middle = &samples[samples.len() / 2];
    let span = turn(bearing(first), bearing(middle)) + turn(bearing(middle), bearing(last));
    let hollow = span > 0.0;
    let floor_inside = (middle.from - circle.center).norm() < circle.radius;
    let smallest = if hollow { HOLLOW_RADIUS } else { BULGE_RADIUS };
    if span.abs() < ARC_SPAN || hollow != floor_inside || circle.radius < smallest {
        return None;
    }
    // A corner between two clusters of contacts is no arc.
    let widest =
        samples.windows(2).map(|pair| (pair[1].point - pair[0].point).norm()).fold(0.0, f64::max);
    (widest < circle.radius * (span.abs() / 3.0).min(0.9)).then_some(Model::Arc {
        center: circle.center,
        radius: circle.radius,
        hollow,
    })
}

/// Angle from `a` to `b`, radians, in (-π, π].
fn turn(a: Vector, b: Vector) -> f64 {
    angle::atan2(cross(a, b), a.dot(&b))
}

/// Joins neighbours that one line or arc explains within the noise; what the seam or slow drift
/// of the pose cut in two.
fn merge(samples: &[Sample], runs: &mut Vec<Run>, sigma: f64) {
    loop {
        let mut best: Option<(f64, usize, Run)> = None;
        for k in 0..runs.len().saturating_sub(1) {
            if let Some((worst, run)) = joined(samples, &runs[k], &runs[k + 1], sigma)
                && best.is_none_or(|b| worst < b.0)
            {
                best = Some((worst, k, run));
            }
        }
        let Some((_, k, run)) = best else {
            return;
        };
        runs[k] = run;
        runs.remove(k + 1);
    }
}

/// Joins two pieces of one straight wall over a contact or two that stand out of it; false when there
/// are no more such.
fn pass_over(samples: &[Sample], runs: &mut Vec<Run>, sigma: f64) -> bool {
    let size = |run: &Run| run.last - run.first + 1;
    let straight = |run: &Run| matches!(run.model, Model::Line { .. }) && size(run) >= LEAST_BESIDE;
    let over = (0..runs.len().saturating_sub(2)).find_map(|k| {
        let (a, odd, b) = (&runs[k], &runs[k + 1], &runs[k + 2]);
        if size(odd) > MOST_MISTAKEN || !straight(a) || !straight(b) {
            return None;
        }
        let beside: Vec<Sample> =
            samples[a.first..=a.last].iter().chain(&samples[b.first..=b.last]).cloned().collect();
        let left = Run { first: 0, last: size(a) - 1, ..*a };
        let right = Run { first: size(a), last: beside.len() - 1, ..*b };
        let (_, joined) = joined(&beside, &left, &right, sigma)?;
        let near = samples[odd.first..=odd.last]
            .iter()
            .all(|sample| joined.distance(sample.point) < MISTAKEN_BY);
        near.then_some((k, Run { first: a.first, last: b.last, model: joined.model }))
    });
    if let Some((k, run)) = over {
        runs[k] = run;
        runs.drain(k + 1..k + 3);
    }
    over.is_some()
}

/// Joins two pieces of one straight wall of which one ends, where they meet, with a contact or two that stand
/// out of it and turned it aside; false when there are no more such.
fn pass_over_between(samples: &[Sample], runs: &mut Vec<Run>, sigma: f64) -> bool {
    let straight = |run: &Run| matches!(run.model, Model::Line { .. });
    let over = (0..runs.len().saturating_sub(1)).find_map(|k| {
        let (a, b) = (&runs[k], &runs[k + 1]);
        if !straight(a) || !straight(b) {
            return None;
        }
        let without = |from_a: usize, from_b: usize| {
            let (end, start) = (a.last.checked_sub(from_a)?, b.first + from_b);
            if end + 1 < a.first + LEAST_BESIDE || b.last + 1 < start + LEAST_BESIDE {
                return None;
            }
            let beside = [&samples[a.first..=end], &samples[start..=b.last]].concat();
            let cut = end - a.first;
            let left = Run { first: 0, last: cut, model: line_through(&beside[..=cut])? };
            let (first, last) = (cut + 1, beside.len() - 1);
            let right = Run { first, last, model: line_through(&beside[first..])? };
            let (_, joined) = joined(&beside, &left, &right, sigma)?;
            let odd = &samples[end + 1..start];
            let near = odd.iter().all(|sample| joined.distance(sample.point) < MISTAKEN_BY);
            near.then_some((k, Run { first: a.first, last: b.last, model: joined.model }))
        };
        (1..=MOST_MISTAKEN).find_map(|odd| without(0, odd).or_else(|| without(odd, 0)))
    });
    if let Some((k, run)) = over {
        runs[k] = run;
        runs.remove(k + 1);
    }
    over.is_some()
}

/// The straight line that lies best on contacts, in their order.
fn line_through(samples: &[Sample]) -> Option<Model> {
    let (first, last) = (samples.first()?, samples.last()?);
    let mut moments = Moments::new(first.point);
    for sample in samples {
        moments.add(sample.point, sample.weight);
    }
    Some(line_model(&moments.line()?, first.point, last.point))
}

/// Takes a contact or two between the two walls of a corner for parts of these that lie too near to one of
/// them, or to either and to each other, to be a wall of their own: chance put them off by more than it mostly
/// does, or the robot looked once too seldom. What is of one wall and near its end is the end of it from then
/// on, the rest is dropped. False when there are no more such.
fn pass_over_at_corner(samples: &[Sample], runs: &mut Vec<Run>, sigma: f64) -> bool {
    let count = runs.len();
    // What is left is a ring: three walls, or an arc and one more.
    let round = runs.iter().any(|run| matches!(run.model, Model::Arc { .. }));
    if count < if round { 3 } else { 4 } {
        return false;
    }
    let beside = |k: usize| ((k + count - 1) % count, (k + 1) % count);
    let is_of = |run: &Run, sample: &Sample| run.distance(sample.point) < BY_CHANCE * sigma;
    let all_of = |run: &Run, odd: &Run| samples[odd.first..=odd.last].iter().all(|s| is_of(run, s));
    let found = (0..count).find(|&k| {
        let (before, after) = beside(k);
        let (a, odd, b) = (&runs[before], &runs[k], &runs[after]);
        let (Some(u), Some(v)) =
            (heading(&a.model, samples[a.last].point), heading(&b.model, samples[b.first].point))
        else {
            return false;
        };
        let long = |run: &Run| run.last - run.first + 1 >= LEAST_BESIDE;
        let few = odd.last - odd.first < MOST_MISTAKEN;
        // The end of a thin wall has no more contacts than that, and is no mistake.
        let thin = u.dot(&v) < -0.8;
        let length = (samples[odd.last].point - samples[odd.first].point).norm();
        let of_one = all_of(a, odd) || all_of(b, odd);
        let of_either =
            samples[odd.first..=odd.last].iter().all(|sample| is_of(a, sample) || is_of(b, sample));
        few && !thin && long(a) && long(b) && (of_one || (of_either && length < NO_WALL * sigma))
    });
    let Some(k) = found else { return false };
    let (odd, (before, after)) = (runs[k], beside(k));
    let off = |j: usize, end: usize| (samples[j].point - samples[end].point).norm();
    // At the seam, where the numbers begin anew, nothing is handed over: a run has no hole in its numbers.
    if after > k && all_of(&runs[after], &odd) && off(odd.last, runs[after].first) < UNSEEN {
        runs[after].first = odd.first;
    } else if before < k
        && all_of(&runs[before], &odd)
        && off(odd.first, runs[before].last) < UNSEEN
    {
        runs[before].last = odd.last;
    }
    runs.remove(k);
    true
}

fn merge_over_seam(samples: &mut [Sample], runs: &mut Vec<Run>, sigma: f64) {
    let (Some(&first), Some(&last)) = (runs.first(), runs.last()) else {
        return;
    };
    if runs.len() < 3 {
        return;
    }
    let shift = samples.len() - last.first;
    samples.rotate_right(shift);
    let mut turned = runs.clone();
    turned.rotate_right(1);
    for run in &mut turned[1..] {
        run.first += shift;
        run.last += shift;
    }
    turned[0].first = 0;
    turned[0].last = shift - 1;
    if let Some((_, run)) = joined(samples, &turned[0], &turned[1], sigma) {
        turned[0] = run;
        turned.remove(1);
        *runs = turned;
    } else {
        samples.rotate_left(shift);
        debug_assert_eq!((runs[0], runs[runs.len() - 1]), (first, last));
    }
}

/// Two neighbours as one, with its worst residual; none where that exceeds the noise.
fn joined(samples: &[Sample], a: &Run, b: &Run, sigma: f64) -> Option<(f64, Run)> {
    let both = &samples[a.first..=b.last];
    let gap = (samples[b.first].point - samples[a.last].point).norm();
    let mut moments = Moments::new(both[0].point);
    for sample in both {
        moments.add(sample.point, sample.weight);
    }
    let model = match (a.model, b.model) {
        (Model::Line { direction: u, .. }, Model::Line { direction: v, .. }) => {
            if turn(u, v).abs() > 0.05 || gap > WIDEST_GAP {
                return None;
            }
            line_model(&moments.line()?, both[0].point, both[both.len() - 1].point)
        }
        (Model::Arc { hollow, .. }, _) | (_, Model::Arc { hollow, .. }) => {
            let circle = moments.circle()?;
            if circle.radius > LARGEST_RADIUS || gap > WIDEST_ON_ARC * circle.radius {
                return None;
            }
            Model::Arc { center: circle.center, radius: circle.radius, hollow }
        }
        _ => return None,
    };
    let run = Run { first: a.first, last: b.last, model };
    let worst = both.iter().map(|s| run.distance(s.point) * s.weight.sqrt()).fold(0.0, f64::max);
    (worst < 3.0 * sigma + 0.0015).then_some((worst, run))
}

#[cfg(test)]
mod tests;
