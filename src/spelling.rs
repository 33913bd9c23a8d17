//! What somebody likely meant who wrote something else, and what a reader of files means that says it oddly.

/// Nobody means a name with a word of more letters.
const LONGEST: usize = 60;

/// The one of `names` that `word` was most likely meant to be; none when nothing is near.
#[must_use]
pub fn nearest<'a>(word: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters = word.chars().count();
    if letters > LONGEST {
        return None;
    }
    // Between words of a letter or two everything is near.
    let far = (1 + letters / 3).min(letters.saturating_sub(1));
    names
        .into_iter()
        .map(|name| (distance(word, name), name))
        .filter(|&(distance, name)| distance <= far || (word.len() > 1 && name.starts_with(word)))
        .min_by_key(|&(distance, name)| (!name.starts_with(word), distance))
        .map(|(_, name)| name)
}

/// How many letters must be added, dropped, changed or swapped to turn `a` into `b`
/// (optimal string alignment).
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                let change = table[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let best = change.min(table[i - 1][j] + 1).min(table[i][j - 1] + 1);
                if swap { best.min(table[i - 2][j - 2] + 1) } else { best }
            };
        }
    }
    table[a.len()][b.len()]
}

/// The complaint about a `key` that is none of `known`: with the one that was likely meant, or else with
/// all there are.
#[must_use]
pub fn unknown_key(key: &str, known: &[&str]) -> String {
    let shown: String = key.chars().take(LONGEST).collect();
    match nearest(key, known.iter().copied()) {
        Some(name) => format!("unknown key `{shown}`, did you mean `{name}`?"),
        None => format!("unknown key `{shown}`; those there are: {}", known.join(", ")),
    }
}

/// What the reader of TOML `said`, in plain words where they are known.
#[must_use]
pub fn plainly(said: &str) -> &str {
    match said.trim() {
        "invalid mantissa, expected digits" => {
            "a number has digits on both sides of its point, as in 0.2"
        }
        said if said.starts_with("invalid float, expected `nan`")
            || said.starts_with("string values must be") =>
        {
            "a value is a number without a unit, as in 0.2, or text in quotes, as in \"none\""
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_name_is_the_one_meant_and_a_far_one_is_not() {
        let names = ["stop", "quit", "step-command", "trajectory", "alpha"];
        let meant = |word| nearest(word, names);
        assert_eq!(meant("stpo"), Some("stop"));
        assert_eq!(meant("quti"), Some("quit"));
        assert_eq!(meant("step-comand"), Some("step-command"));
        assert_eq!(meant("traj"), Some("trajectory"));
        assert_eq!(meant("xylophone"), None);
        assert_eq!(nearest("z", ["x", "y"]), None);
        assert_eq!(meant(&"stop".repeat(20_000)), None);
    }

    #[test]
    fn what_the_reader_says_of_words_without_quotes_is_said_plainly() {
        for text in ["noise=none", "x=1m", "radius = 0.12 m", "world=room.toml"] {
            let said = text.parse::<toml::Table>().expect_err("no TOML").message().to_owned();
            assert!(!plainly(&said).contains("nan"), "{text}: {said}");
        }
        for text in ["noise=none", "x=1m"] {
            let said = text.parse::<toml::Table>().expect_err("no TOML").message().to_owned();
            assert!(plainly(&said).contains("in quotes"), "{text}: {said}");
        }
    }

    #[test]
    fn a_far_key_is_told_what_there_is() {
        let keys = ["radius", "circle"];
        assert!(unknown_key("radus", &keys).ends_with("did you mean `radius`?"));
        let told = unknown_key("colour", &["radius", "vertices"]);
        assert!(told.ends_with("those there are: radius, vertices"), "{told}");
        assert!(unknown_key(&"x".repeat(50_000), &keys).len() < 200);
    }
}
