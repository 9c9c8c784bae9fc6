//! The shift in altitude at which a free system's buoyancy carries its weight, whatever its shape:
//! sum rho(z_i + s) V_i g(z_i + s) = sum m_j g(z_j + s). Where the motion through the air pushes up or
//! down as well, that is where the search for equilibrium begins.

use aerobot_components::aerodynamics::DisplacedVolume;
use aerobot_components::state::{Mass, Position};
use aerobot_components::tether::TetherParts;
use aerobot_systems::environment::EnvironmentModel;
use bevy_ecs::world::World;

use super::tethered_system::{TetheredSystem, refused};
use crate::scene::SetupError;

/// Altitudes between which a balloon is looked for, m, where the air has no bounds.
const LOWEST_M: f64 = -5_000.0;
const HIGHEST_M: f64 = 200_000.0;
/// A lift this near to the weight, as a part of it, needs no shift.
const BALANCED: f64 = 1e-6;

/// Masses (kg) and volumes (m^3) of a system with their altitudes (m).
struct Loads {
    masses: Vec<(f64, f64)>,
    volumes: Vec<(f64, f64)>,
}

impl Loads {
    fn of(world: &World, system: &TetheredSystem) -> Self {
        let ends = system.tethers.iter().flat_map(|tether| {
            let parts = world.get::<TetherParts>(*tether);
            parts.map_or(&[][..], |parts| &parts.points)
        });
        let heights = |entity| world.get::<Position>(entity).map(|position| position.0.z);
        let masses = system.bodies.iter().chain(ends);
        let volumes = system.bodies.iter();
        Self {
            masses: masses
                .filter_map(|id| Some((world.get::<Mass>(*id)?.0, heights(*id)?)))
                .collect(),
            volumes: volumes
                .filter_map(|id| Some((world.get::<DisplacedVolume>(*id)?.0, heights(*id)?)))
                .collect(),
        }
    }

    fn weight_n(&self, environment: &EnvironmentModel, shift_m: f64) -> f64 {
        let weight = |(mass_kg, z_m): &(f64, f64)| {
            mass_kg * environment.gravity.acceleration_m_s2(z_m + shift_m)
        };
        self.masses.iter().map(weight).sum()
    }

    /// Lift, N; not a number outside the air.
    fn lift_n(&self, environment: &EnvironmentModel, shift_m: f64) -> f64 {
        let lift = |(volume_m3, z_m): &(f64, f64)| {
            let density = environment.atmosphere.density_kg_m3(z_m + shift_m);
            density.unwrap_or(f64::NAN)
                * volume_m3
                * environment.gravity.acceleration_m_s2(z_m + shift_m)
        };
        self.volumes.iter().map(lift).sum()
    }

    /// The shifts at which all of it stays within the air, m.
    fn shifts_m(&self, environment: &EnvironmentModel) -> (f64, f64) {
        let (lowest_m, highest_m) = environment.atmosphere.bounds_m();
        let heights = || self.volumes.iter().map(|(_, z_m)| *z_m);
        (
            lowest_m.max(LOWEST_M) - heights().fold(f64::INFINITY, f64::min),
            highest_m.min(HIGHEST_M) - heights().fold(f64::NEG_INFINITY, f64::max),
        )
    }
}

/// The shift in m that brings a free system to where its buoyancy carries it.
///
/// # Errors
/// No altitude does.
pub(super) fn shift_m(world: &World, system: &TetheredSystem) -> Result<f64, SetupError> {
    let environment = world.resource::<EnvironmentModel>();
    let loads = Loads::of(world, system);
    let weight_n = loads.weight_n(environment, 0.0);
    let lift_n = loads.lift_n(environment, 0.0);
    if (lift_n - weight_n).abs() <= BALANCED * weight_n {
        return Ok(0.0);
    }
    let Some(reference) = system.reference else {
        return Ok(0.0);
    };
    if loads.volumes.is_empty() || lift_n == 0.0 {
        return Err(refused(
            world,
            reference,
            "",
            &format!("falls: nothing carries its weight of {weight_n:.6} N"),
            "tether it to an anchor, or give it a balloon with `Buoyancy`",
        ));
    }
    let excess =
        |shift_m| loads.lift_n(environment, shift_m) - loads.weight_n(environment, shift_m);
    let (lowest_m, highest_m) = loads.shifts_m(environment);
    let (mut low, mut high) = if lift_n > weight_n {
        (0.0, highest_m)
    } else {
        (lowest_m, 0.0)
    };
    if !(excess(low) > 0.0 && excess(high) < 0.0) {
        let all = if system.tethers.is_empty() {
            "it weighs"
        } else {
            "it and all that is tethered to it weigh"
        };
        return Err(refused(
            world,
            reference,
            "",
            &format!(
                "floats at no altitude: its lift at the start is {lift_n:.6} N, and {all} \
                 {weight_n:.6} N"
            ),
            "change the load or the radius, or size the balloon with `radius: \
             Equilibrium(altitude_m: ..)`",
        ));
    }
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}
