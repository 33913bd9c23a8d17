//! The command line: `alpha=0.3`, `speed=50`, `export=DIR`, and every action by its name. Owns
//! the grammar and its messages; what a command does is `update`'s business.
//!
//! The stop key stops the robot even while a command is typed, and by default that key is the
//! space bar. So a word and its argument may be parted by `=` as well: `alpha=0.3`.

use super::action::{ACTIONS, Action};
use super::driver::Speed;
use crate::geometry::Pose;
use crate::geometry::pose::PoseError;
use crate::mapping::settings::ALPHA;
use crate::mapping::tape::{Tape, TapeError};
use crate::spelling::nearest;
use thiserror::Error;

/// Commands that take an argument: name, what follows, what it does.
pub const COMMANDS: &[(&str, &str, &str)] = &[
    ("alpha", "M", "set α, metres (0.05 to 2)"),
    ("tape", "WALL=M", "stretch the map to a wall that was taped: W3=4.02; anywhere: X,Y:X,Y=M"),
    ("placed", "X,Y,DEG", "the robot was carried, about there; alone: nobody knows where"),
    ("speed", "N", "so many times as fast as life, or max"),
    ("export", "DIR", "write the map so far"),
    ("at", "SECONDS", "go to that instant, seconds since the run began, forth or back"),
];

/// What commands are for: not every one is of use with each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steered {
    /// A run in the simulator.
    Simulator,
    /// A real robot, whose time is not ours, and whose map is written when the console is left.
    Robot,
    /// A record, which is looked at.
    Replay,
}

impl Steered {
    /// Whether there is anything for `action` to do here, however the run stands.
    #[must_use]
    pub fn offers(self, action: Action) -> bool {
        match (self, action) {
            (Self::Robot, Action::SlowDown | Action::SpeedUp) => false,
            (Self::Replay, action) => !action.changes_the_run(),
            (Self::Simulator | Self::Robot, _) => true,
        }
    }

    /// Why there is not, in words; nothing is refused in the simulator.
    #[must_use]
    pub fn refusal(self) -> &'static str {
        match self {
            Self::Simulator => "",
            Self::Robot => "a real robot has one speed",
            Self::Replay => "a replay: what happened is looked at, not changed",
        }
    }

    /// Whether the command called `name` does anything here.
    #[must_use]
    pub fn takes(self, name: &str) -> bool {
        match (name, self) {
            ("at", steered) => steered == Self::Replay,
            ("export", steered) => steered == Self::Simulator,
            ("speed", steered) => steered != Self::Robot,
            ("alpha" | "tape" | "placed", steered) => steered != Self::Replay,
            (name, steered) => Action::named(name).is_none_or(|action| steered.offers(action)),
        }
    }
}

/// What was typed, understood.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// An action by its name.
    Action(Action),
    /// Another α, metres.
    Alpha(f64),
    /// A length taped between two places.
    Tape(Tape),
    /// The length of a wall, taped.
    TapeWall {
        /// The wall, counted from 0.
        wall: usize,
        /// What the tape said, metres.
        length: f64,
    },
    /// The robot was carried, about there if anybody knows.
    Placed(Option<Pose>),
    /// Another speed.
    Speed(Speed),
    /// Write the map to a folder.
    Export(String),
    /// Go to an instant of a record, seconds.
    At(f64),
}

/// What was typed, not understood.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum CommandError {
    /// Nothing but space.
    #[error("nothing typed")]
    Empty,
    /// No such command.
    #[error("no command `{word}`{}", .meant.as_ref().map_or_else(|| "; the help lists them".to_owned(), |name| format!("; did you mean `{name}`?")))]
    Unknown {
        /// What was typed.
        word: String,
        /// What was likely meant.
        meant: Option<String>,
    },
    /// α out of range or not a number.
    #[error("alpha needs metres from 0.05 to 2, such as `alpha=0.3`")]
    Alpha,
    /// No tape.
    #[error("{0}")]
    Tape(#[from] TapeError),
    /// No wall, or no length.
    #[error("a wall's taped length is WALL=M, such as `tape=W3=4.02`; the list shows the walls")]
    TapeWall,
    /// A wall's length that is none.
    #[error("`{text}` is no number: a wall's taped length is WALL=M, such as `tape=W3=4.02`")]
    TapeLength {
        /// What was typed.
        text: String,
    },
    /// No pose.
    #[error("placed takes nothing or a pose: {0}")]
    Placed(#[from] PoseError),
    /// Not one of the steps.
    #[error("speed needs one of {}", Speed::all())]
    Speed,
    /// No folder named.
    #[error("export needs a folder, such as `export=my-map`")]
    Export,
    /// No instant.
    #[error("at needs seconds since the run began, such as `at=90`")]
    At,
    /// A plan cannot be chosen any more.
    #[error(
        "`plan` shows and hides the lines; which plan is made is chosen at the start: \
         --plan paper, lean or lanes"
    )]
    Plan,
    /// An argument where none belongs.
    #[error("`{name}` stands alone")]
    Alone {
        /// The action.
        name: String,
    },
}

impl Command {
    /// Reads a command line, without its colon.
    ///
    /// # Errors
    /// What is wrong and what to type instead.
    pub fn parse(text: &str) -> Result<Self, CommandError> {
        let text = text.trim();
        let (word, argument) = text.split_once([' ', '=']).unwrap_or((text, ""));
        let argument = argument.trim();
        match word {
            "" => Err(CommandError::Empty),
            "alpha" => parse_alpha(argument).map(Self::Alpha),
            "tape" if argument.starts_with(['W', 'w']) => parse_wall(argument),
            "tape" => Ok(Self::Tape(argument.parse()?)),
            "placed" if argument.is_empty() => Ok(Self::Placed(None)),
            "placed" => Ok(Self::Placed(Some(argument.parse()?))),
            "speed" => parse_speed(argument).map(Self::Speed),
            "at" => {
                let seconds: Option<f64> = without_unit(argument, 's').parse().ok();
                let instant = |seconds: &f64| seconds.is_finite() && *seconds >= 0.0;
                seconds.filter(instant).map(Self::At).ok_or(CommandError::At)
            }
            "export" if argument.is_empty() => Err(CommandError::Export),
            "export" => Ok(Self::Export(argument.to_owned())),
            _ => match Action::named(word) {
                Some(action) if argument.is_empty() => Ok(Self::Action(action)),
                Some(Action::TogglePlan) => Err(CommandError::Plan),
                Some(_) => Err(CommandError::Alone { name: word.to_owned() }),
                None => Err(CommandError::Unknown {
                    word: word.to_owned(),
                    meant: nearest(word, names()).or_else(|| begun(word)).map(str::to_owned),
                }),
            },
        }
    }

    /// What `text` completes to: as far as all commands that begin with it, and are of use, agree.
    #[must_use]
    pub fn complete(text: &str, steered: Steered) -> Option<String> {
        let mut matching = Self::candidates(text, steered);
        let first = matching.next()?;
        let Some(second) = matching.next() else {
            let takes_more = COMMANDS.iter().any(|(name, ..)| *name == first);
            return Some(if takes_more { format!("{first}=") } else { first.to_owned() });
        };
        let shared =
            |a: &str, b: &str| a.bytes().zip(b.bytes()).take_while(|(a, b)| a == b).count();
        let length =
            matching.fold(shared(first, second), |least, name| least.min(shared(first, name)));
        Some(first.get(..length).unwrap_or(text).to_owned())
    }

    /// The commands that begin with `text` and are of use, for the prompt to show.
    pub fn candidates(text: &str, steered: Steered) -> impl Iterator<Item = &'static str> {
        names().filter(move |name| name.starts_with(text) && steered.takes(name))
    }
}

/// The one name that begins with `word`; none when there are more.
fn begun(word: &str) -> Option<&'static str> {
    let mut all = names().filter(|name| name.starts_with(word));
    all.next().filter(|_| all.next().is_none())
}

/// The names of all commands.
fn names() -> impl Iterator<Item = &'static str> {
    COMMANDS.iter().map(|&(name, ..)| name).chain(ACTIONS.iter().map(|info| info.name))
}

/// `text` without the unit that it may end with. Not without two of them: millimetres are no metres.
fn without_unit(text: &str, unit: char) -> &str {
    text.strip_suffix(unit).unwrap_or(text).trim()
}

fn parse_alpha(text: &str) -> Result<f64, CommandError> {
    let value: Result<f64, _> = without_unit(text, 'm').parse();
    value.ok().filter(|alpha| (ALPHA.0..=ALPHA.1).contains(alpha)).ok_or(CommandError::Alpha)
}

fn parse_wall(text: &str) -> Result<Command, CommandError> {
    let (wall, length) = text.split_once(['=', ' ']).ok_or(CommandError::TapeWall)?;
    let wall: Option<usize> = wall.trim()[1..].parse().ok();
    let wall = wall.and_then(|wall| wall.checked_sub(1)).ok_or(CommandError::TapeWall)?;
    let length = length.trim_start_matches(['=', ' ']).trim_end();
    match without_unit(length, 'm').parse::<f64>() {
        Ok(metres) if metres.is_finite() => Ok(Command::TapeWall { wall, length: metres }),
        _ if length.is_empty() => Err(CommandError::TapeWall),
        _ => Err(CommandError::TapeLength { text: length.to_owned() }),
    }
}

fn parse_speed(text: &str) -> Result<Speed, CommandError> {
    if text == "max" {
        return Ok(Speed::MAX);
    }
    let times = text.trim_start_matches(['x', '×']).parse().ok();
    times.and_then(Speed::of).ok_or(CommandError::Speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;

    #[test]
    fn commands_are_understood() {
        for (text, command) in [
            ("alpha 0.3", Command::Alpha(0.3)),
            ("alpha=0.3", Command::Alpha(0.3)),
            (" alpha  .3 m ", Command::Alpha(0.3)),
            ("tape=0,0:5,0=5.02", Command::Tape("0,0:5,0=5.02".parse().unwrap())),
            ("tape=W3=4.02", Command::TapeWall { wall: 2, length: 4.02 }),
            ("tape w12 = 0.9 m", Command::TapeWall { wall: 11, length: 0.9 }),
            ("placed", Command::Placed(None)),
            ("placed=1,-2.5,90", Command::Placed(Some(Pose::new(1.0, -2.5, angle::FRAC_PI_2)))),
            ("speed 50", Command::Speed(Speed::of(50.0).unwrap())),
            ("speed max", Command::Speed(Speed::MAX)),
            ("export some where", Command::Export("some where".to_owned())),
            ("at=90", Command::At(90.0)),
            ("at 2.5 s", Command::At(2.5)),
            ("quit", Command::Action(Action::Quit)),
            ("step-phase", Command::Action(Action::StepPhase)),
        ] {
            assert_eq!(Command::parse(text), Ok(command), "{text}");
        }
    }

    #[test]
    fn what_is_not_understood_says_what_to_type() {
        for (text, says) in [
            ("", "nothing typed"),
            ("alhpa 3", "no command `alhpa`; did you mean `alpha`?"),
            ("alpha", "alpha needs metres"),
            ("alpha nan", "alpha needs metres"),
            ("alpha 0", "alpha needs metres"),
            ("alpha inf", "alpha needs metres"),
            ("alpha 2 mm", "alpha needs metres"),
            ("alpha=.3mm", "alpha needs metres"),
            ("tape W3=4.02mm", "`4.02mm` is no number"),
            ("tape 0,0:5,0=5.02 mm", "a taped length is X,Y:X,Y=M"),
            ("at 2ss", "at needs seconds"),
            ("tape 5", "a taped length is X,Y:X,Y=M"),
            ("tape 0,0:5,0=0.1", "a taped length is 0.2 m at least"),
            ("tape W=3", "a wall's taped length is WALL=M"),
            ("tape W0=3", "a wall's taped length is WALL=M"),
            ("tape W3", "a wall's taped length is WALL=M"),
            ("tape W3=nan", "`nan` is no number: a wall's taped length is WALL=M"),
            ("tape W3=inf", "`inf` is no number"),
            ("tape W3=four", "`four` is no number"),
            (
                "plan=paper",
                "`plan` shows and hides the lines; which plan is made is chosen at the start",
            ),
            (
                "plan=lean",
                "`plan` shows and hides the lines; which plan is made is chosen at the start: --plan",
            ),
            ("tape W\u{fc}=3", "a wall's taped length is WALL=M"),
            ("placed 3", "placed takes nothing or a pose: a pose is X,Y,DEG"),
            ("placed 1,2,nan", "placed takes nothing or a pose: `nan` is not a finite number"),
            ("speed 3", "speed needs one of 1, 2, 5"),
            ("export", "export needs a folder"),
            ("at", "at needs seconds"),
            ("at -3", "at needs seconds"),
            ("stop now", "`stop` stands alone"),
            ("zzzzz", "no command `zzzzz`; the help lists them"),
            ("q", "no command `q`; did you mean `quit`?"),
            ("s", "no command `s`; the help lists them"),
        ] {
            let message = Command::parse(text).map_err(|error| error.to_string());
            assert!(message.clone().is_err_and(|m| m.starts_with(says)), "{text}: {message:?}");
        }
    }

    #[test]
    fn names_complete_as_far_as_they_agree() {
        let complete = |text| Command::complete(text, Steered::Simulator);
        assert_eq!(complete("al").as_deref(), Some("alpha"));
        assert_eq!(complete("sp").as_deref(), Some("speed="));
        assert_eq!(complete("q").as_deref(), Some("quit"));
        assert_eq!(complete("st").as_deref(), Some("st"));
        assert_eq!(complete("pan").as_deref(), Some("pan-"));
        assert_eq!(complete("zzz"), None);
    }

    #[test]
    fn only_what_is_of_use_is_offered() {
        let offered = |steered| Command::candidates("", steered).collect::<Vec<_>>();
        for (word, simulator, robot, replay) in [
            ("alpha", true, true, false),
            ("export", true, false, false),
            ("at", false, false, true),
            ("speed", true, false, true),
            ("faster", true, false, true),
            ("clear", true, true, false),
            ("fit", true, true, true),
        ] {
            let here = [Steered::Simulator, Steered::Robot, Steered::Replay]
                .map(|steered| offered(steered).contains(&word));
            assert_eq!(here, [simulator, robot, replay], "{word}");
        }
        // To `at` nothing but `at` begins there.
        assert_eq!(Command::complete("a", Steered::Replay).as_deref(), Some("at="));
    }
}
