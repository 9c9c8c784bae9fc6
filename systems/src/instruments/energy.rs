//! Mechanical energy of the whole system and the work of non-conservative forces.
//!
//! E = sum 1/2 m v^2 + sum 1/2 omega' J omega (kinetic) + sum m phi(z) (gravity)
//!   + sum 1/2 k (L - L0)^2 (elastic, taut segments) + sum 1/2 (GJ / L) phi^2 (torsion).
//!
//! dW/dt = sum F.v + T.omega - m_a a.v over what is free to move, less the power of weight,
//! springs and torsion: drag, buoyancy, dampers, added mass, moving anchors and a user's own forces. Then
//! E(t) - E(0) = W(t) for exact motion; the difference measures the integration. Masses on anchors are
//! left out.

use aerobot_components::state::FirstOrderState;
use bevy_ecs::component::Component;
use bevy_ecs::query::With;
use bevy_ecs::system::{Query, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};
use super::energy_sum::{AddedMass, EnergySum};

/// Name of the channel of kinetic energy.
pub const KINETIC: &str = "kinetic_energy_j";
/// Name of the channel of potential energy: gravity, springs and torsion.
pub const POTENTIAL: &str = "potential_energy_j";
/// Name of the channel of their sum.
pub const MECHANICAL: &str = "mechanical_energy_j";
/// Name of the channel of the work of non-conservative forces since the start.
pub const WORK: &str = "nonconservative_work_j";

/// Marks the entity that integrates the work of non-conservative forces.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct WorkIntegral;

/// Records the energy of the whole system.
pub fn energy(
    mut log: ResMut<ChannelLog>,
    sum: EnergySum,
    work: Query<(&BuiltInChannels, &FirstOrderState), With<WorkIntegral>>,
) {
    let Ok((channels, work)) = work.single() else {
        return;
    };
    let kinetic = sum.kinetic_j(AddedMass::Outside);
    let potential = sum.potential_j();
    for (channel, value) in [
        (KINETIC, kinetic),
        (POTENTIAL, potential),
        (MECHANICAL, kinetic + potential),
        (WORK, work.value),
    ] {
        if channels.has(channel) {
            log.record_system(channel, value);
        }
    }
}

/// Mechanical energy of the whole system at the state that was evaluated last, J.
pub fn mechanical_energy_j(sum: EnergySum) -> f64 {
    sum.kinetic_j(AddedMass::Outside) + sum.potential_j()
}

/// Finds the power of non-conservative forces, when all forces and accelerations are known.
pub fn nonconservative_power(
    sum: EnergySum,
    mut work: Query<&mut FirstOrderState, With<WorkIntegral>>,
) {
    let Ok(mut work) = work.single_mut() else {
        return;
    };
    let mut power = sum.power_besides_weight_w(AddedMass::Outside);
    for spring in sum.springs() {
        power += spring.stiffness_n_m * spring.stretch_m * spring.rate_m_s;
    }
    power += sum.torsion_potential_rate_w();
    work.rate_per_s = power + sum.reels_w().0;
}
