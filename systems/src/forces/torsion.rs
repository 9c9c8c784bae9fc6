//! Torsion of a tether: torque = (GJ / L) phi + c dphi/dt along all of it, phi its twist (rad).
//!
//! The torque T acts on everything that phi depends on, so that with the potential 1/2 (GJ / L) phi^2 and
//! the rate of [`line_twist`](super::line_twist) energy and momenta are kept for a line of any shape:
//!
//! ```text
//! torque on `to` = -T c_{n+1}     torque on `from` = T c_1     force on segment k = -T g_k at its end,
//!                                                                                T g_k at its beginning
//! ```
//!
//! GJ torsional stiffness (N m^2), L rest length (m), c damping (N m s). Assumed: a line without torsional
//! inertia, so that the torque is the same everywhere; circular, so that it bends alike to all sides; and
//! without bending stiffness, so that a straight line under the tension T_n leaves the straight where the
//! torque exceeds T_n x (length of a segment): what a real line does at 2 sqrt(B T_n), B its bending
//! stiffness (Greenhill 1883).
//!
//! Turns are counted from the last accepted state on: phi is that of its values, whole turns apart, which
//! is nearest to where the mean of both rates has taken it.

use aerobot_components::derivatives::TorqueDerivatives;
use aerobot_components::state::{AngularVelocity, Attitude, Inertia, Torque};
use aerobot_components::torsion::{AcceptedTwist, ClampedEnd, Torsion, Twist};
use bevy_ecs::system::{Local, Query, Res, ResMut};
use glam::{DMat3, DVec3};

use super::line_twist::{HeldEnd, line_twist, with_turns};
use crate::clock::Clock;
use crate::dynamics::rigid_body::CarriedMass;
use crate::dynamics::segments::PointArrays;

/// Finds the twist of every tether that resists it, and loads its points and what holds its ends.
pub fn torsion(
    clock: Res<Clock>,
    mut arrays: ResMut<PointArrays>,
    mut tethers: Query<(&Torsion, &AcceptedTwist, &mut Twist)>,
    mut carriers: Query<(&Attitude, &AngularVelocity, &mut Torque)>,
    mut gradient: Local<Vec<DVec3>>,
) {
    for (torsion, accepted, mut twist) in &mut tethers {
        let (Some(from), Some(to)) = (held(&carriers, &torsion.from), held(&carriers, &torsion.to))
        else {
            continue;
        };
        let (positions_m, velocities_m_s) = arrays.motion_of(torsion.points.clone());
        let line = line_twist(&from, &to, positions_m, velocities_m_s, &mut gradient);
        let passed_s = clock.time_s - accepted.time_s;
        let expected =
            accepted.twist_rad + 0.5 * passed_s * (accepted.rate_rad_s + line.rate_rad_s);
        let twist_rad = with_turns(line.angle_rad, expected);
        let torque = torsion.stiffness_n_m * twist_rad + torsion.damping_n_m_s * line.rate_rad_s;
        *twist = Twist {
            twist_rad,
            rate_rad_s: line.rate_rad_s,
            torque_n_m: torque,
            from_arm: line.from_arm,
            to_arm: line.to_arm,
        };
        for (segment, g) in gradient.iter().enumerate() {
            let load = torque * *g;
            let ends = arrays.loads_of_segment_n(torsion.points.start + segment);
            ends[0] += load;
            ends[1] -= load;
        }
        for (end, torque) in [
            (&torsion.from, torque * line.from_arm),
            (&torsion.to, -torque * line.to_arm),
        ] {
            if let Ok((_, _, mut total)) = carriers.get_mut(end.carrier) {
                total.0 += torque;
            }
        }
    }
}

/// An end as its carrier has it now.
fn held(
    carriers: &Query<(&Attitude, &AngularVelocity, &mut Torque)>,
    end: &ClampedEnd,
) -> Option<HeldEnd> {
    let (attitude, rate, _) = carriers.get(end.carrier).ok()?;
    Some(HeldEnd {
        axis: attitude.0 * end.axis,
        across: attitude.0 * end.across,
        rate_rad_s: attitude.0 * rate.0,
    })
}

/// Adds the derivatives of the torque on each body with its own turning.
///
/// An implicit step has no entry for the turning of one body by the other. So that both see the frequency
/// of their motion against each other, K a^2 (1/I_1 + 1/I_2), each gets K times (m_1 + m_2) / m_own, where
/// m = a' J^-1 a is how easily a body turns about its arm a.
pub fn torsion_derivatives(
    tethers: Query<(&Torsion, &Twist)>,
    mut bodies: Query<(&Attitude, &Inertia, &CarriedMass, &mut TorqueDerivatives)>,
) {
    for (torsion, twist) in &tethers {
        let ends = [(&torsion.from, twist.from_arm), (&torsion.to, twist.to_arm)].map(
            |(end, inertial)| {
                let (attitude, inertia, carried, _) = bodies.get(end.carrier).ok()?;
                let arm = attitude.0.conjugate() * inertial;
                let turned = (inertia.0 + carried.inertia_kg_m2).inverse() * arm;
                Some((end.carrier, arm, arm.dot(turned)))
            },
        );
        let all: f64 = ends.iter().flatten().map(|(.., mobility)| mobility).sum();
        for (carrier, arm, mobility) in ends.into_iter().flatten() {
            if let Ok((.., mut derivatives)) = bodies.get_mut(carrier) {
                let outer = DMat3::from_cols(arm * arm.x, arm * arm.y, arm * arm.z);
                let outer = outer * (all / mobility);
                derivatives.by_rotation_n_m -= outer * torsion.stiffness_n_m;
                derivatives.by_rate_n_m_s -= outer * torsion.damping_n_m_s;
            }
        }
    }
}

/// Takes the twist of the accepted state as the one from which turns are counted.
pub fn accept_twist(clock: Res<Clock>, mut tethers: Query<(&Twist, &mut AcceptedTwist)>) {
    for (twist, mut accepted) in &mut tethers {
        *accepted = AcceptedTwist {
            twist_rad: twist.twist_rad,
            rate_rad_s: twist.rate_rad_s,
            time_s: clock.time_s,
        };
    }
}
