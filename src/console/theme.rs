//! What things look like: a closed set of style roles, and themes that give each role a style.
//! Sixteen colours only, the terminal's own foreground and background for text, and never colour
//! alone: every role that matters differs by symbol, pattern or modifier too.

use ratatui::style::{Color, Modifier, Style};

/// What a cell means. The order ranks the roles of the map: when two meet in a cell, the later
/// one gives its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Plain text.
    Text,
    /// Text that may be overlooked: labels, units, what is not there.
    Muted,
    /// Rules and frames.
    Rule,
    /// Headings.
    Title,
    /// A value that matters.
    Value,
    /// A value that is too old to act on.
    Stale,
    /// A value that never arrived.
    Unknown,
    /// A key of the keyboard.
    Key,
    /// A short remark to the operator.
    Hint,
    /// Progress in the log.
    Notice,
    /// Something did not go as it should.
    Warning,
    /// The run cannot go on by itself.
    Fault,
    /// All is well.
    Good,
    /// A closed switch or pressed bumper.
    Active,
    /// The part of a bar that is done.
    BarDone,
    /// The part of a bar that is to come.
    BarRest,
    /// The letter under the cursor of the command line.
    Cursor,
    /// The robot may move by itself.
    Running,
    /// Waiting for the operator.
    Paused,
    /// Stopped and latched.
    Stopped,
    /// Everything is done.
    Complete,
    /// Ended short of its goal.
    Failed,
    /// Map: a line that was never part of the plan.
    LineRejected,
    /// Map: where the robot went.
    Trajectory,
    /// Map: a cut between two parts of the floor.
    Cut,
    /// Map: a line to be driven.
    LinePlanned,
    /// Map: a line driven from end to end.
    LineDriven,
    /// Map: a line left out.
    LineSkipped,
    /// Map: a line that something stands on.
    LineBlocked,
    /// Map: where the run began.
    Start,
    /// Map: a contact.
    Contact,
    /// Map: a stretch of the outline that nobody touched.
    Untouched,
    /// Map: the wall line.
    Wall,
    /// Map: the outline of an object.
    Object,
    /// Map: the line being driven.
    LineDriving,
    /// Map: the largest disc that may still hide.
    HiddenDisc,
    /// Map: the robot where it was when last heard.
    RobotStale,
    /// Map: the robot.
    Robot,
    /// Map: the beam of a closed switch.
    Beam,
}

impl Role {
    /// Every role, in order.
    pub const ALL: [Self; 39] = [
        Self::Text,
        Self::Muted,
        Self::Rule,
        Self::Title,
        Self::Value,
        Self::Stale,
        Self::Unknown,
        Self::Key,
        Self::Hint,
        Self::Notice,
        Self::Warning,
        Self::Fault,
        Self::Good,
        Self::Active,
        Self::BarDone,
        Self::BarRest,
        Self::Cursor,
        Self::Running,
        Self::Paused,
        Self::Stopped,
        Self::Complete,
        Self::Failed,
        Self::LineRejected,
        Self::Trajectory,
        Self::Cut,
        Self::LinePlanned,
        Self::LineDriven,
        Self::LineSkipped,
        Self::LineBlocked,
        Self::Start,
        Self::Contact,
        Self::Untouched,
        Self::Wall,
        Self::Object,
        Self::LineDriving,
        Self::HiddenDisc,
        Self::RobotStale,
        Self::Robot,
        Self::Beam,
    ];

    /// The letter that stands for the role in the second plane of a text frame.
    #[must_use]
    pub fn letter(self) -> char {
        const LETTERS: &[u8; 39] = b".mr=vou#hnwfgabe_RPSCFxtcpdskiqyWOLHzZB";
        char::from(LETTERS[self as usize])
    }
}

/// A style for every role.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Theme {
    styles: [Style; Role::ALL.len()],
}

impl Theme {
    /// The style of `role`.
    #[must_use]
    pub fn style(&self, role: Role) -> Style {
        self.styles[role as usize]
    }

    /// Sixteen colours, for a dark background.
    #[must_use]
    pub fn dark() -> Self {
        Self::coloured(colour_of)
    }

    /// The same for a light background, on which yellow, cyan and the bright colours are hardly seen.
    #[must_use]
    pub fn light() -> Self {
        Self::coloured(colour_on_light)
    }

    fn coloured(colour_of: impl Fn(Role) -> Option<Color>) -> Self {
        Self::from_fn(|role| {
            let fg = |colour: Color| Style::new().fg(colour);
            match colour_of(role) {
                Some(colour) if is_chip(role) => {
                    // Black on a colour reads on every palette; the bold face is for those
                    // terminals that cannot show the colour.
                    Style::new().fg(Color::Black).bg(colour).add_modifier(Modifier::BOLD)
                }
                Some(colour) => fg(colour).add_modifier(modifier_of(role)),
                None => Style::new().add_modifier(modifier_of(role)),
            }
        })
    }

    /// No colour at all (`NO_COLOR`): bold, dim and reversed only.
    #[must_use]
    pub fn mono() -> Self {
        Self::from_fn(|role| {
            let modifier =
                if is_chip(role) { Modifier::REVERSED | Modifier::BOLD } else { modifier_of(role) };
            Style::new().add_modifier(modifier)
        })
    }

    /// One indexed colour a role, so that a frame can be asked which role each cell has. For
    /// frames as text, not for people.
    #[must_use]
    pub fn probe() -> Self {
        Self::from_fn(|role| Style::new().fg(Color::Indexed(role as u8)))
    }

    /// The role that a cell drawn with [`Theme::probe`] has; none where nothing was drawn.
    #[must_use]
    pub fn probed(colour: Color) -> Option<Role> {
        match colour {
            Color::Indexed(index) => Role::ALL.get(usize::from(index)).copied(),
            _ => None,
        }
    }

    fn from_fn(style: impl Fn(Role) -> Style) -> Self {
        Self { styles: Role::ALL.map(style) }
    }
}

/// Roles that fill their background, to be seen from across the room.
fn is_chip(role: Role) -> bool {
    matches!(role, Role::Running | Role::Paused | Role::Stopped | Role::Complete | Role::Failed)
}

fn colour_of(role: Role) -> Option<Color> {
    match role {
        Role::Text
        | Role::Muted
        | Role::Rule
        | Role::Value
        | Role::Unknown
        | Role::BarRest
        | Role::Cursor
        | Role::LineRejected
        | Role::LineSkipped
        | Role::Start => None,
        Role::Title | Role::Key | Role::Notice | Role::Contact | Role::LineDriving => {
            Some(Color::Cyan)
        }
        Role::Stale
        | Role::Hint
        | Role::Warning
        | Role::Paused
        | Role::RobotStale
        | Role::Untouched
        | Role::HiddenDisc => Some(Color::Yellow),
        Role::Fault
        | Role::Stopped
        | Role::Failed
        | Role::LineBlocked
        | Role::Active
        | Role::Beam => Some(Color::LightRed),
        Role::Good | Role::BarDone | Role::Running | Role::Complete | Role::LineDriven => {
            Some(Color::Green)
        }
        Role::Wall => Some(Color::LightCyan),
        Role::Object => Some(Color::LightMagenta),
        Role::Trajectory | Role::Cut | Role::LinePlanned => Some(Color::Blue),
        Role::Robot => Some(Color::LightYellow),
    }
}

fn colour_on_light(role: Role) -> Option<Color> {
    match role {
        // What fills its background is read on any.
        role if is_chip(role) => colour_of(role),
        // The terminal's own foreground is seen best.
        Role::Robot | Role::Contact | Role::Trajectory => None,
        Role::Stale | Role::Hint | Role::Warning | Role::RobotStale => Some(Color::Magenta),
        Role::Untouched | Role::HiddenDisc => Some(Color::Red),
        _ => colour_of(role).map(|colour| match colour {
            Color::Cyan | Color::LightCyan => Color::Blue,
            Color::LightMagenta => Color::Magenta,
            Color::LightRed => Color::Red,
            colour => colour,
        }),
    }
}

/// Whether `colours` says that the background is light: the last number of COLORFGBG, as rxvt has it and others
/// have taken over.
#[must_use]
pub fn is_light(colours: &str) -> bool {
    matches!(colours.rsplit(';').next(), Some("7" | "15"))
}

fn modifier_of(role: Role) -> Modifier {
    match role {
        Role::Muted
        | Role::Rule
        | Role::Unknown
        | Role::BarRest
        | Role::LineRejected
        | Role::LineSkipped
        | Role::Trajectory => Modifier::DIM,
        Role::Title
        | Role::Value
        | Role::Key
        | Role::Fault
        | Role::Active
        | Role::Robot
        | Role::Beam
        | Role::LineDriving
        | Role::Wall => Modifier::BOLD,
        Role::Stale => Modifier::ITALIC,
        Role::Cursor => Modifier::REVERSED,
        _ => Modifier::empty(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_role_has_its_own_letter_and_place() {
        let mut letters: Vec<char> = Role::ALL.iter().map(|role| role.letter()).collect();
        letters.sort_unstable();
        letters.dedup();
        assert_eq!(letters.len(), Role::ALL.len(), "two roles share a letter");
        for (index, role) in Role::ALL.iter().enumerate() {
            assert_eq!(*role as usize, index, "{role:?} is out of order in Role::ALL");
        }
    }

    #[test]
    fn on_a_light_background_nothing_is_drawn_in_a_pale_colour() {
        let pale = [
            Color::Yellow,
            Color::LightYellow,
            Color::Cyan,
            Color::LightCyan,
            Color::LightGreen,
            Color::LightRed,
            Color::LightMagenta,
            Color::LightBlue,
            Color::Gray,
            Color::White,
        ];
        let light = Theme::light();
        for role in Role::ALL {
            let style = light.style(role);
            let seen = style.bg.is_some() || style.fg.is_none_or(|colour| !pale.contains(&colour));
            assert!(seen, "{role:?}: {style:?}");
            let mono = Theme::mono().style(role).add_modifier;
            assert!(style.add_modifier.contains(mono - Modifier::REVERSED), "{role:?}: {style:?}");
        }
    }

    #[test]
    fn a_terminal_says_whether_its_background_is_light() {
        for (colours, light) in [
            ("0;15", true),
            ("0;7", true),
            ("0;default;15", true),
            ("15;0", false),
            ("7;8", false),
            ("default;default", false),
            ("", false),
        ] {
            assert_eq!(is_light(colours), light, "{colours}");
        }
    }

    #[test]
    fn run_states_can_be_told_apart_without_colour() {
        let mono = Theme::mono();
        for role in [Role::Stopped, Role::Failed, Role::Running] {
            assert!(
                mono.style(role).add_modifier.contains(Modifier::REVERSED),
                "{role:?} must stand out without colour"
            );
        }
        for role in Role::ALL {
            let style = mono.style(role);
            assert_eq!((style.fg, style.bg), (None, None), "{role:?} uses a colour");
        }
    }
}
