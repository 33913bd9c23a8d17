//! What the fit, the classes and the parts come to on rooms whose truth is known.

use super::testing::{REACH, Roll, compare, roll, worlds};
use super::*;
use crate::geometry::Ring;
use crate::mapping::map::ContactKind;

#[test]
fn rooms_are_fitted_to_what_their_contacts_scatter_by() {
    // Least IoU, and how far off it may be: for 95 % of it, and at worst. What no beam or body gets behind is
    // off by more: an end of the thin wall, pillars of the hall.
    let bounds = |name: &str| match name {
        "hall" => (0.97, 0.012, 0.13),
        "thin" => (0.998, 0.003, 0.035),
        _ => (0.998, 0.003, 0.006),
    };
    for (name, ring) in [
        ("rectangle", worlds::rectangle(5.0, 4.0)),
        ("pentagon", worlds::regular(5, 2.0)),
        ("16-gon", worlds::regular(16, 2.0)),
        ("l", worlds::l_room()),
        ("u", worlds::u_room()),
        ("thin", worlds::thin_wall()),
        ("flat", worlds::flat()),
        ("comb", worlds::comb()),
        ("circle", Ring::circle(Point::new(1.0, 1.0), 2.0)),
        ("stadium", worlds::stadium()),
        ("d", worlds::d_room()),
        ("semi", worlds::semicircle()),
        ("sector", worlds::sector()),
        ("keyhole", worlds::keyhole()),
        ("niche", worlds::niche()),
        ("column", worlds::column()),
        ("hall", worlds::hall()),
    ] {
        for (sigma, seed) in
            [0.0, 0.0015].into_iter().flat_map(|s| (0..4).map(move |seed| (s, seed)))
        {
            let contacts = roll(&ring, Roll::new(sigma, seed));
            let fitted = AlongWall::of(&contacts, REACH).outline(0.0, Loops::Touched).expect(name);
            let error = compare(&fitted, &ring);
            let (iou, p95, worst) = bounds(name);
            assert!(
                error.iou > iou && error.p95 < p95 && error.worst < worst,
                "{name}, {sigma} m, seed {seed}: IoU {}, p95 {} m, worst {} m",
                error.iou,
                error.p95,
                error.worst
            );
        }
    }
}

#[test]
fn the_first_wall_is_the_one_that_was_met_first_wherever_a_fit_begins() {
    let room = worlds::l_room();
    let mut contacts = roll(&room, Roll::new(0.0, 0));
    let fitted = AlongWall::of(&contacts, REACH).outline(0.0, Loops::Touched).expect("an outline");
    let met = contacts.iter_mut().min_by(|a, b| a.time.total_cmp(&b.time)).expect("a contact");
    met.point = fitted.pieces[3].at(0.5);
    for begun in 0..fitted.pieces.len() {
        let mut again = fitted.clone();
        again.pieces.rotate_left(begun);
        let found = identify(again, &contacts).outline;
        assert_eq!(found.pieces[0], fitted.pieces[3], "begun at {begun}");
        assert_eq!(found.pieces[1], fitted.pieces[4], "begun at {begun}");
    }
}

#[test]
fn an_outline_that_leaves_out_where_the_robot_was_is_none() {
    let room = worlds::l_room();
    let mut contacts = roll(&room, Roll::new(0.0, 0));
    assert!(AlongWall::of(&contacts, REACH).outline(0.0, Loops::Touched).is_ok());
    // As if a tenth of them had been made from behind the wall.
    for contact in contacts.iter_mut().step_by(10) {
        contact.from = contact.point + (contact.point - contact.from);
    }
    assert_eq!(
        AlongWall::of(&contacts, REACH).outline(0.0, Loops::Touched),
        Err(Failure::OutlineBroken)
    );
}

#[test]
fn a_thing_is_on_the_map_when_most_of_what_was_seen_lies_on_it() {
    let ring = |x: f64| {
        let corners = [(x, 0.0), (x + 0.5, 0.0), (x + 0.5, 0.5), (x, 0.5)];
        Ring::polygon(&corners.map(|(x, y)| Point::new(x, y)))
    };
    let seen = |on: usize, off: usize| -> Vec<Contact> {
        let at = |x: f64| Point::new(x, 0.05);
        let places = (0..on).map(|_| at(1.05)).chain((0..off).map(|_| at(2.0)));
        let contact = |point| Contact {
            point,
            from: point,
            sensor: Some(0),
            kind: ContactKind::Range,
            time: 0.0,
        };
        places.map(contact).collect()
    };
    let mapped = [ring(1.0), ring(3.0)];
    assert!(is_mapped(&seen(7, 3), &mapped.iter()));
    assert!(!is_mapped(&seen(5, 5), &mapped.iter()));
    assert!(!is_mapped(&seen(7, 3), &mapped[1..].iter()), "another thing");
    assert!(!is_mapped(&seen(7, 3), &[].iter()), "nothing is mapped yet");
    assert!(lies_on(&seen(7, 0), &mapped[0]));
    assert!(!lies_on(&seen(7, 1), &mapped[0]), "a part of it stands free");
}
