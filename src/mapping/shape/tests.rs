//! What the fit, the classes and the parts come to on rooms whose truth is known.

use super::testing::{REACH, Roll, compare, roll, worlds};
use super::*;
use crate::geometry::Ring;
use crate::mapping::map::ContactKind;

fn survey(name: &str, truth: &Ring) {
    for sigma in [0.0, 0.0015] {
        for seed in 0..4 {
            let contacts = roll(truth, Roll::new(sigma, seed));
            match outline(&contacts, REACH, 0.0) {
                Err(why) => println!("{name} sigma {sigma} seed {seed}: {why}, {}", contacts.len()),
                Ok(ring) => {
                    let error = compare(&ring, truth);
                    let pieces = ring.pieces.len();
                    let shape = identify(ring, &contacts);
                    let parts: Vec<_> = shape.parts.iter().map(|p| p.class).collect();
                    println!(
                        "{name:10} s{sigma:.4} #{seed} n{:4} p95 {:5.1} worst {:5.1} iou {:.4} pieces {pieces:3} {:?} {parts:?}",
                        contacts.len(),
                        error.p95 * 1e3,
                        error.worst * 1e3,
                        error.iou,
                        shape.class
                    );
                }
            }
        }
    }
}

#[test]
fn survey_all() {
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
        survey(name, &ring);
    }
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
}
