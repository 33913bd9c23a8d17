//! The figures under a picture's title, in words.

use super::super::{Outcome, RunRecord, boundary};
use crate::mapping::map::{Part, PartClass, Shape};

/// One line each for the place, the plan and the run.
pub(super) fn lines(record: &RunRecord<'_>) -> Vec<String> {
    [place(record), plan(record), Some(run(record))].into_iter().flatten().collect()
}

fn place(record: &RunRecord<'_>) -> Option<String> {
    let ring = boundary(record)?;
    let mut words = vec![format!(
        "boundary {:.2} m, {:.2} m² reachable within",
        ring.perimeter(),
        ring.area().abs()
    )];
    words.extend(record.map.shape.as_ref().map(shape));
    let count = record.map.objects.len();
    words.push(format!("{count} object{}", if count == 1 { "" } else { "s" }));
    Some(words.join(" · "))
}

fn shape(shape: &Shape) -> String {
    let count = shape.vertices.len();
    let mut words =
        format!("{}, {count} {}", shape.class, if count == 1 { "vertex" } else { "vertices" });
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
        Some((_, radius)) => format!("{class} r {radius:.2}"),
        None => class.to_owned(),
    }
}

fn plan(record: &RunRecord<'_>) -> Option<String> {
    let plan = record.map.plan.as_ref()?;
    let strategy = format!("{:?}", plan.figures.strategy).to_lowercase();
    let mut words = format!(
        "plan {strategy}, α {:.2} m: {} lines, {:.1} m, hidden disc {:.0} mm",
        plan.alpha,
        plan.figures.lines,
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
    if record.outcome != Outcome::Complete || record.map.shortfall().is_some() {
        words = vec![format!("{outcome}: {}", record.reason)];
    }
    words.push(format!(
        "{travel:.1} m driven in {} min {:02} s",
        seconds as u64 / 60,
        seconds as u64 % 60
    ));
    if let Some(off) = &record.map.misclosure {
        let miss = crate::geometry::angle::hypot(off.dx, off.dy) * 1e3;
        words.push(format!("misclosure {miss:.0} mm"));
    }
    if !record.noise.is_empty() {
        words.push(format!("noise {}, seed {}", record.noise, record.settings.seed));
    }
    words.join(" · ")
}
