//! The values that flags take: how each is written, and what is refused with which words.

use super::{ArgumentError, ThemeName, chassis, config};
use crate::console::layout::{MIN_COLS, MIN_ROWS};
use crate::geometry::Pose;
use crate::geometry::pose::PoseError;
use crate::mapping::map::Phase;
use crate::mapping::settings::{ALPHA, Contour, MOST_LAPS, Settings, Strategy, check_name};
use crate::mapping::tape::{Tape, TapeError};
use crate::robot::Chassis;
use crate::simulator::NoiseProfile;
use crate::wire::told;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::num::IntErrorKind;
use std::path::PathBuf;

/// What every run can be told. A value that is not given may still come from `--config`.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct Common {
    /// How the room is mapped.
    #[command(flatten)]
    pub mapping: MappingFlags,
    /// The robot and what simulates it.
    #[command(flatten)]
    pub robot: RobotFlags,
    /// What is kept of the run.
    #[command(flatten)]
    pub keeping: KeepingFlags,
}

/// What a run can be told of how the room is mapped.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct MappingFlags {
    /// Accuracy factor α in metres, 0.05 to 2: no free-standing object that a disc of this diameter
    /// fits inside is missed [default: 0.25]
    #[arg(long, value_name = "M", value_parser = alpha, allow_negative_numbers = true)]
    pub alpha: Option<f64>,
    /// How the path plan is made [default: lean]
    #[arg(long, value_name = "PLAN", value_parser = strategy())]
    pub plan: Option<Strategy>,
    /// How an object met on a line is gone round [default: full-loop]
    #[arg(long, value_name = "CONTOUR", value_parser = contour())]
    pub contour: Option<Contour>,
    /// Laps of the boundary, 1 to 9; each after the first goes the other way round and is averaged in
    /// [default: 1; to calibrate 2]
    #[arg(long, value_name = "N", value_parser = laps, allow_negative_numbers = true)]
    pub laps: Option<u32>,
    /// Hand over nearly right angles as right ones; what was mapped is kept beside
    #[arg(long)]
    pub square: bool,
    /// A taped length between two points, metres
    #[arg(long, value_name = "X,Y:X,Y=M", value_parser = tape, allow_hyphen_values = true)]
    pub tape: Option<Tape>,
}

/// What a robot can be told that maps nothing by itself.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct RobotFlags {
    /// Noise of the simulated sensors [default: calibrated]
    #[arg(long, value_name = "PROFILE", value_parser = noise())]
    pub noise: Option<NoiseProfile>,
    /// Seed of everything random [default: 1]
    #[arg(long, value_name = "N", value_parser = seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,
    /// Start pose: metres, and degrees counter-clockwise from +x [default: the world's; at a port
    /// 0,0,0]
    #[arg(long, value_name = "X,Y,DEG", value_parser = start, allow_hyphen_values = true)]
    pub start: Option<Pose>,
    /// File, line and key that the start came from; none when it is a flag's.
    #[arg(skip)]
    pub start_place: Option<String>,
    /// The robot's body, in TOML
    #[arg(long, value_name = "FILE")]
    pub chassis: Option<PathBuf>,
    /// Values for the flags, in TOML; flags win
    #[arg(long, value_name = "FILE")]
    pub config: Option<PathBuf>,
}

/// What a run can be told of what is kept of it.
#[derive(Debug, Clone, Default, PartialEq, Args)]
pub struct KeepingFlags {
    /// What the map is called [default: the world's name, or the port]
    #[arg(long, value_name = "TEXT", value_parser = title)]
    pub name: Option<String>,
    /// Folder for the results and the record; `run` and `calibrate` need it
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Folder of an interrupted run to go on with
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    pub resume: Option<PathBuf>,
    /// With --resume, a robot that was carried: about where it stands now
    #[arg(
        long,
        value_name = "X,Y,DEG",
        value_parser = start,
        allow_hyphen_values = true,
        requires = "resume"
    )]
    pub placed: Option<Pose>,
}

/// A speed that a serial port may have, bits a second. Below the least a heartbeat takes longer than the
/// robot waits for one.
pub(super) fn baud(text: &str) -> Result<u32, String> {
    let range = 9_600..=12_000_000;
    let baud: u32 = text.parse().map_err(|_error| "not a whole number".to_owned())?;
    if range.contains(&baud) {
        Ok(baud)
    } else {
        Err(format!("from {} to {}; 115200 is usual", range.start(), range.end()))
    }
}

/// Size of a frame, in cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameSize {
    /// Columns.
    pub columns: u16,
    /// Rows.
    pub rows: u16,
}

impl Common {
    /// The flags together with what the file named by `--config` adds to them; flags win.
    ///
    /// # Errors
    /// When the file cannot be read or a key or value in it is wrong, or when a flag says nothing without another
    /// one.
    pub fn with_config(mut self) -> Result<(Self, config::Places), ArgumentError> {
        let places = match self.robot.config.take() {
            Some(path) => config::read(&path, &mut self)?,
            None => config::Places::default(),
        };
        // Clap waives what a flag requires where that is at odds with another flag, as --resume is with --out.
        if self.keeping.placed.is_some() && self.keeping.resume.is_none() {
            return Err(ArgumentError::Alone { flag: "--placed", needs: "--resume DIR" });
        }
        Ok((self, places))
    }

    /// The robot's body: from `--chassis`, or the default; as a host hears of it, so that a simulated
    /// robot is the same one on a line and without.
    ///
    /// # Errors
    /// When the chassis file cannot be read or is wrong.
    pub fn body(&self) -> Result<Chassis, ArgumentError> {
        let chassis =
            self.robot.chassis.as_deref().map_or_else(|| Ok(Chassis::default()), chassis::read)?;
        Ok(told(&chassis))
    }

    /// The settings of a run of the robot `body` from `start`.
    pub fn settings(&self, start: Pose, body: Chassis) -> Settings {
        let mut settings = Settings::new(start);
        let MappingFlags { alpha, plan, contour, laps, square, tape } = self.mapping;
        settings.alpha = alpha.unwrap_or(settings.alpha);
        settings.strategy = plan.unwrap_or(settings.strategy);
        settings.contour = contour.unwrap_or(settings.contour);
        settings.seed = self.robot.seed.unwrap_or(settings.seed);
        settings.laps = laps.unwrap_or(settings.laps);
        settings.square = square;
        settings.tape = tape;
        settings.name.clone_from(&self.keeping.name);
        settings.chassis = body;
        settings
    }
}

/// A finite number.
fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err(format!("`{}` is not a finite number", text.trim())),
        Err(_) => Err(format!("`{}` is not a number", text.trim())),
    }
}

/// α: metres, as the console takes it. Whether it fits the room is asked when the room is known.
pub(super) fn alpha(text: &str) -> Result<f64, String> {
    let (value, (least, most)) = (number(text)?, ALPHA);
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(format!("α is a length from {least} to {most} m, such as 0.25"))
    }
}

/// What a map is called.
pub(super) fn title(text: &str) -> Result<String, String> {
    let name = text.trim();
    if name.is_empty() {
        return Err("a name has letters; leave the flag out to have none".to_owned());
    }
    check_name(name).map(|()| name.to_owned())
}

/// How often the boundary is gone round.
pub(super) fn laps(text: &str) -> Result<u32, String> {
    text.trim()
        .parse()
        .ok()
        .filter(|laps| (1..=MOST_LAPS).contains(laps))
        .ok_or_else(|| format!("`{}` is no number of laps from 1 to 9", text.trim()))
}

/// Yes or no.
pub(super) fn yes(text: &str) -> Result<bool, String> {
    match text.trim() {
        "true" => Ok(true),
        "false" => Ok(false),
        other => Err(format!("`{other}` is neither true nor false")),
    }
}

/// A time in seconds, not negative.
pub(super) fn seconds(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value < 0.0 => Err("a time is not negative".to_owned()),
        value => Ok(value),
    }
}

/// A pose: x and y in metres, heading in degrees.
pub(super) fn start(text: &str) -> Result<Pose, String> {
    text.parse().map_err(|error: PoseError| error.to_string())
}

/// A taped length: two places in metres, and what the tape said.
pub(super) fn tape(text: &str) -> Result<Tape, String> {
    text.parse().map_err(|error: TapeError| error.to_string())
}

/// A frame size such as 80x24.
pub(super) fn size(text: &str) -> Result<FrameSize, String> {
    let wrong =
        || format!("a size is COLSxROWS, such as 80x24, from {MIN_COLS}x{MIN_ROWS} to 1000x1000");
    let (columns, rows) = text.split_once('x').ok_or_else(wrong)?;
    let cells = |text: &str| match text.parse::<u16>() {
        Ok(count @ 1..=1000) => Ok(count),
        _ => Err(wrong()),
    };
    Ok(FrameSize { columns: cells(columns)?, rows: cells(rows)? })
}

const STRATEGIES: [(&str, Strategy); 3] =
    [("paper", Strategy::Paper), ("lean", Strategy::Lean), ("lanes", Strategy::Lanes)];
const CONTOURS: [(&str, Contour); 2] =
    [("two-pass", Contour::TwoPass), ("full-loop", Contour::FullLoop)];
const NOISES: [(&str, NoiseProfile); 4] = [
    ("none", NoiseProfile::None),
    ("calibrated", NoiseProfile::Calibrated),
    ("raw", NoiseProfile::Raw),
    ("harsh", NoiseProfile::Harsh),
];
const PHASES: [(&str, Phase); 4] = [
    ("boundary", Phase::Boundary),
    ("shape", Phase::Shape),
    ("plan", Phase::Plan),
    ("objects", Phase::Objects),
];
const THEMES: [(&str, ThemeName); 3] =
    [("dark", ThemeName::Dark), ("light", ThemeName::Light), ("mono", ThemeName::Mono)];

/// One of a few names.
fn one_of<T: Copy + Send + Sync + 'static>(
    names: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names.iter().map(|(name, _)| *name))
        .try_map(|text| named(names, &text))
}

fn named<T: Copy>(names: &[(&str, T)], text: &str) -> Result<T, String> {
    let found = names.iter().find(|(name, _)| *name == text);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let all: Vec<&str> = names.iter().map(|(name, _)| *name).collect();
        format!("`{text}` is none of {}", all.join(", "))
    })
}

pub(super) fn strategy() -> impl TypedValueParser<Value = Strategy> {
    one_of(&STRATEGIES)
}

pub(super) fn contour() -> impl TypedValueParser<Value = Contour> {
    one_of(&CONTOURS)
}

pub(super) fn noise() -> impl TypedValueParser<Value = NoiseProfile> {
    one_of(&NOISES)
}

pub(super) fn phase() -> impl TypedValueParser<Value = Phase> {
    one_of(&PHASES)
}

pub(super) fn theme() -> impl TypedValueParser<Value = ThemeName> {
    one_of(&THEMES)
}

/// The same values, as a settings file gives them.
pub(super) fn named_strategy(text: &str) -> Result<Strategy, String> {
    named(&STRATEGIES, text)
}

/// As [`named_strategy`].
pub(super) fn named_contour(text: &str) -> Result<Contour, String> {
    named(&CONTOURS, text)
}

/// As [`named_strategy`].
pub(super) fn named_noise(text: &str) -> Result<NoiseProfile, String> {
    named(&NOISES, text)
}

/// As [`named_strategy`].
pub(super) fn named_phase(text: &str) -> Result<Phase, String> {
    named(&PHASES, text)
}

/// As [`named_strategy`].
pub(super) fn named_theme(text: &str) -> Result<ThemeName, String> {
    named(&THEMES, text)
}

/// A seed.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|error: std::num::ParseIntError| match error.kind() {
        // The first digit too many is all that was looked at.
        IntErrorKind::PosOverflow if text.bytes().all(|byte| byte.is_ascii_digit()) => {
            format!("`{text}` is too large: a seed is {} at most", u64::MAX)
        }
        _ => format!("`{text}` is not a whole number from 0 up"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::angle;

    #[test]
    fn alpha_is_a_length_and_nothing_else() {
        assert_eq!(alpha("0.25"), Ok(0.25));
        for bad in ["0", "-0.2", "nan", "inf", "a lot", "", "1e-9"] {
            assert!(alpha(bad).is_err(), "α of `{bad}` was taken");
        }
    }

    #[test]
    fn alpha_has_the_same_range_as_in_the_console() {
        for text in ["0.049", "0.05", "2", "2.01"] {
            let typed = crate::console::command::Command::parse(&format!("alpha={text}"));
            assert_eq!(alpha(text).is_ok(), typed.is_ok(), "α of {text}");
        }
        let told = alpha("5").expect_err("five metres");
        assert!(told.contains("from 0.05 to 2 m"), "{told}");
    }

    #[test]
    fn a_name_is_some_letters() {
        assert_eq!(title(" Küche "), Ok("Küche".to_owned()));
        let long = "a".repeat(300);
        for bad in ["", "  ", "a\u{1b}[2J", long.as_str()] {
            assert!(title(bad).is_err(), "`{bad}` was taken");
        }
    }

    #[test]
    fn a_world_is_called_what_a_map_can_be_called() {
        let long = "a".repeat(201);
        for name in ["Küche", "a room", "", "  ", "a\u{1b}[2J", "a\tb", "\u{7f}", long.as_str()] {
            let quoted = toml::Value::from(name);
            let text = format!(
                "name = {quoted}\nstart = {{ x = 1, y = 1 }}\n[boundary]\n\
                 vertices = [[0,0],[4,0],[4,4],[0,4]]\n"
            );
            let world = crate::simulator::World::from_toml(&text, "room.toml", 0.1);
            if name.trim().is_empty() {
                assert_eq!(world.expect("no name is none").name, "unnamed");
            } else {
                assert_eq!(world.is_ok(), title(name).is_ok(), "{name:?}: {world:?}");
            }
        }
    }

    #[test]
    fn a_start_has_metres_and_degrees() {
        let pose = start("0.5, -1, 90").expect("a pose");
        assert!((pose.heading - angle::FRAC_PI_2).abs() < 1e-12);
        assert_eq!((pose.position.x, pose.position.y), (0.5, -1.0));
        for bad in ["", "1,2", "1,2,3,4", "1,2,nan", "a,b,c", "1e6,0,0", "0,0,1e308"] {
            assert!(start(bad).is_err(), "start of `{bad}` was taken");
        }
    }

    #[test]
    fn a_taped_length_has_two_ends_and_metres() {
        let taped = tape("0,0:-5,0.5=5.02").expect("a tape");
        assert_eq!((taped.to, taped.length), (crate::geometry::Point::new(-5.0, 0.5), 5.02));
        for bad in
            ["", "5", "0,0=5", "0,0:1,1", "0,0:1=2", "0,0:1,1=x", "0,0:1,1=0.1", "0,0:1,1=-2"]
        {
            assert!(tape(bad).is_err(), "tape of `{bad}` was taken");
        }
        for bad in ["1,1:1,1=5", "0,0:1e300,0=5", "0,0:5,0=1e300"] {
            assert!(tape(bad).is_err(), "tape of `{bad}` was taken");
        }
    }

    #[test]
    fn a_seed_that_is_too_large_is_told_so() {
        assert_eq!(seed("18446744073709551615"), Ok(u64::MAX));
        let told = seed("99999999999999999999").expect_err("too large");
        assert!(told.contains("too large") && told.contains("18446744073709551615"), "{told}");
        for bad in ["-1", "1.5", "", "x", "99999999999999999999x"] {
            let told = seed(bad).expect_err(bad);
            assert!(told.contains("whole number"), "{told}");
        }
    }

    #[test]
    fn sizes_are_columns_by_rows() {
        assert_eq!(size("80x24"), Ok(FrameSize { columns: 80, rows: 24 }));
        for bad in ["80", "80x", "0x24", "80x99999", "x", "-1x5"] {
            assert!(size(bad).is_err(), "size of `{bad}` was taken");
        }
    }
}
