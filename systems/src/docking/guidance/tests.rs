//! The phases, one tick at a time, with a drone that is where the test puts it.

use super::*;
use aerobot_components::docking::Navigation;

fn docking() -> Docking {
    Docking {
        navigation: Navigation::Perfect,
        standoff_m: 6.0,
        closing_speed_m_s: 0.25,
        lateral_gate_m: 0.5,
        lateral_limit_m: 1.0,
        station_error_m: 0.5,
        station_s: 2.0,
        attempts: 2,
        patience_s: 20.0,
    }
}

const PORT: DockingPort = DockingPort {
    at_m: DVec3::ZERO,
    axis: DVec3::X,
};

/// A drone at `at`, before a port at the origin that faces -x.
fn view(time_s: f64, at: DVec3) -> View {
    View {
        time_s,
        period_s: 0.05,
        own: PortMotion {
            position_m: at,
            velocity_m_s: DVec3::ZERO,
            axis: DVec3::X,
        },
        seen: Some(PortEstimate {
            motion: PortMotion {
                position_m: DVec3::ZERO,
                velocity_m_s: DVec3::ZERO,
                axis: DVec3::NEG_X,
            },
            acceleration_m_s2: DVec3::ZERO,
        }),
        flight: FlightStatus {
            needed_thrust_n: 53.0,
            largest_thrust_n: 99.0,
            is_tilt_limited: false,
        },
        wind_m_s: DVec3::ZERO,
        taken: false,
    }
}

/// Follows exactly what it is told until `until_s`.
fn follow(guidance: &mut Guidance, mut at: DVec3, from_s: f64, until_s: f64) -> DVec3 {
    let mut time_s = from_s;
    while time_s < until_s {
        let reference = guidance.tick(&docking(), &PORT, &view(time_s, at));
        at = reference.position_m.unwrap_or(at);
        time_s += 0.05;
    }
    at
}

#[test]
fn a_drone_that_follows_goes_through_all_phases() {
    let mut guidance = Guidance::new(0.0);
    // 6 m at 0.25 m/s after 2 s of station-keeping, and a few ticks.
    let at = follow(&mut guidance, DVec3::new(-50.0, 0.0, 0.0), 0.0, 2.3 + 20.0);
    assert_eq!(guidance.phase, DockingPhase::Contact);
    assert!((at.x + 1.0).abs() < 0.1, "{at}");
    let phases = [
        DockingPhase::Approach,
        DockingPhase::StationKeeping,
        DockingPhase::Contact,
    ];
    assert_eq!(guidance.news, phases.map(News::Phase));
}

/// Beside the axis the gap stands still; too far beside it the approach is missed, and so often that there is no
/// other.
#[test]
fn missed_approaches_back_off_and_end() {
    let mut guidance = Guidance::new(0.0);
    let at = follow(&mut guidance, DVec3::new(-50.0, 0.0, 0.0), 0.0, 10.0);
    let waits = guidance.tick(&docking(), &PORT, &view(10.0, at + 0.6 * DVec3::Y));
    let still = guidance.tick(&docking(), &PORT, &view(10.05, at + 0.6 * DVec3::Y));
    assert_eq!(waits.position_m, still.position_m);
    let backs = guidance.tick(&docking(), &PORT, &view(10.1, at + 1.1 * DVec3::Y));
    assert_eq!(guidance.phase, DockingPhase::Approach);
    assert_eq!(backs.position_m, Some(DVec3::new(-6.0, 0.0, 0.0)));
    let at = follow(&mut guidance, at, 10.15, 20.0);
    assert_eq!(guidance.phase, DockingPhase::Contact);
    guidance.tick(&docking(), &PORT, &view(20.0, at + 1.1 * DVec3::Y));
    assert_eq!(guidance.phase, DockingPhase::Unreachable);
    let last = guidance.news.last().copied();
    let missed = Unreachable::Missed {
        approaches: 2,
        misalignment_rad: 0.0,
    };
    assert_eq!(last, Some(News::Unreachable(missed)));
}

/// What comes no nearer is given up after the patience, for the reason that held.
#[test]
fn what_keeps_away_is_given_up() {
    for (largest_thrust_n, word) in [(99.0, "too fast"), (40.0, "out of thrust")] {
        let mut guidance = Guidance::new(0.0);
        let mut time_s = 0.0;
        while guidance.phase != DockingPhase::Unreachable && time_s < 100.0 {
            let mut seen = view(time_s, DVec3::new(-50.0 - time_s, 0.0, 0.0));
            seen.flight.largest_thrust_n = largest_thrust_n;
            guidance.tick(&docking(), &PORT, &seen);
            time_s += 0.05;
        }
        assert!((time_s - 20.1).abs() < 0.11, "{time_s}");
        let Some(News::Unreachable(reason)) = guidance.news.last() else {
            unreachable!("{:?}", guidance.news);
        };
        assert_eq!(reason.word(), word);
    }
}

#[test]
fn headings_put_ports_face_to_face() {
    let found = heading(DVec3::NEG_X, DVec3::X);
    assert_eq!(found, Some(0.0));
    let found = heading(DVec3::NEG_X, DVec3::Y).unwrap_or(0.0);
    let turned = DVec3::new(-found.sin(), found.cos(), 0.0);
    assert!((turned - DVec3::X).length() < 1e-15);
    assert_eq!(heading(DVec3::NEG_Z, DVec3::X), None);
}

/// Of an axis that turns at 0.05 rad/s the place in front moves at 0.05 x 6 m/s, which the reference says.
#[test]
fn the_place_in_front_moves_with_an_axis_that_turns() {
    let mut guidance = Guidance::new(0.0);
    let mut reference = FlightReference::default();
    for tick in 0..200 {
        let time_s = f64::from(tick) * 0.05;
        let mut view = view(time_s, DVec3::new(-50.0, 0.0, 0.0));
        let angle = 0.05 * time_s;
        if let Some(seen) = &mut view.seen {
            seen.motion.axis = DVec3::new(-angle.cos(), -angle.sin(), 0.0);
        }
        reference = guidance.tick(&docking(), &PORT, &view);
    }
    assert!((reference.velocity_m_s.length() - 0.3).abs() < 1e-3);
    assert!((reference.heading_rad - 0.05 * 199.0 * 0.05).abs() < 1e-12);
}
