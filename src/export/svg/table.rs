//! The table of the objects below a map on which there is no room for their sizes.

use super::super::RunRecord;
use super::super::strokes::{Anchor, Lettering, width};
use super::legend::TEXT;
use super::{FIGURES, MARGIN};
use crate::wording;

/// From one line to the next, pixels.
const LINE: f64 = 16.0;
/// Between the columns of an entry, and between entries, pixels.
const BETWEEN: f64 = 10.0;
const APART: f64 = 34.0;

/// One object in words: number, size, standard error.
type Entry = [String; 3];

/// The table on a sheet of the given width, from the given y; and the y below it.
pub(super) fn draw(
    record: &RunRecord<'_>,
    (sheet, top): (f64, f64),
    letters: &mut Lettering,
) -> (String, f64) {
    let entries = entries(record);
    let widest = |column: usize| {
        entries.iter().map(|entry| width(&entry[column], TEXT.height)).fold(0.0, f64::max)
    };
    let widths = [widest(0), widest(1), widest(2)];
    let step = widths.iter().sum::<f64>() + 2.0 * BETWEEN + APART;
    let columns = (((sheet - 2.0 * MARGIN + APART) / step) as usize).max(1);
    let rows = entries.len().div_ceil(columns);
    let title = "objects: longer × shorter side, ± standard error of the place";
    let title = super::shortened(title, sheet - 2.0 * MARGIN, FIGURES.height);
    let mut out = letters.text(&title, MARGIN, top, Anchor::Start, FIGURES);
    for (k, [name, size, error]) in entries.iter().enumerate() {
        let x = MARGIN + (k / rows.max(1)) as f64 * step;
        let y = top + LINE * ((k % rows.max(1)) as f64 + 1.3);
        out.push_str(&letters.text(name, x, y, Anchor::Start, TEXT));
        let right = x + widths[0] + BETWEEN + widths[1];
        out.push_str(&letters.text(size, right, y, Anchor::End, TEXT));
        let right = right + BETWEEN + widths[2];
        out.push_str(&letters.text(error, right, y, Anchor::End, TEXT));
    }
    (out, top + LINE * (rows as f64 + 1.3))
}

fn entries(record: &RunRecord<'_>) -> Vec<Entry> {
    let error = |k: usize| {
        let known = record.map.accuracy.as_ref().and_then(|accuracy| accuracy.objects.get(k));
        known.map_or_else(String::new, |error| format!("± {}", wording::error(*error)))
    };
    let objects = record.map.objects.iter().enumerate();
    objects
        .map(|(k, object)| {
            let size = object.size().unwrap_or_default();
            [format!("O{}", object.id), size, error(k)]
        })
        .collect()
}
