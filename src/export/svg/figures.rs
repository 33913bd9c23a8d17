//! The figures under a picture's title, in words.

use super::super::{Outcome, PHASES, RunRecord};
use super::dimensions;
use crate::geometry::Ring;
use crate::mapping::map::{Part, PartClass, Phase, Shape, ShapeClass};
use crate::wording::{self, clock, count, ended};

/// One line each for the place, how well it is known, the plan, what was not reached, and the run.
pub(super) fn lines(record: &RunRecord<'_>, wall: Option<&Ring>) -> Vec<String> {
    let run = Some(run(record));
    let all = [
        wall.map(|ring| place(record, ring)),
        errors(record),
        plan(record),
        unreached(record),
        run,
    ];
    all.into_iter().flatten().collect()
}

fn place(record: &RunRecord<'_>, ring: &Ring) -> String {
    let mut words = Vec::new();
    words.extend(dimensions::overall(ring).map(|(x, y)| format!("{x:.2} × {y:.2} m overall")));
    words.push(format!("{:.2} m²", ring.area().abs()));
    words.push(format!("perimeter {:.2} m", ring.perimeter()));
    words.extend(record.map.shape.as_ref().map(shape));
    if record.map.squared.is_some() {
        words.push("right angles made right".to_owned());
    }
    // Before they were looked for, none were found.
    let [.., objects] = &record.progress;
    if objects.done || !record.map.objects.is_empty() {
        words.push(count(record.map.objects.len(), "object", "objects"));
    }
    words.join(" · ")
}

/// The smallest and the largest of some values, without what is no number.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let mut values = values.filter(|value| value.is_finite());
    let first = values.next()?;
    Some(values.fold((first, first), |(low, high), v| (low.min(v), high.max(v))))
}

/// From the smallest to the largest in a unit, which may read the same.
fn span((low, high): (f64, f64)) -> String {
    let (low, high) = (format!("{low:.0}"), format!("{high:.0}"));
    if low == high { low } else { format!("{low}–{high}") }
}

/// The median and the worst of each kind, as in the report.
fn errors(record: &RunRecord<'_>) -> Option<String> {
    let known = record.map.accuracy.as_ref()?;
    let of = |name: &str, all: &[f64]| {
        let worst = all.iter().copied().fold(0.0, f64::max);
        let (median, worst) =
            (wording::millimetres(wording::median(all)?), wording::millimetres(worst));
        Some(format!("{name} ± {median:.0} ({worst:.0}) mm"))
    };
    let objects = &known.objects[..known.objects.len().min(record.map.objects.len())];
    let all = [of("walls", &known.walls), of("corners", &known.corners), of("objects", objects)];
    let words: Vec<String> = all.into_iter().flatten().collect();
    let whole = known.datum.map_or_else(String::new, |datum| {
        format!(
            "; of that the whole map ± {} and ± {}, a wall among the others ± {}",
            wording::turn_error(datum.turn),
            wording::error(datum.shift),
            wording::error(datum.within)
        )
    });
    let words = words.join(", ");
    (!words.is_empty()).then(|| format!("standard errors, median (worst): {words}{whole}"))
}

fn unreached(record: &RunRecord<'_>) -> Option<String> {
    let gaps = &record.map.unreached;
    let told = |known: bool| {
        let of_it = gaps.iter().filter(move |gap| gap.area.is_some() == known);
        let widths = range(of_it.clone().map(|gap| gap.width * 100.0));
        Some((of_it.count(), span(widths?)))
    };
    let mut words = Vec::new();
    if let Some((number, wide)) = told(false) {
        let stretches = count(number, "stretch", "stretches");
        let what = if number == 1 { "a gap or a short wall" } else { "gaps or short walls" };
        words.push(format!("{stretches} not touched, {wide} cm wide: {what}"));
    }
    if let Some((number, wide)) = told(true) {
        let area: f64 = gaps.iter().filter_map(|gap| gap.area).sum();
        let gaps = count(number, "gap", "gaps");
        words.push(format!("{gaps} too narrow, {wide} cm wide, with {area:.2} m² behind"));
    }
    (!words.is_empty()).then(|| words.join(" · "))
}

fn shape(shape: &Shape) -> String {
    // A circle has no vertices, and what is told of one is its size.
    if let (ShapeClass::Circle, Some((_, radius))) =
        (shape.class, shape.parts.first().and_then(|part| part.circle))
    {
        return format!("circle ⌀ {:.2} m", 2.0 * radius);
    }
    if shape.class == ShapeClass::Circle {
        return "circle".to_owned();
    }
    let mut words =
        format!("{}, {}", shape.class, count(shape.vertices.len(), "vertex", "vertices"));
    if shape.parts.len() > 1 {
        let parts: Vec<String> = shape.parts.iter().map(part).collect();
        words = format!("{words} ({})", parts.join(" + "));
    }
    words
}

fn part(part: &Part) -> String {
    let class = match part.class {
        PartClass::Convex => "convex",
        PartClass::Concave => "concave",
        PartClass::Circle => "circle",
        PartClass::Semicircle => "semicircle",
        PartClass::Sector => "sector",
    };
    match part.circle {
        Some((_, radius)) => format!("{class} r {radius:.2} m"),
        None => class.to_owned(),
    }
}

fn plan(record: &RunRecord<'_>) -> Option<String> {
    let plan = record.map.plan.as_ref()?;
    let strategy = format!("{:?}", plan.figures.strategy).to_lowercase();
    let mut lines = count(plan.figures.lines, "line", "lines");
    let added = plan.added().count();
    if added > 0 {
        lines = format!("{lines} and {added} added");
    }
    let mut words = format!(
        "plan {strategy}, α {:.2} m: {lines}, {:.1} m, hidden disc {:.0} mm",
        plan.alpha,
        plan.figures.length,
        plan.figures.hidden_disc * 1e3
    );
    if let Some(driven) = record.map.hidden_disc {
        words = format!("{words} (as driven {:.0} mm)", driven * 1e3);
    }
    Some(words)
}

fn run(record: &RunRecord<'_>) -> String {
    let outcome = match record.outcome {
        Outcome::Complete => "complete",
        Outcome::Stopped => "stopped",
        Outcome::Failed => "failed",
    };
    let seconds: f64 = record.progress.iter().map(|phase| phase.seconds).sum();
    let travel: f64 = record.progress.iter().map(|phase| phase.travel).sum();
    let mut words = vec![outcome.to_owned()];
    let mut done = PHASES.into_iter().zip(record.progress).filter(|(_, progress)| progress.done);
    if let Some((last, _)) = done.next_back().filter(|(last, _)| *last != Phase::Objects) {
        words = vec![format!("{outcome} up to the {last} phase")];
    }
    if record.outcome != Outcome::Complete || record.map.shortfall().is_some() {
        words = vec![ended(outcome, record.reason)];
    }
    words.push(format!("{travel:.1} m driven in {}", clock(seconds)));
    if let Some(off) = &record.map.misclosure {
        let miss = crate::geometry::angle::hypot(off.dx, off.dy) * 1e3;
        words.push(format!("misclosure {miss:.0} mm"));
    }
    if let Some(alike) = &record.map.alike {
        words.push(format!("closes as well {}", alike.where_to()));
    }
    if !record.noise.is_empty() {
        words.push(format!("noise {}, seed {}", record.noise, record.settings.seed));
    }
    words.join(" · ")
}
