//! The fastest transverse vibration of a taut chain of rods: what limits an explicit step where nothing
//! stretches.

use aerobot_components::segment::Tension;
use aerobot_components::tether::{Tether, TetherParts};
use aerobot_engine::simulation::Simulation;
use aerobot_engine::world::SceneEntities;

/// Frequency in rad/s of the fastest transverse mode of `links` equal rods in a row, held at both ends,
/// under a tension; nothing for a single one.
///
/// With link length l and mass m the joints have the stiffness T/l tridiag(-1, 2, -1) and the mass
/// m/6 tridiag(1, 4, 1), hence omega^2 = 6 T/(m l) (1 - cos a)/(2 + cos a) with a = pi (1 - 1/links).
pub(super) fn fastest_transverse_rad_s(
    tension_n: f64,
    mass_kg: f64,
    length_m: f64,
    links: u32,
) -> f64 {
    let count = f64::from(links);
    let (link_mass_kg, link_length_m) = (mass_kg / count, length_m / count);
    let cosine = libm::cos(std::f64::consts::PI * (1.0 - 1.0 / count));
    let shape = (1.0 - cosine) / (2.0 + cosine);
    (6.0 * tension_n / (link_mass_kg * link_length_m) * shape).sqrt()
}

/// The same of the tether of a simulation at its start, by the mean tension of its segments.
pub(super) fn of_tether(simulation: &Simulation, name: &str, tether: &Tether) -> Option<f64> {
    let world = simulation.world();
    let parts = world.get::<TetherParts>(world.resource::<SceneEntities>().get(name)?)?;
    let tensions = parts
        .segments
        .iter()
        .filter_map(|segment| world.get::<Tension>(*segment));
    let mean_n = tensions.map(|tension| tension.0).sum::<f64>() / f64::from(tether.segments());
    Some(fastest_transverse_rad_s(
        mean_n,
        tether.mass_kg(),
        tether.length_m,
        tether.segments(),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rods with one joint between walls: 2 T/l on m 2/3.
    #[test]
    fn one_joint_has_its_closed_form() {
        let found = fastest_transverse_rad_s(900.0, 3.0, 10.0, 2);
        let expected = (2.0 * 900.0 / 5.0 / (1.5 * 2.0 / 3.0_f64)).sqrt();
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }

    #[test]
    fn many_links_vibrate_in_proportion_to_their_number() {
        let at = |links| fastest_transverse_rad_s(900.0, 4.0, 1000.0, links);
        assert!((at(2000) / at(1000) - 2.0).abs() < 1e-5);
        // Twelve where neighbours move against each other.
        let expected = (12.0 * 900.0 * 1e6 / 4000.0_f64).sqrt();
        assert!((at(1000) / expected - 1.0).abs() < 1e-5);
    }
}
