//! The list of the objects with their sizes. Knows what is to be said of each, not where it is written.

use super::{Row, figures, row, words};
use crate::console::theme::Role;
use crate::session::Snapshot;
use crate::wording;

/// Every object on one row, in as many words as there is `room` for.
pub(super) fn rows(snapshot: &Snapshot, room: u16) -> Vec<Row> {
    let errors = snapshot.map.accuracy.as_ref().map(|accuracy| &accuracy.objects);
    let objects = snapshot.map.objects.iter().enumerate();
    objects
        .map(|(k, object)| {
            let error = errors.and_then(|errors| errors.get(k)).copied();
            let size = object.size().unwrap_or_default();
            let what = forms(&object.class.to_string(), &size, error);
            let what = words::shortened(what, room).unwrap_or_else(|| "found".to_owned());
            let mut row = figures(&format!("O{}", object.id), vec![what], Role::Text);
            row.label_role = Role::Object;
            row
        })
        .collect()
}

/// What is to be said of an object, the longest first. Nothing is shortened by its end.
fn forms(class: &str, size: &str, error: Option<f64>) -> Vec<String> {
    let tight = size.replace(" × ", "×");
    let mut forms = Vec::new();
    if let Some(error) = error {
        let error = wording::error(error);
        forms.push(format!("{class} {size}  ± {error}"));
        forms.push(format!("{class} {tight} ± {error}"));
        forms.push(format!("{tight} ± {error}"));
        forms.push(format!("{tight} ±{error}"));
    }
    forms.push(format!("{class} {size}"));
    forms.push(format!("{class} {tight}"));
    forms.push(tight);
    forms.push(class.to_owned());
    forms
}

/// As many of `rows` as there is room for; where not all fit, how many more there are.
pub(super) fn fitting(mut rows: Vec<Row>, height: u16) -> Vec<Row> {
    let height = usize::from(height);
    if rows.len() > height && height > 0 {
        let more = rows.len() - (height - 1);
        rows.truncate(height - 1);
        rows.push(row("", format!("and {more} more"), Role::Muted));
    }
    rows.truncate(height);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_said_of_an_object_gets_shorter_and_never_loses_a_digit_or_a_unit() {
        let mut last = u16::MAX;
        for room in (4..40).rev() {
            let forms = forms("concave", "1.20 × 1.15 m", Some(0.015));
            let Some(text) = words::shortened(forms, room) else { continue };
            let length = crate::console::view::pen::width(&text);
            assert!(length <= room && length <= last, "{room}: {text}");
            assert_eq!(text.contains('±'), text.contains("15 mm"), "{text}");
            assert_eq!(text.contains("1.20"), text.contains("1.15 m"), "{text}");
            last = length;
        }
        assert_eq!(last, 7, "at last the class alone");
    }

    #[test]
    fn what_is_left_out_is_counted() {
        let list = |count: usize, height| {
            let rows = (0..count).map(|k| row(&format!("O{k}"), "", Role::Text)).collect();
            let shown = fitting(rows, height);
            shown.iter().map(|row| row.label.clone() + &row.parts[0]).collect::<Vec<_>>()
        };
        assert_eq!(list(2, 2), ["O0", "O1"]);
        assert_eq!(list(4, 3), ["O0", "O1", "and 2 more"]);
        assert_eq!(list(4, 1), ["and 4 more"]);
        assert!(list(4, 0).is_empty());
    }
}
