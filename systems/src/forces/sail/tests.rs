use std::f64::consts::{PI, TAU};

use aerobot_components::sail::{LiftingSurface, SailAirspeed, SailLoads, SailShape};
use glam::{DQuat, DVec3};

use super::*;

/// The sail of the paper (sec. 5.2.1) with a rudder of 0.5 m^2 and no drag without lift, the wing's centre
/// ahead (+1) or aft (-1), and the sign before the downwash.
fn paper(side: f64, downwash: f64, slope: f64) -> SailShape {
    let surface = |area_m2: f64, x: f64| LiftingSurface {
        area_m2,
        lift_slope_per_rad: slope,
        zero_lift_drag: 0.0,
        induced_drag: 0.0,
        has_drag: false,
        centre_m: DVec3::new(x, 0.0, 0.0),
    };
    SailShape {
        wing: surface(3.0, 0.5 * side),
        rudder: surface(0.5, -4.0),
        downwash_rad: downwash * 2.0 / (PI * 5.0),
        stall: None,
        airspeed: SailAirspeed::Full,
    }
}

/// A sail whose bow points by `incidence_rad` to starboard of its motion of 1 m/s.
fn sailing(incidence_rad: f64) -> SailMotion {
    SailMotion {
        attitude: DQuat::from_rotation_z(-incidence_rad),
        through_air_m_s: DVec3::X,
        rate_rad_s: DVec3::ZERO,
    }
}

/// Incidence of the wing at which nothing turns the sail, over the deflection, and its loads there.
fn trim(shape: &SailShape) -> (f64, SailLoads) {
    let deflection_rad = 0.001;
    let at = |incidence: f64| sail_loads(shape, &sailing(incidence), 2.0, deflection_rad);
    // The torque is linear in incidence but for round-off and the cube of it.
    let (mut before, mut now) = (0.0, 0.01);
    for _ in 0..20 {
        let (a, b) = (at(before).torque_n_m.z, at(now).torque_n_m.z);
        if b == 0.0 || a == b {
            break;
        }
        (before, now) = (now, now - b * (now - before) / (b - a));
    }
    (now / deflection_rad, at(now))
}

/// l_r S_r delta = (l_r S_r (1 -+ eps') - s l_w S_w) alpha, by hand, for both sides and both signs; the side
/// force over q delta of two of them.
#[test]
fn trim_is_that_of_the_closed_form() {
    for (slope, side, sign) in [
        (TAU, 1.0, -1.0),
        (TAU, -1.0, -1.0),
        (TAU, 1.0, 1.0),
        (TAU, -1.0, 1.0),
        (TAU / 1.4, 1.0, -1.0),
        (TAU / 1.4, -1.0, -1.0),
        (TAU / 1.4, 1.0, 1.0),
        (TAU / 1.4, -1.0, 0.0),
    ] {
        let straightened = 1.0 + sign * 2.0 * slope / (PI * 5.0);
        let expected = 4.0 * 0.5 / (4.0 * 0.5 * straightened - side * 0.5 * 3.0);
        let (found, _) = trim(&paper(side, sign, slope));
        assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
    }
    for (side, sign, ratio, force) in [(-1.0, -1.0, 1.05263, -17.361), (1.0, 1.0, 0.95238, -20.196)]
    {
        let (found, loads) = trim(&paper(side, sign, TAU));
        assert!((found - ratio).abs() < 1e-5, "{found}");
        // At 1 m/s in a density of 2 the dynamic pressure is 1 Pa.
        let across = DQuat::from_rotation_z(-found * 0.001) * loads.force_n;
        assert!((across.y / 0.001 - force).abs() < 1e-3, "{}", across.y);
    }
}

#[test]
fn stiffness_is_the_slope_of_the_torque_and_tells_the_least_rudder() {
    for (side, sign, slope) in [(1.0, -1.0, TAU), (-1.0, -1.0, 4.488), (1.0, 1.0, TAU)] {
        let mut shape = paper(side, sign, slope);
        shape.wing.zero_lift_drag = 0.3;
        shape.wing.has_drag = true;
        let torque = |incidence: f64| {
            sail_loads(&shape, &sailing(incidence), 2.0, 0.0)
                .torque_n_m
                .z
        };
        let h = 1e-5;
        let slope = (torque(h) - torque(-h)) / (2.0 * h);
        assert!((slope / yaw_stiffness_m3_rad(&shape) - 1.0).abs() < 1e-6);
    }
    // By hand: 0.5 x 3 / (4 x 0.2) with the slope 2 pi, and with 2 pi/1.4 at an aspect ratio of 5.
    let least = |slope| least_rudder_area_m2(&paper(1.0, -1.0, slope)).unwrap_or(f64::NAN);
    assert!((least(TAU) - 1.875).abs() < 1e-12);
    assert!((least(TAU / 1.4) - 0.875).abs() < 1e-12);
    assert_eq!(least_rudder_area_m2(&paper(-1.0, -1.0, TAU)), Some(0.0));
}

/// Turned with all that moves it, a sail has the same loads in its own axes.
#[test]
fn forces_turn_with_the_body() {
    let mut shape = paper(-1.0, -1.0, TAU / 1.4);
    shape.stall = Some((0.26, 50.0));
    shape.wing.induced_drag = 0.09;
    for airspeed in [SailAirspeed::Full, SailAirspeed::Horizontal] {
        shape.airspeed = airspeed;
        let tilted = SailMotion {
            attitude: DQuat::from_rotation_z(0.3) * DQuat::from_rotation_x(0.2),
            through_air_m_s: DVec3::new(4.0, -1.0, 0.7),
            rate_rad_s: DVec3::new(0.1, -0.2, 0.3),
        };
        let own = sail_loads(&shape, &tilted, 0.9, 0.1);
        for angle in [0.1, 2.0, -3.0] {
            let turn = DQuat::from_rotation_z(angle);
            let turned = SailMotion {
                attitude: turn * tilted.attitude,
                through_air_m_s: turn * tilted.through_air_m_s,
                ..tilted
            };
            let loads = sail_loads(&shape, &turned, 0.9, 0.1);
            assert!((loads.force_n - own.force_n).length() < 1e-12);
            assert!((loads.torque_n_m - own.torque_n_m).length() < 1e-12);
        }
    }
}

/// Lift does no work on the surface's own motion through the air, drag takes from it: whatever the attitude.
#[test]
fn the_air_only_takes_energy_where_it_is_at_rest() {
    let mut shape = paper(-1.0, -1.0, TAU / 1.4);
    shape.wing.zero_lift_drag = 0.02;
    shape.wing.has_drag = true;
    for (x, y, z) in [
        (1.0, 0.2, 0.1),
        (-0.5, 1.0, -0.4),
        (0.0, 0.0, 1.0),
        (0.0, 0.0, 0.0),
    ] {
        let motion = SailMotion {
            attitude: DQuat::from_rotation_y(0.4) * DQuat::from_rotation_z(0.8),
            through_air_m_s: DVec3::new(x, y, z),
            rate_rad_s: DVec3::new(0.3, 0.2, -0.5),
        };
        let loads = sail_loads(&shape, &motion, 1.0, 0.2);
        let own = motion.attitude.conjugate() * motion.through_air_m_s;
        let power = loads.force_n.dot(own) + loads.torque_n_m.dot(motion.rate_rad_s);
        assert!(power <= 1e-12 && power.is_finite(), "{power}");
        let wing = own + motion.rate_rad_s.cross(shape.wing.centre_m);
        assert!((power + loads.drag_n * wing.length()).abs() < 1e-12);
    }
}

/// A turning sail in a stream is braked: the rudder meets the air from the side to which it moves.
#[test]
fn yaw_is_damped() {
    let shape = paper(-1.0, -1.0, TAU);
    let turning = SailMotion {
        rate_rad_s: DVec3::new(0.0, 0.0, 0.01),
        ..sailing(0.0)
    };
    assert!(sail_loads(&shape, &turning, 2.0, 0.0).torque_n_m.z < 0.0);
}
