//! Trim against separate programs and against what a steady flight must be.

use aerobot_components::fixed_wing::aircraft::{AEROSONDE, DragLaw};

use super::flight::{aerosonde, flier, level};
use crate::fixed_wing::flight_trim::{NoTrim, SteadyFlight};

/// Level flight at 25 m/s on Earth and at 54 km above Venus: angle of attack and elevator (deg), throttle and
/// thrust (N) from a separate program (to six figures), which leaves out the torque of the propeller.
#[test]
fn level_flight_is_trimmed_as_a_separate_program_has_it() {
    for (density, gravity, expected) in [
        (1.2682, 9.81, [2.85005, -7.10671, 0.763993, 9.34464]),
        (1.03, 8.87, [3.45716, -8.78699, 0.762292, 7.58007]),
    ] {
        for reaction in [false, true] {
            let mut aircraft = AEROSONDE;
            aircraft.propulsion.reaction = reaction;
            let trim = flier(aircraft, density, gravity).trim(level(25.0)).unwrap();
            let found = [
                trim.alpha_rad.to_degrees(),
                trim.controls.elevator_rad.to_degrees(),
                trim.controls.throttle,
                trim.thrust_n,
            ];
            for (found, expected) in found.iter().zip(expected) {
                let error = (found / expected - 1.0).abs();
                println!("reaction {reaction}: {found:.6} {expected} {error:.1e}");
                // What turns the airframe against the propeller is held by aileron and a hanging wing.
                assert!(error < if reaction { 1e-4 } else { 2e-6 });
            }
        }
    }
}

/// With the polar that the literature prints, of no parasitic drag, the thrust is far below any aircraft's.
#[test]
fn a_polar_without_parasitic_drag_needs_next_to_no_thrust() {
    let mut aircraft = AEROSONDE;
    aircraft.longitudinal.drag = DragLaw::Polar {
        parasitic: 0.0,
        oswald: 0.9,
    };
    let trim = flier(aircraft, 1.2682, 9.81).trim(level(25.0)).unwrap();
    assert!((trim.thrust_n - 0.954).abs() < 1e-3, "{}", trim.thrust_n);
}

/// In a coordinated turn the wing carries 1/cos(roll) of the weight and tan(roll) = V psi'/g but for thrust and
/// side force; in a climb the thrust grows by m g sin(gamma) and by the drag of what lift is left.
#[test]
fn turns_and_climbs_are_what_they_must_be() {
    let flier = aerosonde(1.03, 8.87);
    let straight = flier.trim(level(25.0)).unwrap();
    let turn = SteadyFlight {
        turn_rad_s: 0.2,
        ..level(25.0)
    };
    let turning = flier.trim(turn).unwrap();
    let roll = libm::atan(25.0 * 0.2 / 8.87);
    assert!((turning.roll_rad - roll).abs() < 0.02, "{turning:?}");
    assert!(turning.alpha_rad > straight.alpha_rad);
    let climb = SteadyFlight {
        climb_rad: 0.05,
        ..level(25.0)
    };
    let climbing = flier.trim(climb).unwrap();
    let more = climbing.thrust_n - straight.thrust_n;
    assert!((more / (11.0 * 8.87 * 0.05) - 1.0).abs() < 0.02, "{more}");
    assert!((climbing.pitch_rad - climbing.alpha_rad - 0.05).abs() < 1e-3);
}

/// At the ends of level flight something is at its limit: the elevator below, the throttle above; just beyond
/// there is no trim, just inside there is.
#[test]
fn level_flight_ends_at_the_elevator_and_at_the_throttle() {
    let flier = aerosonde(1.03, 8.87);
    let (least, most) = flier.level_airspeeds_m_s(25.0).unwrap();
    println!("level from {least} to {most} m/s");
    assert!(flier.trim(level(least + 1e-3)).is_ok() && flier.trim(level(most - 1e-3)).is_ok());
    assert!(matches!(
        flier.trim(level(least - 1e-3)),
        Err(NoTrim::Surface {
            surface: "elevator",
            ..
        })
    ));
    assert!(matches!(
        flier.trim(level(most + 1e-3)),
        Err(NoTrim::Throttle { .. })
    ));
    let at_most = flier.trim(level(most - 1e-6)).unwrap();
    assert!((at_most.controls.throttle - 1.0).abs() < 1e-5);
}
