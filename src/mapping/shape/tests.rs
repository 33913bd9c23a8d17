use super::testing::{REACH, Roll, compare, roll, worlds};
use super::*;
use crate::geometry::Ring;

fn survey(name: &str, truth: &Ring) {
    for sigma in [0.0, 0.0015] {
        for seed in 0..4 {
            let contacts = roll(truth, Roll::new(sigma, seed));
            match outline(&contacts, REACH) {
                Err(why) => println!(
                    "{name} sigma {sigma} seed {seed}: {why}, {}",
                    contacts.len()
                ),
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
fn debug_one() {
    let truth = worlds::u_room();
    let contacts = roll(&truth, Roll::new(0.0, 0));
    let ordered = order::along_wall(&contacts);
    let mut samples = samples(&ordered, LEAST_SIGMA);
    let sigma = noise(&samples);
    println!("sigma {sigma}");
    let runs = segment::runs(&mut samples, sigma);
    for run in &runs {
        println!("{:?} ", run);
        for s in &samples[run.first..=run.last] {
            let tip = [Point::new(1.5, 1.5), Point::new(3.5, 1.5)]
                .iter()
                .map(|c| (c - s.point).norm())
                .fold(f64::INFINITY, f64::min);
            if tip < 0.25 {
                println!(
                    "   {:.4} {:.4} from {:.3} {:.3} edges {:?}",
                    s.point.x, s.point.y, s.from.x, s.from.y, s.edges
                );
            }
        }
    }
    for p in &outline(&contacts, REACH).unwrap().pieces {
        println!("{p:?}");
    }
}
