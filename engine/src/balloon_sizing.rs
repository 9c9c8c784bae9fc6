//! The radius of every sphere of a scene, given or from the altitude at which it floats:
//! rho(z) 4/3 pi R^3 = the mass of everything that is tethered together with it.

use std::collections::BTreeMap;

use aerobot_components::aerodynamics::{RadiusRule, Sphere};
use aerobot_components::body::Body;
use aerobot_components::tether::Tether;
use aerobot_components::winch::Winch;
use aerobot_systems::environment::atmosphere::Atmosphere;

use crate::scene::{Scene, SetupError};

/// Radius in m of every sphere, by entity name.
///
/// # Errors
/// A sphere that cannot be sized: no air at its altitude, or two that would have to share a load.
pub fn sphere_radii(
    scene: &Scene,
    atmosphere: &Atmosphere,
) -> Result<BTreeMap<String, f64>, SetupError> {
    let mut radii = BTreeMap::new();
    for (entity, sphere) in scene.with::<Sphere>() {
        let path = format!("{}.radius", entity.path::<Sphere>());
        let radius_m = match (sphere.radius_m, sphere.radius) {
            (Some(radius_m), _) => radius_m,
            (None, Some(RadiusRule::Equilibrium { altitude_m })) => {
                check_alone(scene, &entity.name, &path)?;
                let mass_kg = tethered_mass_kg(scene, &entity.name);
                let density = atmosphere
                    .density_kg_m3(altitude_m)
                    .map_err(|outside| SetupError::new(&path, outside.to_string(), ""))?;
                if density <= 0.0 {
                    return Err(SetupError::new(
                        &path,
                        "no balloon floats where there is no air",
                        "give `radius_m`, or an atmosphere with a density",
                    ));
                }
                libm::cbrt(3.0 * mass_kg / (4.0 * std::f64::consts::PI * density))
            }
            (None, None) => continue,
        };
        radii.insert(entity.name.clone(), radius_m);
    }
    Ok(radii)
}

/// Two spheres sized by equilibrium on one tethered system would have to share its weight.
fn check_alone(scene: &Scene, name: &str, path: &str) -> Result<(), SetupError> {
    let together = tethered_together(scene, name);
    let other = scene
        .with::<Sphere>()
        .find(|(other, sphere)| {
            other.name != name && sphere.radius.is_some() && together.contains(&other.name.as_str())
        })
        .map(|(other, _)| other.name.clone());
    match other {
        None => Ok(()),
        Some(other) => Err(SetupError::new(
            path,
            format!("`{name}` and `{other}` cannot both take their radius from one load"),
            "give one of them its `radius_m`",
        )),
    }
}

/// Mass of everything tethered together with the entity `name`, itself included, kg.
#[must_use]
pub fn tethered_mass_kg(scene: &Scene, name: &str) -> f64 {
    let together = tethered_together(scene, name);
    let bodies: f64 = scene
        .with::<Body>()
        .filter(|(entity, _)| together.contains(&entity.name.as_str()))
        .map(|(_, body)| body.mass_kg)
        .sum();
    let tethers: f64 = scene
        .with::<Tether>()
        .filter(|(_, tether)| together.contains(&tether.from.0.as_str()))
        .map(|(entity, tether)| {
            let stored_m = entity.get::<Winch>().map_or(0.0, |winch| winch.stored_m);
            tether.lumped_mass_kg() + stored_m * tether.mass_kg() / tether.length_m
        })
        .sum();
    bodies + tethers
}

/// Names of the bodies and anchors that tethers join with the entity `name`, itself included.
#[must_use]
pub fn tethered_together<'a>(scene: &'a Scene, name: &'a str) -> Vec<&'a str> {
    let mut found = vec![name];
    let mut next = 0;
    while next < found.len() {
        let here = found[next];
        next += 1;
        for (_, tether) in scene.with::<Tether>() {
            let (from, to) = (tether.from.0.as_str(), tether.to.0.as_str());
            for (end, other) in [(from, to), (to, from)] {
                if end == here && !found.contains(&other) {
                    found.push(other);
                }
            }
        }
    }
    found
}
