//! The command line: what may be asked of the program and in which words. It parses and checks
//! values; it runs nothing, opens only the settings files named to it, and knows neither clock
//! nor screen.
//!
//! Lengths are in metres and angles in degrees here, and nowhere further in.

pub mod chassis;
pub mod config;
pub mod error;
pub mod settings_file;
pub mod values;

pub use error::ArgumentError;

use crate::mapping::map::Phase;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
pub use values::{Common, FrameSize, MappingFlags, RobotFlags};

/// Maps a room by touch, with a simulated or a real robot. Without a command it opens the console
/// on a built-in world.
#[derive(Debug, Clone, Parser)]
#[command(name = "periplus", version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    /// What to do; the console when nothing is said.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The console's own arguments, which need no command word.
    #[command(flatten)]
    pub console: ConsoleArgs,
}

/// The commands.
#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// Open the operator console
    Console(ConsoleArgs),
    /// Map without a terminal and write the results
    Run(RunArgs),
    /// Measure wheels and gyro on laps driven both ways round, and write `chassis.toml`; as `run`
    /// with `--laps 2 --until shape` and a `--tape` if there is one
    Calibrate(RunArgs),
    /// A simulated robot that speaks the wire protocol
    Robot(RobotArgs),
    /// Open the console over a recorded run
    Replay(ReplayArgs),
    /// Print one frame of the console; needs no terminal
    Snapshot(SnapshotArgs),
    /// Write one result of a run, over or under way, in a given format
    Export(ExportArgs),
    /// Say what is wrong with worlds, keymaps, chassis and config files, and where
    Check(CheckArgs),
    /// List serial ports
    Ports,
    /// Print the wire protocol, from which a robot can be built
    Protocol,
}

/// Where the robot is: simulated in a world, or behind a port.
#[derive(Debug, Clone, Default, Args)]
pub struct RobotChoice {
    /// World file for the simulator: TOML or GeoJSON
    #[arg(long, value_name = "FILE")]
    pub world: Option<PathBuf>,
    /// Serial port or tcp://HOST:PORT of a real robot
    #[arg(long, value_name = "DEVICE", conflicts_with_all = ["world", "noise"])]
    pub port: Option<String>,
    /// Speed of the serial port, bits a second, from 9600 up [default: 115200]
    #[arg(
        long,
        value_name = "N",
        conflicts_with = "world",
        value_parser = values::baud,
        allow_negative_numbers = true
    )]
    pub baud: Option<u32>,
}

/// Arguments of `console`.
#[derive(Debug, Clone, Default, Args)]
pub struct ConsoleArgs {
    /// The robot.
    #[command(flatten)]
    pub robot: RobotChoice,
    /// Keys and colours.
    #[command(flatten)]
    pub screen: ScreenFlags,
    /// What every run can be told.
    #[command(flatten)]
    pub common: Common,
}

/// How the console is worked and looked at.
#[derive(Debug, Clone, Default, Args)]
pub struct ScreenFlags {
    /// Key bindings instead of the built-in ones
    #[arg(long, value_name = "FILE")]
    pub keymap: Option<PathBuf>,
    /// Colours for a dark or a light background, or none [default: mono with `NO_COLOR`, light where
    /// COLORFGBG says so, else dark]
    #[arg(long, value_name = "THEME", value_parser = values::theme())]
    pub theme: Option<ThemeName>,
}

/// Which colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThemeName {
    /// For a dark background.
    Dark,
    /// For a light background.
    Light,
    /// None: bold, dim and reversed only.
    Mono,
}

/// Arguments of `run`.
#[derive(Debug, Clone, Args)]
pub struct RunArgs {
    /// The robot.
    #[command(flatten)]
    pub robot: RobotChoice,
    /// Phase whose end completes the run [default: objects; to calibrate shape]
    #[arg(long, value_name = "PHASE", value_parser = values::phase())]
    pub until: Option<Phase>,
    /// What every run can be told.
    #[command(flatten)]
    pub common: Common,
}

/// Arguments of `robot`.
#[derive(Debug, Clone, Args)]
pub struct RobotArgs {
    /// World file for the simulator: TOML or GeoJSON
    #[arg(long, value_name = "FILE")]
    pub world: Option<PathBuf>,
    /// Speak through a new pseudo-terminal, whose path is printed first
    #[arg(long, conflicts_with = "port")]
    pub pty: bool,
    /// Speak through this serial port, or to whoever comes to tcp://HOST:PORT
    #[arg(long, value_name = "DEVICE")]
    pub port: Option<String>,
    /// Times as fast as life, 0.1 to 1000 [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub speed: Option<f64>,
    /// What the line does to the bytes, shares of them and the longest delay in seconds, e.g.
    /// drop=0.05,flip=0.01,double=0.01,swap=0.01,delay=0.2 [default: nothing]
    #[arg(long, value_name = "LIST")]
    pub faults: Option<String>,
    /// The robot that is simulated.
    #[command(flatten)]
    pub robot: RobotFlags,
}

/// Arguments of `replay`.
#[derive(Debug, Clone, Args)]
pub struct ReplayArgs {
    /// Folder of a recorded run
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// Keys and colours.
    #[command(flatten)]
    pub screen: ScreenFlags,
}

/// Arguments of `snapshot`.
#[derive(Debug, Clone, Args)]
pub struct SnapshotArgs {
    /// World file for the simulator: TOML or GeoJSON; needs --until
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "replay",
        required_unless_present = "replay"
    )]
    pub world: Option<PathBuf>,
    /// With --world, and needed there: run the world until this phase has ended
    #[arg(
        long,
        value_name = "PHASE",
        value_parser = values::phase(),
        required_unless_present = "replay",
        conflicts_with = "replay"
    )]
    pub until: Option<Phase>,
    /// Folder of a recorded run, in place of a world; needs --at, and takes no flag of a run
    #[arg(
        long,
        value_name = "DIR",
        requires = "at",
        conflicts_with_all = ["MappingFlags", "RobotFlags"]
    )]
    pub replay: Option<PathBuf>,
    /// With --replay, and needed there: instant of the recorded run, in robot seconds since it began
    #[arg(
        long,
        value_name = "T",
        value_parser = values::seconds,
        requires = "replay",
        allow_negative_numbers = true
    )]
    pub at: Option<f64>,
    /// Size of the frame in columns and rows
    #[arg(
        long,
        value_name = "COLSxROWS",
        value_parser = values::size,
        allow_hyphen_values = true
    )]
    pub size: FrameSize,
    /// How the frame is written
    #[arg(long, value_enum, default_value_t = FrameFormat::Text)]
    pub format: FrameFormat,
    /// How the room is mapped.
    #[command(flatten)]
    pub mapping: MappingFlags,
    /// The robot and what simulates it.
    #[command(flatten)]
    pub robot: RobotFlags,
}

/// How a frame is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FrameFormat {
    /// Symbols only.
    Text,
    /// Symbols with terminal colours.
    Ansi,
    /// A picture.
    Svg,
}

/// Arguments of `export`.
#[derive(Debug, Clone, Args)]
pub struct ExportArgs {
    /// Folder of the run; while that is under way the map is made from its record so far
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    /// What to write
    #[arg(long, value_enum)]
    pub format: ExportFormat,
    /// Where to; `-` is standard output
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
    /// Write over a file that is there already
    #[arg(long)]
    pub force: bool,
}

/// What `export` can write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// `map.geojson`.
    Geojson,
    /// `map.json`, the native form.
    Json,
    /// `map.svg`.
    Svg,
    /// `map.png`.
    Png,
    /// A ROS map: YAML, with its picture (PGM) beside it.
    Ros,
}

/// Arguments of `check`.
#[derive(Debug, Clone, Args)]
pub struct CheckArgs {
    /// Worlds, keymaps, chassis and config files
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_table_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn help_tells_what_holds_when_nothing_is_said_and_how_far_a_value_goes() {
        let mut cli = Cli::command();
        let mut told = |command: &str, flag: &str| {
            let found = cli.find_subcommand_mut(command).expect("a command");
            let mut all = found.get_arguments();
            let argument = all.find(|argument| argument.get_long() == Some(flag)).expect("a flag");
            argument.get_help().expect("help").to_string()
        };
        let (speed, laps) = (crate::link::port::BAUD, crate::mapping::settings::MOST_LAPS);
        assert!(told("run", "baud").contains(&format!("[default: {speed}]")));
        assert!(told("console", "laps").contains(&format!("1 to {laps}")));
        assert!(told("run", "start").contains("at a port 0,0,0"));
        assert!(told("robot", "speed").contains("0.1 to 1000 [default: 1]"));
        assert!(told("robot", "faults").contains("seconds"));
    }

    /// The flags that a command knows.
    fn flags(command: &str) -> Vec<String> {
        let cli = Cli::command();
        let found = cli.find_subcommand(command).expect("a command");
        let names = found.get_arguments().filter_map(|argument| argument.get_long());
        names.map(str::to_owned).collect()
    }

    #[test]
    fn a_command_takes_no_flag_that_does_nothing_there() {
        let robot = flags("robot");
        for none in ["alpha", "plan", "contour", "tape", "laps", "square", "out", "resume"] {
            assert!(!robot.iter().any(|flag| flag == none), "robot --{none}");
        }
        for its in ["world", "noise", "seed", "start", "chassis", "config"] {
            assert!(robot.iter().any(|flag| flag == its), "no robot --{its}");
        }
        let snapshot = flags("snapshot");
        for none in ["out", "resume", "placed", "name"] {
            assert!(!snapshot.iter().any(|flag| flag == none), "snapshot --{none}");
        }
        assert!(snapshot.iter().any(|flag| flag == "alpha"), "no snapshot --alpha");
    }

    /// A config file may name the port.
    #[test]
    fn a_speed_needs_no_port_on_the_same_line() {
        let flags = ["periplus", "run", "--config", "lab.toml", "--baud", "57600"];
        assert!(Cli::try_parse_from(flags).is_ok());
        let flags = ["periplus", "run", "--world", "flat.toml", "--baud", "57600"];
        assert!(Cli::try_parse_from(flags).is_err(), "a world has no speed");
    }

    #[test]
    fn the_console_needs_no_command_word() {
        let cli = Cli::try_parse_from(["periplus", "--alpha", "0.3"]).expect("plain flags");
        assert!(cli.command.is_none());
        assert_eq!(cli.console.common.mapping.alpha, Some(0.3));
        let cli = Cli::try_parse_from(["periplus", "console", "--seed", "7"]).expect("in words");
        assert!(
            matches!(cli.command, Some(Command::Console(args)) if args.common.robot.seed == Some(7))
        );
    }
}
