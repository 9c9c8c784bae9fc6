//! Guidance: what the autopilot is asked for, so that the drone follows a path or a target that moves.
//!
//! Every path moves with a reference. With m = v_r - w, the velocity of the reference through the steady air,
//! a drone that is to move at chi against the reference flies through the air with
//!
//! ```text
//! a = m + s e(chi),   |a| = V,   s > 0                        velocity feedforward
//! line    chi = chi_line - chi_inf (2/pi) atan(e_c/l)         e_c to the right of the line
//! orbit   chi = phi + lambda (pi/2 + atan(k (d - rho)/rho))   lambda = 1 clockwise
//! pursuit course = chi_m - chi_inf (2/pi) atan(e_c/l),  V = (|m| - k_a e_a)/cos(course - chi_m)
//! ```
//!
//! e(chi) the horizontal unit vector at the course chi from north to the east; l the distance at which a line
//! is approached at half of chi_inf; d, phi distance and bearing from the centre, rho radius; chi_m the course
//! of m; e_a, e_c how far the drone is ahead and to the right of its station (m); k_a gain (1/s). In pursuit
//! the station is at rest in the drone's speed and course, so that all its errors vanish.
//!
//! Proportional navigation turns the velocity by the acceleration N V_c Omega x r/|r|, Omega = r x v/|r|^2 the
//! rate of the line of sight r to the target, v the target's velocity against the drone, V_c = -r.v/|r|.
//!
//! Sources: Beard and McLain (2012), ch. 10 (line and orbit); Nelson, Barber, McLain and Beard, IEEE Trans.
//! Robotics 23 (2007) 519; Zarchan, "Tactical and Strategic Missile Guidance", 6th ed. 2012, ch. 2.
//!
//! North-east-down throughout, m, m/s, rad. Assumption: paths are level enough for their horizontal part.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

use glam::{DVec2, DVec3};

use super::autopilot::{Command, LateralCommand, VerticalCommand, course_rad};

/// Course against a line far away from it, rad.
const STEEPEST_APPROACH_RAD: f64 = FRAC_PI_2;
/// The same in pursuit, where the station runs ahead.
const STEEPEST_PURSUIT_RAD: f64 = 1.0;
/// Gain of the approach to an orbit.
const ORBIT_GAIN: f64 = 4.0;
/// Below this speed a target has no direction of flight, m/s.
const STANDSTILL_M_S: f64 = 0.5;

/// A point that moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovingPoint {
    /// Position, m.
    pub position_m: DVec3,
    /// Velocity, m/s.
    pub velocity_m_s: DVec3,
}

/// A level line, or nearly so, that moves with a point on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingLine {
    /// The point.
    pub through: MovingPoint,
    /// Its direction.
    pub along: DVec3,
    /// Distance at which it is approached at half the right angle, m.
    pub approach_m: f64,
}

/// A level circle that moves with its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MovingOrbit {
    /// The centre.
    pub centre: MovingPoint,
    /// The radius, m.
    pub radius_m: f64,
    /// Whether it is flown clockwise as seen from above.
    pub clockwise: bool,
}

/// A station beside a target, and how it is approached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// The station.
    pub point: MovingPoint,
    /// Distance at which its line of flight is approached at half the steepest angle, m.
    pub approach_m: f64,
    /// Speed gained for a metre behind, 1/s.
    pub closing_per_s: f64,
    /// Airspeeds that may be asked for, m/s.
    pub airspeeds_m_s: (f64, f64),
}

fn level(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.y)
}

/// The unit vector of a course.
fn towards(course_rad: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(course_rad);
    DVec2::new(cos, sin)
}

/// A quarter turn to the right.
fn right_of(v: DVec2) -> DVec2 {
    DVec2::new(-v.y, v.x)
}

/// Speed s against the reference along `direction` with |m + s direction| = V, m/s: none where the reference
/// outruns the drone that way.
fn speed_along(m: DVec2, direction: DVec2, airspeed_m_s: f64) -> Option<f64> {
    let ahead = m.dot(direction);
    let room = ahead * ahead - m.length_squared() + airspeed_m_s * airspeed_m_s;
    let s = room.max(0.0).sqrt() - ahead;
    (room >= 0.0 && s > 0.0).then_some(s)
}

/// The velocity through the air that moves the drone along `direction` against the reference, and the speed
/// along it; failing that, as near to it as it gets.
fn through_air(m: DVec2, direction: DVec2, airspeed_m_s: f64) -> (DVec2, f64) {
    match speed_along(m, direction, airspeed_m_s) {
        Some(s) => (m + s * direction, s),
        None => (m + airspeed_m_s * direction, 0.0),
    }
}

fn course_of(v: DVec2) -> f64 {
    course_rad(v.extend(0.0))
}

/// Follows a line at an airspeed, from a position, in a steady wind.
#[must_use]
pub fn follow_line(
    line: &MovingLine,
    position_m: DVec3,
    wind_m_s: DVec3,
    airspeed_m_s: f64,
) -> Command {
    let flat = level(line.along).length();
    let along = level(line.along) / flat;
    let from = position_m - line.through.position_m;
    let across_m = level(from).dot(right_of(along));
    let bend = FRAC_2_PI * libm::atan(across_m / line.approach_m);
    let direction = towards(course_of(along) - STEEPEST_APPROACH_RAD * bend);
    let m = level(line.through.velocity_m_s - wind_m_s);
    let (air, s) = through_air(m, direction, airspeed_m_s);
    let rise = -line.along.z / flat;
    let altitude_m = -line.through.position_m.z + rise * level(from).dot(along);
    let climb = -line.through.velocity_m_s.z + rise * s * direction.dot(along);
    Command {
        lateral: LateralCommand::Course(course_of(air), 0.0),
        vertical: VerticalCommand::Altitude(altitude_m, climb),
        airspeed_m_s,
    }
}

/// Follows an orbit at an airspeed, from a position, in a steady wind.
#[must_use]
pub fn follow_orbit(
    orbit: &MovingOrbit,
    position_m: DVec3,
    wind_m_s: DVec3,
    airspeed_m_s: f64,
) -> Command {
    let from = level(position_m - orbit.centre.position_m);
    let distance_m = from.length();
    let side = if orbit.clockwise { 1.0 } else { -1.0 };
    let off = (distance_m - orbit.radius_m) / orbit.radius_m;
    let bearing = if distance_m > 0.0 {
        course_of(from)
    } else {
        0.0
    };
    let direction = towards(bearing + side * (FRAC_PI_2 + libm::atan(ORBIT_GAIN * off)));
    let m = level(orbit.centre.velocity_m_s - wind_m_s);
    let (air, s) = through_air(m, direction, airspeed_m_s);
    // On the circle e turns at s/rho; |a| = V says how s has to change meanwhile.
    let turning = if off.abs() < 0.25 {
        let normal = right_of(direction);
        let spin = side * s / orbit.radius_m;
        let ahead = air.dot(direction);
        let change = if ahead > 0.1 * airspeed_m_s {
            -s * spin * air.dot(normal) / ahead
        } else {
            0.0
        };
        let rate = change * direction + s * spin * normal;
        air.perp_dot(rate) / air.length_squared()
    } else {
        0.0
    };
    Command {
        lateral: LateralCommand::Course(course_of(air), turning),
        vertical: VerticalCommand::Altitude(
            -orbit.centre.position_m.z,
            -orbit.centre.velocity_m_s.z,
        ),
        airspeed_m_s,
    }
}

/// Pursues a station from a position, in a steady wind.
#[must_use]
pub fn pursue(station: &Station, position_m: DVec3, wind_m_s: DVec3) -> Command {
    let m = level(station.point.velocity_m_s - wind_m_s);
    let from = position_m - station.point.position_m;
    let speed = m.length();
    // A target without way on is approached straight.
    let along = if speed > STANDSTILL_M_S {
        m / speed
    } else {
        (-level(from)).normalize_or(DVec2::X)
    };
    let ahead_m = level(from).dot(along);
    let across_m = level(from).dot(right_of(along));
    let bend = STEEPEST_PURSUIT_RAD * FRAC_2_PI * libm::atan(across_m / station.approach_m);
    let wanted = (speed - station.closing_per_s * ahead_m) / libm::cos(bend);
    let (least, most) = station.airspeeds_m_s;
    Command {
        lateral: LateralCommand::Course(course_of(along) - bend, 0.0),
        vertical: VerticalCommand::Altitude(
            -station.point.position_m.z,
            -station.point.velocity_m_s.z,
        ),
        airspeed_m_s: wanted.clamp(least, most),
    }
}

/// The acceleration that proportional navigation asks for, m/s^2: across the line of sight from a moving
/// point to its target. None while the two part.
#[must_use]
pub fn proportional_navigation(
    constant: f64,
    drone: &MovingPoint,
    target: &MovingPoint,
) -> Option<DVec3> {
    let sight = target.position_m - drone.position_m;
    let velocity = target.velocity_m_s - drone.velocity_m_s;
    let range = sight.length();
    let closing = -sight.dot(velocity) / range;
    if !(range > 0.0 && closing > 0.0) {
        return None;
    }
    let spin = sight.cross(velocity) / (range * range);
    Some(constant * closing * spin.cross(sight / range))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point without inertia that flies as the field says, in a wind, about a centre that moves, comes to
    /// the line and to the circle, and stays.
    #[test]
    fn a_point_in_the_fields_comes_to_moving_paths() {
        let wind = DVec3::new(4.0, -6.0, 0.0);
        let reference = MovingPoint {
            position_m: DVec3::new(30.0, 100.0, -50.0),
            velocity_m_s: DVec3::new(-3.0, 5.0, 0.0),
        };
        let fly = |command: &dyn Fn(DVec3, MovingPoint) -> Command| {
            let (mut position, mut reference) = (DVec3::new(-200.0, 350.0, -50.0), reference);
            for _ in 0..20_000 {
                let LateralCommand::Course(course, _) = command(position, reference).lateral else {
                    panic!("a course");
                };
                let velocity = wind + 25.0 * towards(course).extend(0.0);
                position += 0.01 * velocity;
                reference.position_m += 0.01 * reference.velocity_m_s;
            }
            position - reference.position_m
        };
        let along = DVec3::new(3.0, 4.0, 0.0);
        let from_line = fly(&|position, through| {
            let line = MovingLine {
                through,
                along,
                approach_m: 60.0,
            };
            follow_line(&line, position, wind, 25.0)
        });
        let off_m = from_line.dot(DVec3::new(-0.8, 0.6, 0.0));
        assert!(off_m.abs() < 1e-6, "{off_m}");
        let from_centre = fly(&|position, centre| {
            let orbit = MovingOrbit {
                centre,
                radius_m: 120.0,
                clockwise: true,
            };
            follow_orbit(&orbit, position, wind, 25.0)
        });
        let off_m = from_centre.length() - 120.0;
        assert!(off_m.abs() < 0.05, "{off_m}");
    }

    /// The rate of turn that goes with an orbit is the change of the course along it.
    #[test]
    fn the_turn_of_an_orbit_is_how_its_course_changes() {
        let wind = DVec3::new(4.0, -6.0, 0.0);
        let orbit = MovingOrbit {
            centre: MovingPoint {
                velocity_m_s: DVec3::new(-3.0, 2.0, 0.0),
                ..MovingPoint::default()
            },
            radius_m: 150.0,
            clockwise: false,
        };
        let at = |position| {
            let command = follow_orbit(&orbit, position, wind, 25.0);
            let LateralCommand::Course(course, turn) = command.lateral else {
                panic!("a course");
            };
            (course, turn)
        };
        for bearing in [0.3, 1.8, 4.0] {
            let here = 150.0 * towards(bearing).extend(0.0);
            let (course, turn) = at(here);
            let against = wind + 25.0 * towards(course).extend(0.0) - orbit.centre.velocity_m_s;
            let h = 1e-4;
            // On along the circle itself: a chord would leave it by the square.
            let on = (here + h * against).normalize() * 150.0;
            let back = (here - h * against).normalize() * 150.0;
            let slope = (at(on).0 - at(back).0) / (2.0 * h);
            assert!((slope - turn).abs() < 1e-6, "{slope} {turn}");
        }
    }

    /// Against a target that flies straight, linearised: with the time to go t_go the rate of the line of
    /// sight falls as t_go^(N - 2), and the acceleration with it (Zarchan 2012, eq. 2.22).
    #[test]
    fn the_line_of_sight_of_proportional_navigation_comes_to_rest() {
        for constant in [3.0, 4.0] {
            let mut drone = MovingPoint {
                position_m: DVec3::ZERO,
                velocity_m_s: DVec3::new(30.0, 0.03, 0.0),
            };
            let mut target = MovingPoint {
                position_m: DVec3::new(1000.0, 0.0, 0.0),
                velocity_m_s: DVec3::new(10.0, 0.0, 0.0),
            };
            let asked = |drone: &MovingPoint, target: &MovingPoint| {
                proportional_navigation(constant, drone, target).unwrap().y
            };
            let first = asked(&drone, &target);
            let (total_s, h) = (50.0, 1e-3);
            for step in 0..40_000 {
                if step % 10_000 == 0 && step > 0 {
                    let left = 1.0 - f64::from(step) * h / total_s;
                    let expected = first * left.powf(constant - 2.0);
                    let found = asked(&drone, &target);
                    assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
                }
                let acceleration = proportional_navigation(constant, &drone, &target).unwrap();
                drone.velocity_m_s += h * acceleration;
                drone.position_m += h * drone.velocity_m_s;
                target.position_m += h * target.velocity_m_s;
            }
        }
    }
}
