//! A line that is paid out or reeled in. Only the segment at the winch changes: its
//! unstretched length L0 at the commanded rate r = dL0/dt (m/s), with stiffness EA/L0, damping c'/L0 and mass
//! mu L0, half at each end. What the two ends gain is lost by the drum, a mass at the same attachment.
//!
//! Paying out, the far point gains mass mu r/2 at the velocity of the attachment, so that it is loaded by
//! -mu r/2 (v_far - v_near) (Meshchersky); the attachment and its drum lose it at their own velocity, which
//! loads nothing. Reeling in, the far point loses mass at its own velocity and the attachment takes it up at
//! that velocity: it is loaded by mu |r|/2 (v_far - v_near). Momentum is conserved in both.

use aerobot_components::docking::Docked;
use aerobot_components::segment::{KelvinVoigt, RigidLink};
use aerobot_components::state::{FirstOrderState, Force, Inertia, Mass, Velocity};
use aerobot_components::tether::Attachment;
use aerobot_components::winch::ReeledLine;
use bevy_ecs::component::Component;
use bevy_ecs::query::{With, Without};
use bevy_ecs::system::Query;

use super::rigid_body::CarriedMass;
use crate::docking::impact;

/// Marks a body that carries an end of a reeled line, whose mass changes.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct CarriesReeledLine;

/// Gives the segment at every winch, its two ends and the drum what they have at this length. The spring of a
/// rigid link is that with which its state of rest was found, and stays.
pub fn pay_out(
    mut lines: Query<(&ReeledLine, &mut FirstOrderState)>,
    mut springs: Query<&mut KelvinVoigt, Without<RigidLink>>,
    mut masses: Query<&mut Mass>,
) {
    for (line, mut state) in &mut lines {
        state.rate_per_s = line.rate_m_s;
        let length_m = state.value;
        // A spring at rest is left alone: who looks for other forces has taken it away.
        if let Ok(mut spring) = springs.get_mut(line.segment)
            && spring.rest_length_m != length_m
        {
            spring.rest_length_m = length_m;
            spring.stiffness_n_m = line.stiffness_n / length_m;
            spring.damping_n_s_m = line.damping_n_s / length_m;
        }
        let half_kg = 0.5 * line.line_kg_m * length_m;
        let drum_kg = line.line_kg_m * (line.near_and_stored_m - length_m).max(0.0);
        for (point, mass_kg) in [
            (line.near, half_kg),
            (line.far, line.far_mass_kg + half_kg),
            (line.drum, drum_kg),
        ] {
            if let Ok(mut mass) = masses.get_mut(point) {
                mass.0 = mass_kg;
            }
        }
    }
}

/// Sums anew what bodies with a changing line carry.
pub fn carry(
    ends: Query<(&Attachment, &Mass)>,
    riders: Query<(&Docked, &Mass, &Inertia)>,
    mut carriers: Query<&mut CarriedMass, With<CarriesReeledLine>>,
) {
    for mut carried in &mut carriers {
        *carried = CarriedMass::default();
    }
    for (end, mass) in &ends {
        if let Ok(mut carried) = carriers.get_mut(end.carrier) {
            carried.add(mass.0, end.offset_m);
        }
    }
    for (docked, mass, inertia) in &riders {
        if let Ok(mut carried) = carriers.get_mut(docked.carrier) {
            let rider = impact::carried(mass.0, inertia.0, docked.offset_m, docked.attitude);
            *carried = carried.plus(&rider);
        }
    }
}

/// Adds the force of mass that arrives at another velocity.
pub fn take_up(
    lines: Query<&ReeledLine>,
    velocities: Query<&Velocity>,
    mut forces: Query<&mut Force>,
) {
    for line in &lines {
        let (Ok(near), Ok(far)) = (velocities.get(line.near), velocities.get(line.far)) else {
            continue;
        };
        let flow_kg_s = 0.5 * line.line_kg_m * line.rate_m_s;
        let receiver = if flow_kg_s > 0.0 { line.far } else { line.near };
        if let Ok(mut force) = forces.get_mut(receiver) {
            // Of either sign: what arrives is faster by near less far, or by far less near.
            force.0 += flow_kg_s * (near.0 - far.0);
        }
    }
}
