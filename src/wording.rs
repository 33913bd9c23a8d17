//! How figures are written, wherever a person reads them: the same on the screen and in the picture. Knows no
//! maps and no robots.

/// Hours, minutes and seconds.
#[must_use]
pub fn clock(seconds: f64) -> String {
    let whole = seconds.max(0.0) as u64;
    format!("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60)
}

/// A count with its noun.
#[must_use]
pub fn count(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// How a run ended and why, without saying it twice.
#[must_use]
pub fn ended(outcome: &str, reason: &str) -> String {
    if reason.starts_with(outcome) { reason.to_owned() } else { format!("{outcome}: {reason}") }
}

/// The median of some figures; of an even number of them the mean of the two in the middle. None of none.
#[must_use]
pub fn median(figures: &[f64]) -> Option<f64> {
    let mut sorted = figures.to_vec();
    sorted.sort_by(f64::total_cmp);
    let above = *sorted.get(sorted.len() / 2)?;
    let below = sorted[(sorted.len() - 1) / 2];
    Some(f64::midpoint(below, above))
}

/// A standard error: whole millimetres, rounded up as in the map file, from 10 m on metres. What is not known
/// exactly is not 0.
#[must_use]
pub fn error(metres: f64) -> String {
    if metres >= 10.0 {
        return format!("{metres:.1} m");
    }
    format!("{:.0} mm", millimetres(metres))
}

/// A standard error in whole millimetres, rounded up.
#[must_use]
pub fn millimetres(metres: f64) -> f64 {
    (metres * 1e3 - 1e-6).ceil().max(0.0)
}

/// A standard error of a direction, given in radians: hundredths of a degree, rounded up likewise.
#[must_use]
pub fn turn_error(radians: f64) -> String {
    format!("{:.2}°", (radians.to_degrees() * 100.0 - 1e-6).ceil().max(0.0) / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_exactly_is_not_nothing() {
        assert_eq!(error(0.0042), "5 mm");
        assert_eq!(error(0.005), "5 mm");
        assert_eq!(error(1e-5), "1 mm");
        assert_eq!(turn_error(0.1612_f64.to_radians()), "0.17°");
        assert_eq!(turn_error(1e-6), "0.01°");
    }

    #[test]
    fn of_an_even_number_both_in_the_middle_count() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[7.0]), Some(7.0));
        assert_eq!(median(&[5.0, 1.0]), Some(3.0));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[9.0, 4.0, 1.0, 2.0]), Some(3.0));
    }

    #[test]
    fn hours_have_as_many_digits_as_they_need_and_one_has_no_plural() {
        assert_eq!(clock(20_567.9), "5:42:47");
        assert_eq!(clock(-1.0), "0:00:00");
        assert_eq!(count(1, "vertex", "vertices"), "1 vertex");
        assert_eq!(count(0, "vertex", "vertices"), "0 vertices");
    }
}
