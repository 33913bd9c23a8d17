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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_have_as_many_digits_as_they_need_and_one_has_no_plural() {
        assert_eq!(clock(20_567.9), "5:42:47");
        assert_eq!(clock(-1.0), "0:00:00");
        assert_eq!(count(1, "vertex", "vertices"), "1 vertex");
        assert_eq!(count(0, "vertex", "vertices"), "0 vertices");
    }
}
