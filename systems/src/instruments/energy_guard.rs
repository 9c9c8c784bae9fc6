//! Mechanical energy as the implicit integrator watches it: whether a step has made energy.
//!
//! As [`super::energy`], with the added mass in the kinetic energy, and the power of everything but
//! weight and the tethers' axial forces and torsion. Dampers are left out: they can only take.

use aerobot_components::segment::{SegmentGeometry, Tension};
use bevy_ecs::system::Query;

use super::energy_sum::{AddedMass, EnergySum};
use crate::integration::MechanicalEnergy;

/// Energy and power of the state that was evaluated last.
pub fn mechanical_energy(
    sum: EnergySum,
    tensions: Query<(&Tension, &SegmentGeometry)>,
) -> MechanicalEnergy {
    let kinetic_j = sum.kinetic_j(AddedMass::Inside);
    let mut power_w = sum.power_besides_weight_w(AddedMass::Inside);
    for (tension, geometry) in &tensions {
        power_w += tension.0 * geometry.length_rate_m_s;
    }
    let (by_change_w, by_damper_w) = sum.reels_w();
    power_w += sum.torsion_power_w() + by_change_w + by_damper_w;
    MechanicalEnergy {
        energy_j: kinetic_j + sum.potential_j(),
        kinetic_j,
        power_w,
    }
}
