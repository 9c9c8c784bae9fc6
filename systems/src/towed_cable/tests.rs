//! The static cable against closed forms and against values of a separate program.

mod closed_forms;
mod towline;

use super::{Conditions, Line, TowedBody, TowedCable, TowedCableError};

const GRAVITY_M_S2: f64 = 8.87;

fn uniform(density_kg_m3: f64, wind_m_s: f64) -> impl Fn(f64) -> Option<Conditions> {
    move |_| {
        Some(Conditions {
            density_kg_m3,
            wind_m_s,
            gravity_m_s2: GRAVITY_M_S2,
        })
    }
}

/// Nothing but a weight on a weightless line without drag or stretch.
fn plain() -> TowedCable {
    TowedCable {
        line: Line {
            length_m: 1000.0,
            mass_per_length_kg_m: 0.0,
            diameter_m: 0.002,
            axial_stiffness_n: f64::INFINITY,
            normal_drag: 0.0,
            tangential_drag: 0.0,
        },
        body: TowedBody {
            mass_kg: 4.0,
            drag_area_m2: 0.0,
            displaced_volume_m3: 0.0,
        },
        top_altitude_m: 52_000.0,
    }
}

#[track_caller]
fn assert_near(actual: f64, expected: f64, tolerance: f64) {
    let error = (actual - expected).abs();
    assert!(
        error <= tolerance,
        "{actual}, expected {expected}: {error:e}"
    );
}

#[test]
fn wrong_numbers_are_refused_by_name() {
    let air = uniform(1.3, 5.0);
    let refused = |change: &dyn Fn(&mut TowedCable), places: &[f64]| {
        let mut cable = plain();
        change(&mut cable);
        cable.solve(&air, places).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&|cable| cable.line.length_m = -1.0, &[]),
        "`length_m` must be finite and above zero, it is -1"
    );
    assert_eq!(
        refused(&|cable| cable.line.axial_stiffness_n = f64::NAN, &[]),
        "`axial_stiffness_n` must be above zero, it is NaN"
    );
    assert_eq!(
        refused(&|cable| cable.body.mass_kg = f64::INFINITY, &[]),
        "`mass_kg` must be finite and zero or more, it is inf"
    );
    assert_eq!(
        refused(&|_| (), &[1000.1]),
        "`from_top_m` must be between zero and the length, it is 1000.1"
    );
}

#[test]
fn what_has_no_shape_says_why() {
    let mut cable = plain();
    cable.body.mass_kg = 0.0;
    let slack = TowedCableError::Slack { from_body_m: 0.0 };
    assert_eq!(cable.solve(&uniform(1.3, 5.0), &[]), Err(slack));
    // A balloon that lifts a quarter of the line.
    cable.body.displaced_volume_m3 = 1.0;
    cable.line.mass_per_length_kg_m = 4.0 * 1.3 / 1000.0;
    let Err(TowedCableError::Slack { from_body_m }) = cable.solve(&uniform(1.3, 0.0), &[]) else {
        panic!("a line that nothing holds up");
    };
    assert_near(from_body_m, 250.0, 1e-2);
}

/// A body that is blown up where it hangs and falls back where it is not.
#[test]
fn an_edge_of_the_wind_may_leave_no_rest() {
    let mut cable = plain();
    cable.body.drag_area_m2 = 1.0;
    let edge = |z: f64| {
        Some(Conditions {
            density_kg_m3: 1.3,
            wind_m_s: if z < 51_900.0 { 30.0 } else { 0.0 },
            gravity_m_s2: GRAVITY_M_S2,
        })
    };
    let refused = cable.solve(&edge, &[]).unwrap_err();
    assert!(
        matches!(refused, TowedCableError::NoEquilibrium { .. }),
        "{refused}"
    );
}

/// Guesses beyond the known air narrow the search; a line that must leave it is an error.
#[test]
fn air_is_known_only_so_far() {
    let known = |lowest_m: f64| {
        move |z: f64| {
            let air = Conditions {
                density_kg_m3: 1.3,
                wind_m_s: 10.0,
                gravity_m_s2: GRAVITY_M_S2,
            };
            (lowest_m..=52_010.0).contains(&z).then_some(air)
        }
    };
    let mut cable = plain();
    cable.line.normal_drag = 1.0;
    let free = cable.solve(&uniform(1.3, 10.0), &[]).unwrap();
    let bounded = cable.solve(&known(51_050.0), &[]).unwrap();
    assert_near(bounded.depth_m, free.depth_m, 1e-7);
    let refused = cable.solve(&known(51_500.0), &[]).unwrap_err();
    assert!(
        matches!(refused, TowedCableError::Unknown { altitude_m } if (altitude_m - 51_500.0).abs() < 1e-6),
        "{refused}"
    );
}
