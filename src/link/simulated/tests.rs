//! The link as a whole: what went in decides what comes out.

use super::*;
use crate::robot::{CommandId, Guard, Motion, SwitchSet};

fn link(noise: NoiseProfile, seed: u64) -> SimulatedLink {
    let text = "start = { x = 1.0, y = 1.0, heading = 30 }\n[boundary]\nvertices = [[0, 0], [4, 0], [4, 3], [0, 3]]\n[[objects]]\ncircle = { center = [2.5, 1.5], radius = 0.2 }\n";
    let world = World::from_toml(text, "test", 0.1).expect("a good world");
    SimulatedLink::new(&world, &Chassis::default(), noise, seed)
}

/// A wander of 60 motions; everything the robot said.
fn wander(mut link: SimulatedLink) -> Vec<Telemetry> {
    let mut said = Vec::new();
    let all = SwitchSet(0xff);
    for number in 0..60_u32 {
        let motion = match number % 3 {
            0 => Motion::Move { distance: 1.2, speed: 0.2 },
            1 => Motion::Move { distance: -0.05, speed: 0.1 },
            _ => Motion::Turn { angle: 1.0 + f64::from(number % 5) * 0.4, rate: 2.0 },
        };
        let rise = if number % 3 == 0 { all } else { SwitchSet::EMPTY };
        link.send(Command {
            id: CommandId(number + 1),
            motion,
            guard: Guard { rise, fall: SwitchSet::EMPTY },
            time_limit: 20.0,
        });
        for _ in 0..2000 {
            link.advance(&mut said);
            if !link.is_moving() {
                break;
            }
        }
        assert!(!link.is_moving(), "motion {number} did not end");
    }
    said
}

#[test]
fn the_same_seed_says_the_same() {
    for noise in [NoiseProfile::None, NoiseProfile::Calibrated, NoiseProfile::Harsh] {
        let (one, other) = (wander(link(noise, 7)), wander(link(noise, 7)));
        assert!(one.len() > 500, "{noise}: only {} messages", one.len());
        let edges = one.iter().filter(|t| matches!(t, Telemetry::Edge(_)));
        // Each approach to a wall ends at an edge, and backing off makes the next.
        let edges = edges.count();
        assert!(edges >= 6, "{noise}: {edges} edges");
        assert_eq!(one, other, "{noise}: two runs with one seed differ");
    }
}

#[test]
fn another_seed_says_something_else() {
    let profile = NoiseProfile::Calibrated;
    assert_ne!(wander(link(profile, 1)), wander(link(profile, 2)), "the seed changed nothing");
}

#[test]
fn dropping_nothing_the_last_message_of_each_motion_is_done() {
    let said = wander(link(NoiseProfile::None, 1));
    let done: Vec<u32> = said
        .iter()
        .filter_map(|telemetry| match telemetry {
            Telemetry::Done { id, .. } => Some(id.0),
            _ => None,
        })
        .collect();
    assert_eq!(done, (1..=60).collect::<Vec<_>>(), "each motion ends once");
}
