//! The one table of what the operator can do: name, help and place in the footer. Keys come from
//! the keymap file, help and footer from here. What an action does is `update`'s business.

/// Something a key or the command line can ask for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Action {
    /// Stand still at once.
    Stop,
    /// Clear the latched stop.
    ClearStop,
    /// Run or pause.
    RunPause,
    /// One command.
    StepCommand,
    /// To the next event.
    StepEvent,
    /// To the end of the phase.
    StepPhase,
    /// A smaller α.
    AlphaDown,
    /// A larger α.
    AlphaUp,
    /// Simulated time slower.
    SlowDown,
    /// Simulated time faster.
    SpeedUp,
    /// Round the boundary once more.
    LapAgain,
    /// Drop the lap, look for the boundary anew.
    LapAnew,
    /// Square the map, or undo that.
    Square,
    /// End the run and keep the map.
    Finish,
    /// Closer.
    ZoomIn,
    /// Further away.
    ZoomOut,
    /// Look further left.
    PanLeft,
    /// Look further right.
    PanRight,
    /// Look further up.
    PanUp,
    /// Look further down.
    PanDown,
    /// Keep the robot in the middle.
    Follow,
    /// Show everything.
    Fit,
    /// Show or hide the contacts.
    ToggleContacts,
    /// Show or hide the trajectory.
    ToggleTrajectory,
    /// Show or hide the plan's lines.
    TogglePlan,
    /// Show or hide the lines rejected from the plan.
    ToggleRejected,
    /// Show or hide the numbers of the walls.
    ToggleWalls,
    /// The list of what was found.
    List,
    /// Older log lines.
    LogUp,
    /// Newer log lines.
    LogDown,
    /// Routine log lines shown or hidden.
    ToggleDetail,
    /// The help.
    Help,
    /// The command line.
    CommandLine,
    /// Draw everything anew.
    Redraw,
    /// Stop the robot and give the shell its turn.
    Suspend,
    /// Leave.
    Quit,
}

/// Under which heading the help lists an action.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// What moves and stops the robot.
    Robot,
    /// What shapes the run.
    Run,
    /// What the map shows.
    Map,
    /// The rest of the screen.
    Screen,
}

impl Group {
    /// Every group in the order of the help.
    pub const ALL: [Self; 4] = [Self::Robot, Self::Run, Self::Map, Self::Screen];

    /// The heading.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Robot => "Robot",
            Self::Run => "Run",
            Self::Map => "Map",
            Self::Screen => "Screen",
        }
    }
}

/// One row of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ActionInfo {
    /// The action.
    pub action: Action,
    /// Its name in keymaps and on the command line.
    pub name: &'static str,
    /// What it does, in one line.
    pub help: &'static str,
    /// The same in a replay, where that is something else; else empty.
    pub replay: &'static str,
    /// Its heading in the help.
    pub group: Group,
    /// What the footer calls it; neighbours with the same word share one entry. Empty: not there.
    pub footer: &'static str,
}

/// Every action, in the order of help and footer.
pub const ACTIONS: &[ActionInfo] = &[
    row(Action::Stop, "stop", "stand still at once, and stay so", Group::Robot, "stop")
        .in_a_replay("pause"),
    row(Action::ClearStop, "clear", "allow motion again after a stop", Group::Robot, "clear"),
    row(Action::RunPause, "run", "run, or pause after this command", Group::Robot, "run/pause")
        .in_a_replay("play, or pause"),
    row(Action::StepCommand, "step-command", "one command, then wait", Group::Robot, "command")
        .in_a_replay("to the next command"),
    row(Action::StepEvent, "step-event", "to the next event, then wait", Group::Robot, "event")
        .in_a_replay("to the next event"),
    row(
        Action::StepPhase,
        "step-phase",
        "to the end of the phase, then wait",
        Group::Robot,
        "phase",
    )
    .in_a_replay("to the end of the phase"),
    row(Action::LapAgain, "lap-again", "one lap more, averaged in", Group::Run, "lap"),
    row(Action::LapAnew, "lap-anew", "drop the lap, look for the boundary anew", Group::Run, "lap"),
    row(
        Action::AlphaDown,
        "alpha-down",
        "α down by 0.05 m: smaller things are found",
        Group::Run,
        "α",
    ),
    row(
        Action::AlphaUp,
        "alpha-up",
        "α up by 0.05 m: only larger things are found",
        Group::Run,
        "α",
    ),
    row(Action::SlowDown, "slower", "simulated time slower", Group::Run, "speed")
        .in_a_replay("play slower"),
    row(Action::SpeedUp, "faster", "simulated time faster", Group::Run, "speed")
        .in_a_replay("play faster"),
    row(Action::Square, "square", "nearly right angles made right, or left", Group::Run, "square"),
    row(Action::Finish, "finish", "end the run here, keep the map", Group::Run, ""),
    row(Action::ZoomIn, "zoom-in", "closer", Group::Map, "zoom"),
    row(Action::ZoomOut, "zoom-out", "further away", Group::Map, "zoom"),
    row(Action::PanLeft, "pan-left", "look further left", Group::Map, ""),
    row(Action::PanDown, "pan-down", "look further down", Group::Map, ""),
    row(Action::PanUp, "pan-up", "look further up", Group::Map, ""),
    row(Action::PanRight, "pan-right", "look further right", Group::Map, ""),
    row(Action::Follow, "follow", "keep the robot in the middle", Group::Map, "follow"),
    row(Action::Fit, "fit", "show everything", Group::Map, "fit"),
    row(Action::ToggleContacts, "contacts", "contacts shown or hidden", Group::Map, ""),
    row(Action::ToggleTrajectory, "trajectory", "trajectory shown or hidden", Group::Map, "way"),
    row(Action::TogglePlan, "plan", "lines of the plan shown or hidden", Group::Map, "plan"),
    row(Action::ToggleRejected, "rejected", "rejected lines shown or hidden", Group::Map, ""),
    row(Action::ToggleWalls, "walls", "numbers of the walls shown or hidden", Group::Map, ""),
    row(
        Action::List,
        "list",
        "every wall, object and gap, each with its figures",
        Group::Map,
        "list",
    ),
    row(Action::LogUp, "log-up", "older lines of the log", Group::Screen, ""),
    row(Action::LogDown, "log-down", "newer lines of the log", Group::Screen, ""),
    row(
        Action::ToggleDetail,
        "detail",
        "routine lines of the log shown or hidden",
        Group::Screen,
        "",
    ),
    row(Action::Redraw, "redraw", "draw the screen anew", Group::Screen, ""),
    row(
        Action::Suspend,
        "suspend",
        "stop the robot and go back to the shell; fg goes on",
        Group::Screen,
        "",
    )
    .in_a_replay("pause and go back to the shell; fg goes on"),
    row(Action::CommandLine, "command-line", "type a command", Group::Screen, "line"),
    row(Action::Help, "help", "this help", Group::Screen, "help"),
    row(Action::Quit, "quit", "leave; asks only while the robot moves", Group::Screen, "quit")
        .in_a_replay("leave"),
];

const fn row(
    action: Action,
    name: &'static str,
    help: &'static str,
    group: Group,
    footer: &'static str,
) -> ActionInfo {
    ActionInfo { action, name, help, replay: "", group, footer }
}

impl ActionInfo {
    const fn in_a_replay(self, replay: &'static str) -> Self {
        Self { replay, ..self }
    }
}

impl Action {
    /// The action called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        ACTIONS.iter().find(|info| info.name == name).map(|info| info.action)
    }

    /// Whether it would change what happened: in a replay there is nothing for it to do.
    #[must_use]
    pub fn changes_the_run(self) -> bool {
        matches!(
            self,
            Self::ClearStop
                | Self::AlphaDown
                | Self::AlphaUp
                | Self::LapAgain
                | Self::LapAnew
                | Self::Square
                | Self::Finish
        )
    }

    /// Whether it is a wish that the run has to hear of; a stop is on its way in any case.
    #[must_use]
    pub fn is_told_to_the_run(self) -> bool {
        let goes =
            matches!(self, Self::RunPause | Self::StepCommand | Self::StepEvent | Self::StepPhase);
        goes || self.changes_the_run()
    }

    /// Its row of the table.
    #[must_use]
    pub fn info(self) -> &'static ActionInfo {
        // The test below holds that every action has a row.
        ACTIONS.iter().find(|info| info.action == self).unwrap_or(&ACTIONS[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn names_are_unique_and_every_action_has_one_row() {
        let names: BTreeSet<_> = ACTIONS.iter().map(|info| info.name).collect();
        assert_eq!(names.len(), ACTIONS.len(), "two actions share a name");
        let actions: BTreeSet<_> = ACTIONS.iter().map(|info| info.action).collect();
        assert_eq!(actions.len(), ACTIONS.len(), "an action has two rows");
        assert_eq!(ACTIONS.len(), Action::Quit as usize + 1, "an action has no row");
        for info in ACTIONS {
            assert_eq!(Action::named(info.name), Some(info.action));
            assert!(!info.help.is_empty(), "{} has no help", info.name);
        }
    }
}
