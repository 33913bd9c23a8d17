//! Finding the robot's place again, after it was carried or started anew, or when what it meets cannot be
//! where it believes it is: it looks for a wall, follows it, and what it sees on the way is laid on the map
//! until one place only is left that looks so.
//!
//! Until then its pose is in a frame of its own. A room that looks the same from two places is told by
//! where the robot is about, if that is known: by the operator's word, or since it only doubts. One that did not
//! find its place near there looks anywhere. A carried robot without it, and one that is not found anywhere, stands
//! still and asks.

pub mod recognise;

use super::event::EventKind;
use super::follow::{Ask, AtRest, Side};
use super::map::{ContactKind, RoomMap};
use super::odometry::Tracker;
use super::search::{Next, Search};
use super::settings::Settings;
use super::wall::{Sighting, Wall};
use crate::geometry::{Pose, Ring, angle};
use recognise::{Landmarks, Place, Seen, put};

/// The map is looked at again after so many metres.
const LOOK: f64 = 0.4;
/// Two looks in a row that differ by no more than this found the same place: metres, radians.
const STEADY: (f64, f64) = (0.06, 0.05);
/// The operator's word on where the robot was put is believed to this: metres, radians.
const TOLD: (f64, f64) = (0.7, 0.7);
/// A robot that doubts its place is within this of where it believes it is: pushed and turned a little, it
/// may have driven on for long before it found out.
const DOUBTED: (f64, f64) = (1.5, 0.7);
/// After so many metres a robot that only doubts its place gives up looking for it.
const LONGEST_DOUBT: f64 = 30.0;

/// A place that is farther than this from where it is said to be, metres, and on which what was seen lies within this
/// share as near, shows that the word was wrong.
const ELSEWHERE: f64 = 1.0;
const FAR_BETTER: f64 = 0.6;

/// What is known about the place of a robot that is looking for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    /// Nothing: its pose is no more than a frame.
    Nothing,
    /// About where its pose is, by the operator's word.
    Told,
    /// About where its pose is, since it only doubts that.
    Doubted,
    /// Anywhere on the map: it doubted its place before, and did not find it near there.
    Lost,
}

impl About {
    /// Whether nobody said that it is somewhere else, and it found out.
    #[must_use]
    pub fn is_doubt(self) -> bool {
        matches!(self, Self::Doubted | Self::Lost)
    }

    /// How far from its pose it may be, metres, radians.
    fn within(self) -> Option<(f64, f64)> {
        match self {
            Self::Nothing | Self::Lost => None,
            Self::Told => Some(TOLD),
            Self::Doubted => Some(DOUBTED),
        }
    }
}

/// What comes next.
#[derive(Debug, Clone, PartialEq)]
pub enum Seek {
    /// A motion.
    Go(Ask),
    /// The robot's place is found.
    Found(Place),
    /// It is not, after all that could be driven: so many places of the map look like it.
    Unclear(usize),
}

/// The search for the robot's place.
#[derive(Debug, Clone)]
pub struct Relocation {
    search: Box<Search>,
    landmarks: Landmarks,
    /// Where the robot believed it was when it began, in its own frame, and what that says.
    from: Pose,
    about: About,
    /// Metres travelled when the map was looked at last.
    looked: f64,
    /// What the look before this found.
    before: Option<Place>,
    /// The map in the robot's own frame: things gone round on the way, so that none is twice.
    seen: RoomMap,
    begun: f64,
    begun_us: u64,
}

impl Relocation {
    /// Begins where `tracker` is, of which it is known `about` how far to believe it.
    #[must_use]
    pub fn new(
        settings: &Settings,
        outline: &Ring,
        objects: Vec<Ring>,
        tracker: &Tracker,
        about: About,
    ) -> Self {
        let from = tracker.pose();
        Self {
            search: Box::new(Search::relocating(settings, from)),
            landmarks: Landmarks::new(outline, objects),
            from,
            about,
            looked: tracker.travelled(),
            before: None,
            seen: RoomMap::default(),
            begun: tracker.travelled(),
            begun_us: tracker.time_us(),
        }
    }

    /// The same for a robot that doubts its place, beside what it `followed` last.
    #[must_use]
    pub fn beside(self, settings: &Settings, followed: (Side, Wall)) -> Self {
        let from = (self.from, self.begun_us);
        let search = Search::relocating_beside(settings, from, followed);
        Self { search: Box::new(search), ..self }
    }

    /// The contacts that are being collected.
    #[must_use]
    pub fn wall(&self) -> &Wall {
        self.search.wall()
    }

    /// The same, to add to.
    pub fn wall_mut(&mut self) -> &mut Wall {
        self.search.wall_mut()
    }

    /// Metres driven since it began.
    #[must_use]
    pub fn driven(&self, tracker: &Tracker) -> f64 {
        tracker.travelled() - self.begun
    }

    /// Where the robot believed it was when it began, in its own frame.
    #[must_use]
    pub fn from(&self) -> Pose {
        self.from
    }

    /// When it began, microseconds of robot time.
    #[must_use]
    pub fn begun_us(&self) -> u64 {
        self.begun_us
    }

    /// The robot came to rest: what next?
    pub fn next(
        &mut self,
        tracker: &mut Tracker,
        rest: &AtRest,
        tell: &mut Vec<EventKind>,
    ) -> Seek {
        if self.search.circuit().is_some() && tracker.travelled() > self.looked + LOOK {
            self.looked = tracker.travelled();
            let seen = self.seen();
            let found = only(&self.places(&seen));
            let here = tracker.pose();
            // Both looks must put the robot at one place.
            let steady = |place: &Place, before: &Place| {
                let (now, then) = (place.of(here), before.of(here));
                (now.position - then.position).norm() < STEADY.0
                    && angle::wrap(now.heading - then.heading).abs() < STEADY.1
            };
            if let (Some(place), Some(before)) = (found, self.before)
                && steady(&place, &before)
                && let Some(place) = self.proven(&place, &seen, here)
            {
                return Seek::Found(place);
            }
            self.before = found;
        }
        if self.about == About::Doubted && self.driven(tracker) > LONGEST_DOUBT {
            return Seek::Unclear(0);
        }
        let mut told = Vec::new();
        let next = self.search.next(tracker, rest, &mut self.seen, &mut told);
        tell.extend(told.into_iter().filter(|kind| !names_object(kind)));
        match next {
            Next::Go(ask) => Seek::Go(ask),
            Next::Found(..) => {
                let seen = self.seen();
                let places = self.places(&seen);
                let place = only(&places);
                match place.and_then(|place| self.proven(&place, &seen, tracker.pose())) {
                    Some(place) => Seek::Found(place),
                    None if place.is_some() => Seek::Unclear(0),
                    None => Seek::Unclear(places.len()),
                }
            }
            Next::Failed(_) => Seek::Unclear(0),
        }
    }

    /// The `place`, as good as it can be told for a robot that stands `here`; none when that would be where no robot
    /// can stand, or when what was seen fits another one far better: then the word that it is here was wrong.
    fn proven(&self, place: &Place, seen: &[Seen], here: Pose) -> Option<Place> {
        let sharp = self.landmarks.sharpened(place, seen);
        let at = sharp.of(here).position;
        let elsewhere = |other: &Place| {
            (other.of(here).position - at).norm() > ELSEWHERE
                && other.is_sure()
                && other.rms < FAR_BETTER * place.rms
        };
        let is_word = self.about.within().is_some();
        let is_elsewhere =
            || is_word && self.landmarks.places(seen, |_| true).iter().any(elsewhere);
        (self.landmarks.is_floor(at) && !is_elsewhere()).then_some(sharp)
    }

    /// What was seen since the wall was met.
    fn seen(&self) -> Vec<Seen> {
        self.wall()
            .surfaces()
            .filter(|seen| seen.kind == ContactKind::Range)
            .map(|seen| {
                let Sighting { point, pose, travelled, .. } = *seen;
                Seen { point, from: pose.position, travelled }
            })
            .collect()
    }

    /// The places of the map that look like what was `seen`: near where it is about, if that is known.
    fn places(&self, seen: &[Seen]) -> Vec<Place> {
        let near = |at: Pose| {
            self.about.within().is_none_or(|(metres, radians)| {
                (at.position - self.from.position).norm() < metres
                    && angle::wrap(at.heading - self.from.heading).abs() < radians
            })
        };
        let mut places = self.landmarks.places(seen, |onto| near(put(onto, self.from)));
        places.retain(|place| near(place.of(self.from)));
        places
    }
}

/// Whether the number of an object is told, which on the way is of a map of its own.
fn names_object(kind: &EventKind) -> bool {
    matches!(
        kind,
        EventKind::ObjectClosed { .. }
            | EventKind::ObjectApart { .. }
            | EventKind::ObjectKnown { .. }
            | EventKind::Detour { .. }
    )
}

/// The one of `places` that it is: the only one, if it is sure.
fn only(places: &[Place]) -> Option<Place> {
    let [place] = places else { return None };
    place.is_sure().then_some(*place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Vector};
    use crate::robot::Chassis;

    /// An L of 5 x 4 m, and what a robot sees of its lower right end.
    fn looked(about: About) -> (Relocation, Vec<Seen>) {
        let corners = [(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (3.0, 4.0), (3.0, 2.5), (0.0, 2.5)];
        let outline = Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)));
        let start = Pose::new(1.0, 1.0, 0.0);
        let settings = Settings::new(start);
        let tracker = Tracker::new(&Chassis::default(), start);
        let seen = |k: u32, at: Point, inward: Vector| Seen {
            point: at,
            from: at + inward * 0.145,
            travelled: 0.05 * f64::from(k),
        };
        let below = (0..40)
            .map(|k| seen(k, Point::new(3.0 + 0.05 * f64::from(k), 0.0), Vector::new(0.0, 1.0)));
        let right = (0..=80)
            .map(|k| seen(40 + k, Point::new(5.0, 0.05 * f64::from(k)), Vector::new(-1.0, 0.0)));
        let top = (1..16).map(|k| {
            seen(120 + k, Point::new(5.0 - 0.05 * f64::from(k), 4.0), Vector::new(0.0, -1.0))
        });
        let seen = below.chain(right).chain(top).collect();
        (Relocation::new(&settings, &outline, Vec::new(), &tracker, about), seen)
    }

    #[test]
    fn a_place_that_the_robot_cannot_stand_at_is_none() {
        let (relocation, seen) = looked(About::Nothing);
        let place = only(&relocation.landmarks.places(&seen, |_| true)).expect("a place");
        assert!(relocation.proven(&place, &seen, Pose::new(4.8, 3.0, 1.57)).is_some());
        assert_eq!(relocation.proven(&place, &seen, Pose::new(5.3, 3.0, 1.57)), None);
    }

    #[test]
    fn a_word_is_not_believed_where_what_was_seen_fits_far_better_elsewhere() {
        let here = Pose::new(4.2, 3.8, 3.0);
        let by_chance =
            Place { onto: Pose::new(-1.4, -1.6, 0.02), rms: 0.02, share: 0.95, sd: (0.02, 0.01) };
        let (relocation, seen) = looked(About::Told);
        assert_eq!(relocation.proven(&by_chance, &seen, here), None);
        let (relocation, seen) = looked(About::Nothing);
        assert!(relocation.proven(&by_chance, &seen, here).is_some(), "nobody said anything");
    }
}
