//! What is decided in each phase: whether the boundary is found, what its shape is, which lines to
//! drive, when the map is done; and how what was mapped moves when the survey learns.

use super::{Mission, Outcome, Output, Task};
use crate::geometry::{Point, Ring};
use crate::mapping::adjust::Adjustment;
use crate::mapping::calibration::{Calibration, Driven};
use crate::mapping::chart::Chart;
use crate::mapping::circuit::Closure;
use crate::mapping::event::{EventKind, Failure};
use crate::mapping::floor::Coverage;
use crate::mapping::lay::Overlap;
use crate::mapping::map::{Contact, Phase, stretches};
use crate::mapping::network::Datum;
use crate::mapping::plan::{self, PlanRequest};
use crate::mapping::retrace::Beside;
use crate::mapping::search::{Next, Search, lap_contacts, lap_strokes, whole_lap};
use crate::mapping::shape::{self, AlongWall, Loops};
use crate::mapping::smooth::smooth;
use crate::mapping::thin::{PARTINGS, part};
use crate::mapping::tour::{Scene, Tour, Turn};
use crate::mapping::unreached::{self, Unreached, unreached};
use crate::mapping::wall::length_within;

/// Wheels that turn by more than this where the gyro goes straight do not tell the truth, radians per
/// metre: wheels 5 % apart on the default chassis. Worn ones are within half of that.
const LOPSIDED: f64 = 0.31;

/// An outline fitted anew after the tour is the same room when its area differs by no more than this
/// share.
pub(super) const REFINED: f64 = 0.05;

/// Places of the lap whose doubt is looked at, at most.
const MOST_DOUBTS: usize = 40;

impl Mission {
    pub(super) fn search(&mut self, mut search: Box<Search>, out: &mut Vec<Output>) {
        let mut told = Vec::new();
        let next = search.next(&mut self.tracker, &self.rest, &mut self.map, &mut told);
        self.rest.pose = self.tracker.pose();
        self.laps = search.laps();
        self.tell_all(told, out);
        match next {
            Next::Go(ask) => {
                self.task = Task::Search(search);
                self.order(&ask, out);
            }
            Next::Found(closure, overlap) => {
                self.close_boundary(&search, &closure, &overlap);
                if self.survey.lopsided().abs() > LOPSIDED {
                    return self.fail(Failure::WheelsLie, out);
                }
                self.next_lap(out);
            }
            Next::Failed(why) => {
                self.map.contacts = search.wall().contacts();
                self.fail(why, out);
            }
        }
    }

    /// Takes the misclosure out of the lap, its contacts, the trajectory and the pose, and learns
    /// the gyro's drift from it.
    fn close_boundary(&mut self, search: &Search, closure: &Closure, overlap: &Overlap) {
        let (earlier, wall) = (search.earlier(), search.wall());
        let adjustment = Adjustment::after(&self.tracker, earlier, closure, overlap, wall);
        let closure = &whole_lap(search.wall(), closure, &adjustment);
        self.map.contacts = lap_contacts(search.wall(), closure, &adjustment);
        self.way = lap_strokes(search.wall(), closure, &adjustment);
        self.map.closed = true;
        self.map.misclosure = Some(overlap.misclosure);
        self.map.alike = closure.alike;
        self.map.laps = 1;
        self.survey = adjustment.into_survey();
        let before = self.tracker.pose();
        let beside = Beside::new(closure.side, search.wall(), closure.length());
        self.settle(u64::MAX);
        self.beside = Some(beside.moved(&before, &self.tracker.pose()));
    }

    /// Moves what was mapped before, the trajectory and the pose to where the survey believes them,
    /// and goes on from there. What was driven since `since_us` (robot time) was touch by touch there
    /// already.
    pub(super) fn settle(&mut self, since_us: u64) {
        let survey = &mut self.survey;
        let knots = survey.knots();
        for object in &mut self.map.objects {
            let tie = survey.tie(object.seen_us().0, knots);
            object.displace(|p| survey.displacement(p, &tie));
        }
        for beyond in &mut self.map.beyond {
            let begin = beyond.contacts.first().map_or(0, Contact::time_us);
            let tie = survey.tie(begin, knots);
            beyond.displace(|p| survey.displacement(p, &tie));
        }
        for point in self.tracker.path_mut().iter_mut().take_while(|p| p.time_us < since_us) {
            let tie = survey.tie(point.time_us, knots);
            point.pose = survey.place(point.pose, &tie);
        }
        let now = survey.take_pose(self.tracker.pose());
        self.tracker.settle(now);
        self.rest.pose = now;
        self.tracker.set_bias(self.tracker.bias() - survey.take_bias());
        survey.rebase();
    }

    /// The outline through the contacts of the lap as they are believed by now. Until it is said what
    /// stands apart, a large loop may be of that.
    pub(super) fn fitted_outline(&self) -> Result<Ring, Failure> {
        self.outlined(&self.along_wall())
    }

    fn outlined(&self, lap: &AlongWall) -> Result<Ring, Failure> {
        let loops = if self.map.shape.is_some() { Loops::All } else { Loops::Touched };
        lap.outline(self.give(), loops).map(|outline| self.joined(outline))
    }

    fn along_wall(&self) -> AlongWall {
        AlongWall::of(&self.map.contacts, self.settings.chassis.reach())
    }

    /// What is fitted to the contacts of the lap, freed of such `loops`; none where they can only be joined.
    pub(super) fn fit(&self, loops: Loops) -> Option<Ring> {
        self.along_wall().fit(self.give(), loops).map(|outline| self.joined(outline))
    }

    /// How far the lap may be bent, metres: places spread over it tell.
    fn give(&self) -> f64 {
        let contacts = &self.map.contacts;
        let knots = self.survey.knots();
        let doubts =
            contacts.iter().step_by((contacts.len() / MOST_DOUBTS).max(1)).map(|contact| {
                let tie = self.survey.tie(contact.time_us(), knots);
                self.survey.spread_at(contact.point, &tie).trace() / 2.0
            });
        doubts.fold(0.0, f64::max).max(0.0).sqrt()
    }

    /// Lets the smooth walls of `outline` straighten the lap; true when there are any.
    fn straighten(&mut self, outline: &Ring) -> bool {
        let knots = self.survey.knots();
        if !smooth(&mut self.survey, knots, outline, &self.map.contacts) {
            return false;
        }
        self.place_contacts();
        self.settle(u64::MAX);
        true
    }

    /// Moves the lap's contacts to where the survey believes them.
    pub(super) fn place_contacts(&mut self) {
        let knots = self.survey.knots();
        for contact in &mut self.map.contacts {
            let tie = self.survey.tie(contact.time_us(), knots);
            contact.point += self.survey.displacement(contact.point, &tie);
            contact.from += self.survey.displacement(contact.from, &tie);
        }
        for stroke in &mut self.way {
            let tie = self.survey.tie(stroke.time_us, knots);
            *stroke = stroke.placed(|at, _| at + self.survey.displacement(at, &tie));
        }
    }

    /// Says how well what is mapped is known; `datum` is what errors all of it has in common.
    pub(super) fn state_errors(&mut self, datum: Option<Datum>) {
        let start = self.settings.start.position;
        Chart::new(&self.map, &self.survey).state_errors(&self.survey, start, &mut self.map);
        if let Some(accuracy) = &mut self.map.accuracy {
            accuracy.datum = datum;
        }
    }

    pub(super) fn shape(&mut self, out: &mut Vec<Output>) {
        let reach = self.settings.chassis.reach();
        let mut fitted = self.straight_outline();
        if !self.is_sound(&fitted) && self.take_out_enclosed(out) {
            fitted = self.straight_outline();
        }
        let mut across = Vec::new();
        if !self.is_sound(&fitted)
            && let Some((kept, spurs)) = shape::without_spurs(&self.map.contacts, reach)
        {
            (self.map.contacts, across) = (kept, spurs);
            fitted = self.straight_outline();
        }
        if !self.is_sound(&fitted) {
            // Of contacts in a wrong order a fit may keep no more than a loop.
            fitted = self.along_wall().joined();
        }
        let outline = match fitted {
            Ok(outline) => outline,
            Err(why) => return self.fail(why, out),
        };
        if !self.encloses_the_lap(&outline) {
            return self.fail(Failure::OutlineBroken, out);
        }
        // What was seen across a passage stands there, where it was gone round.
        for thing in shape::lost(&across, &outline, shape::ALL_AROUND).1 {
            self.stands_apart(thing, out);
        }
        let outline = self.end_at_straits(outline, out);
        let outline = self.set_apart(outline, out);
        self.map.shape = Some(shape::identify(outline, &self.map.contacts));
        let adjusted = self.adjust_lap(out);
        if adjusted.is_some() {
            self.refine();
            // From here on the survey learns what the adjustment does not know yet.
            self.survey.rebase();
        }
        self.lay_tape(out);
        self.state_errors(adjusted.and_then(|whole| whole.datum));
        if let Some(shape) = &self.map.shape {
            let (class, vertices, parts) = (shape.class, shape.vertices.len(), shape.parts.len());
            self.tell(EventKind::ShapeFound { class, vertices, parts }, out);
        }
        self.tell_squared(out);
        self.calibrate();
        self.tell(EventKind::PhaseEnded { phase: Phase::Shape }, out);
        self.phase = Phase::Plan;
        self.tell(EventKind::PhaseBegan { phase: Phase::Plan }, out);
        self.task = Task::Plan;
    }

    /// The outline after its own smooth walls have straightened the lap.
    fn straight_outline(&mut self) -> Result<Ring, Failure> {
        let lap = self.part_faces();
        let outline = self.outlined(&lap)?;
        if !self.straighten(&outline) {
            return Ok(outline);
        }
        let lap = self.part_faces();
        self.outlined(&lap)
    }

    /// Lets the thin walls of the lap, whose faces noise has laid through each other, part them; the lap after that.
    fn part_faces(&mut self) -> AlongWall {
        for _ in 0..PARTINGS {
            let (knots, lap) = (self.survey.knots(), self.along_wall());
            if !part(&mut self.survey, knots, &lap) {
                return lap;
            }
            self.place_contacts();
            self.settle(u64::MAX);
        }
        self.along_wall()
    }

    /// Whether the fit has made an outline, of the room that the robot drove in.
    fn is_sound(&self, fitted: &Result<Ring, Failure>) -> bool {
        fitted.as_ref().is_ok_and(|outline| self.encloses_the_lap(outline))
    }

    /// Whether most of the lap's way lies within `outline`: one that leaves it out is not where the robot drove.
    /// Rounds in a pocket are not of the lap.
    fn encloses_the_lap(&self, outline: &Ring) -> bool {
        let (inside, all) = length_within(&self.way, outline);
        all > 0.0 && inside >= all / 2.0
    }

    /// Keeps what is known of wheels and gyro, once that is more than a guess.
    pub(super) fn calibrate(&mut self) {
        if self.map.laps > 1 {
            let driven = Driven {
                drift: self.tracker.bias(),
                stretch: self.tracker.stretched(),
                lap: self.tracker.active() / f64::from(self.map.laps),
            };
            let known = Calibration::of(&self.survey, &self.settings.chassis, &driven);
            self.map.calibration = Some(known);
        }
    }

    pub(super) fn make_plan(&mut self, out: &mut Vec<Output>) {
        let Some(shape) = &self.map.shape else { return };
        let mut driven = Coverage::new();
        for stretch in stretches(self.tracker.path()) {
            let way: Vec<Point> = stretch.iter().map(|p| p.pose.position).collect();
            driven.add(&way);
        }
        let plan = plan::make(&PlanRequest {
            shape,
            objects: &self.map.objects,
            driven: &driven,
            from: self.tracker.pose().position,
            settings: &self.settings,
        });
        let figures = plan.figures;
        self.map.plan = Some(plan);
        self.keep_planned();
        let (lines, length, hidden_disc) = (figures.lines, figures.length, figures.hidden_disc);
        let over = hidden_disc > self.settings.alpha;
        self.tell(EventKind::PlanMade { lines, length, hidden_disc, over }, out);
    }

    pub(super) fn tour(&mut self, mut tour: Box<Tour>, out: &mut Vec<Output>) {
        let mut told = Vec::new();
        tour.distrust(self.trust.out());
        let next = tour.next(&mut Scene {
            tracker: &mut self.tracker,
            survey: &mut self.survey,
            rest: self.rest,
            map: &mut self.map,
            tell: &mut told,
        });
        self.tell_all(told, out);
        match next {
            Turn::Go(ask) => {
                self.task = Task::Tour(tour);
                self.order(&ask, out);
            }
            Turn::Astray(astray) => self.go_astray(tour, *astray, out),
            Turn::Adjust => {
                tour.publish(&self.survey, &mut self.map);
                if self.adjust_whole(out).is_some() {
                    self.survey.rebase();
                    tour.on_adjusted(&self.map, &self.survey);
                }
                self.tour(tour, out);
            }
            Turn::Over => self.end_tour(tour, out),
        }
    }

    /// The last line is driven: the map is handed over.
    fn end_tour(&mut self, mut tour: Box<Tour>, out: &mut Vec<Output>) {
        tour.publish(&self.survey, &mut self.map);
        let adjusted = self.adjust_whole(out);
        self.refine();
        let mut told = Vec::new();
        tour.take_away_twice(&mut self.map, &mut told);
        tour.measure_hidden(&self.tracker, &mut self.map);
        self.tell_all(told, out);
        if let (true, Some(owed)) = (adjusted.is_some(), self.map.shortfall_to_the_letter())
            && self.went_on == 0
        {
            self.went_on += 1;
            self.tell(EventKind::GoesOn { diameter: owed.hidden }, out);
            self.survey.rebase();
            let rest = tour.of_the_rest(&self.settings, &self.map, &self.survey);
            self.tour(Box::new(rest), out);
            return;
        }
        tour.chart().state_errors(&self.survey, self.settings.start.position, &mut self.map);
        if let Some(accuracy) = &mut self.map.accuracy {
            accuracy.datum = adjusted.and_then(|whole| whole.datum);
        }
        self.move_planned();
        self.tell_unreached(out);
        self.calibrate();
        self.tell_squared(out);
        // Last of these, so that the smallest log still shows it beside the end.
        if let (Some(owed), Some(at)) = (self.map.shortfall(), self.map.hidden_at) {
            self.tell(EventKind::StillHidden { diameter: owed.hidden, at }, out);
        }
        self.tell(EventKind::PhaseEnded { phase: Phase::Objects }, out);
        self.outcome = Outcome::Complete;
        self.tell(EventKind::Complete, out);
    }

    /// Looks for floor that the robot does not get to, and tells of it.
    fn tell_unreached(&mut self, out: &mut Vec<Output>) {
        let here = self.tracker.pose().position;
        let found = unreached(&self.map, &self.settings.chassis, here);
        let straits: Vec<Point> =
            self.map.beyond.iter().filter_map(|one| Some(one.strait()?.at(0.5))).collect();
        // The straits were told when the map was ended there.
        let is_new = |one: &&Unreached| one.area.is_none() || !straits.contains(&one.at);
        self.tell_all(unreached::told(found.iter().filter(is_new)), out);
        self.map.unreached = found;
    }

    /// Fits the outline once more, to contacts that all the touches of the tour have put right. What
    /// that makes more ragged than it was, or another room, is left as it was, only moved; and so is one that ends
    /// at straits, where nothing was felt and a fit would draw wall.
    fn refine(&mut self) {
        let (pieces, area) = self
            .map
            .shape
            .as_ref()
            .map_or((0, 0.0), |shape| (shape.outline.pieces.len(), shape.outline.area()));
        if self.map.beyond.is_empty()
            && let Ok(outline) = self.fitted_outline()
            && outline.pieces.len() <= pieces
            && (outline.area() / area - 1.0).abs() < REFINED
        {
            self.map.shape = Some(shape::identify(outline, &self.map.contacts));
        } else if let Some(shape) = &mut self.map.shape {
            let moved = std::mem::replace(&mut shape.outline, Ring { pieces: Vec::new() });
            shape.outline = shape::mended(moved);
        }
        for object in self.map.objects.iter_mut().filter(|object| object.closed) {
            if let Some((outline, class)) = shape::closer(&object.outline, &object.contacts) {
                (object.outline, object.class) = (outline, class);
            }
        }
    }
}
