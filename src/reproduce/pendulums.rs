//! Small motions of a body hung from a floating balloon, in closed form.

use std::f64::consts::TAU;

use aerobot_components::aerodynamics::{AddedMass, SphereRadius};
use aerobot_components::body::Body;
use aerobot_components::tether::{Attachment, Tether, TetherParts};
use aerobot_engine::scene::{Scene, SceneError};
use aerobot_engine::simulation::Simulation;
use aerobot_engine::world::SceneEntities;
use bevy_ecs::component::Component;
use glam::DVec3;

/// A balloon that floats, and a body below it on a ring of equal tethers, close to plumb. Massless tethers that do not
/// stretch; still air without drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HungPair {
    /// Mass of the balloon, kg.
    pub balloon_kg: f64,
    /// Mass of the air that moves with it, kg: half of what it displaces, which is all that it carries.
    pub added_kg: f64,
    /// Its radius, at whose lowest point the ring is, m.
    pub balloon_radius_m: f64,
    /// Moment of inertia of the balloon about any axis, kg m^2.
    pub balloon_moment_kg_m2: f64,
    /// Mass of the body, kg.
    pub body_kg: f64,
    /// Its moments of inertia across and about the vertical, kg m^2.
    pub body_moments_kg_m2: (f64, f64),
    /// Height of the ring on the body above its centre of mass, m.
    pub ring_height_m: f64,
    /// Distance of the ring's centre from the vertical through the centre of mass, m.
    pub ring_offset_m: f64,
    /// Radii of the ring at the balloon and at the body, m.
    pub ring_radii_m: (f64, f64),
    /// Length of the tethers, m.
    pub length_m: f64,
    /// Acceleration of gravity, m/s^2.
    pub gravity_m_s2: f64,
}

impl HungPair {
    /// Frequency of the swing, Hz: balloon, tethers and body turn as one about their common centre of mass, and weight
    /// and lift are a couple. With the distance l between the centres and the reduced mass mu of the masses that
    /// move,
    ///
    /// ```text
    /// omega^2 = m g l / (mu l^2 + I_balloon + I_body),  1/mu = 1/(M + m_a) + 1/m
    /// ```
    #[must_use]
    pub fn swing_hz(&self) -> f64 {
        let distance_m = self.balloon_radius_m + self.length_m + self.ring_height_m;
        let moving_kg = self.balloon_kg + self.added_kg;
        let reduced_kg = moving_kg * self.body_kg / (moving_kg + self.body_kg);
        let moment = reduced_kg * distance_m * distance_m
            + self.balloon_moment_kg_m2
            + self.body_moments_kg_m2.0;
        (self.weight_n() * distance_m / moment).sqrt() / TAU
    }

    /// Frequency of body against balloon about the vertical, Hz. The pulls divide so that they have no moment about the
    /// centre of mass, at c from the ring's centre; to hang plumb below the balloon's centre, all leans by
    /// c/R, which brings the centre of mass nearer by that times the height of the ring. Then
    ///
    /// ```text
    /// omega^2 = (m g/L) (a b - c^2) (1/I_balloon + 1/I_body)
    /// ```
    #[must_use]
    pub fn yaw_hz(&self) -> f64 {
        let leaning = 1.0 + self.ring_height_m / self.balloon_radius_m;
        let offset_m = self.ring_offset_m / leaning;
        let arms_m2 = self.ring_radii_m.0 * self.ring_radii_m.1 - offset_m * offset_m;
        let compliance = 1.0 / self.balloon_moment_kg_m2 + 1.0 / self.body_moments_kg_m2.1;
        (self.weight_n() / self.length_m * arms_m2 * compliance).sqrt() / TAU
    }

    fn weight_n(&self) -> f64 {
        self.body_kg * self.gravity_m_s2
    }

    /// The pair of a scene, `body` below `balloon` on the tethers that join them.
    ///
    /// # Errors
    /// A scene that has no such pair.
    pub fn of(
        scene: &Scene,
        simulation: &Simulation,
        balloon: &str,
        body: &str,
    ) -> Result<Self, SceneError> {
        let missing = |what: &str| {
            SceneError::plain(format_args!("the case needs {what} in `{}`", scene.name))
        };
        let of = |name: &str| {
            let entity = scene.entity(name);
            entity
                .and_then(|entity| entity.get::<Body>())
                .ok_or_else(|| missing(&format!("a `Body` of `{name}`")))
        };
        let (upper, lower) = (of(balloon)?, of(body)?);
        let radius_m = named::<SphereRadius>(simulation, balloon)
            .ok_or_else(|| missing(&format!("a `Sphere` of `{balloon}`")))?
            .0;
        let ring = Ring::between(scene, simulation, balloon, body)
            .ok_or_else(|| missing("tethers between balloon and body"))?;
        let has_added = scene
            .entity(balloon)
            .is_some_and(|entity| entity.get::<AddedMass>().is_some());
        let moments = |body: &Body, radius_m: f64| {
            let tensor = body.inertia.tensor(body.mass_kg, radius_m);
            tensor.map_or((f64::NAN, f64::NAN), |tensor| {
                (tensor.x_axis.x, tensor.z_axis.z)
            })
        };
        Ok(Self {
            balloon_kg: upper.mass_kg,
            added_kg: if has_added { 0.5 * mass_kg(scene) } else { 0.0 },
            balloon_radius_m: radius_m,
            balloon_moment_kg_m2: moments(upper, radius_m).0,
            body_kg: lower.mass_kg,
            body_moments_kg_m2: moments(lower, 0.0),
            ring_height_m: ring.lower_centre_m.z,
            ring_offset_m: ring.lower_centre_m.truncate().length(),
            ring_radii_m: ring.radii_m,
            length_m: ring.length_m,
            gravity_m_s2: scene.environment.gravity.acceleration_m_s2(0.0),
        })
    }
}

/// Frequency in Hz of a body that swings as a point of mass m on a line below a much heavier one, which floats or hangs
/// from what floats: omega^2 = (g/l)(1 + m/M), M all other mass, l from the upper end of the line to the centre of mass.
/// Nothing where no line joins them.
pub(super) fn hung_point_hz(
    scene: &Scene,
    simulation: &Simulation,
    upper: &str,
    lower: &str,
) -> Option<f64> {
    let ring = Ring::between(scene, simulation, upper, lower)?;
    let point_kg = scene.entity(lower)?.get::<Body>()?.mass_kg;
    let gravity = scene.environment.gravity.acceleration_m_s2(0.0);
    let length_m = ring.length_m + ring.lower_centre_m.z;
    let heavier = 1.0 + point_kg / (mass_kg(scene) - point_kg);
    Some((gravity / length_m * heavier).sqrt() / TAU)
}

/// Mass of all bodies and tethers, kg.
pub(super) fn mass_kg(scene: &Scene) -> f64 {
    let bodies: f64 = scene.with::<Body>().map(|(_, body)| body.mass_kg).sum();
    let tethers: f64 = scene
        .with::<Tether>()
        .map(|(_, tether)| tether.mass_kg())
        .sum();
    bodies + tethers
}

/// A component of a named entity.
fn named<'a, C: Component>(simulation: &'a Simulation, name: &str) -> Option<&'a C> {
    let world = simulation.world();
    world.get::<C>(world.resource::<SceneEntities>().get(name)?)
}

/// Where tethers are attached.
struct Ring {
    /// Centre of the attachments below, body frame, m.
    lower_centre_m: DVec3,
    /// Distances of the attachments from their centres, above and below, m.
    radii_m: (f64, f64),
    /// Length of the tethers, m.
    length_m: f64,
}

impl Ring {
    fn between(scene: &Scene, simulation: &Simulation, upper: &str, lower: &str) -> Option<Self> {
        let world = simulation.world();
        let (mut above, mut below) = (Vec::new(), Vec::new());
        let mut length_m = 0.0;
        for (entity, tether) in scene.with::<Tether>() {
            if tether.from.0 == upper && tether.to.0 == lower {
                let parts: &TetherParts = named(simulation, &entity.name)?;
                above.push(world.get::<Attachment>(*parts.points.first()?)?.offset_m);
                below.push(world.get::<Attachment>(*parts.points.last()?)?.offset_m);
                length_m = tether.length_m;
            }
        }
        let centre = |places: &[DVec3]| places.iter().sum::<DVec3>() / places.len() as f64;
        let radius = |places: &[DVec3]| places[0].distance(centre(places));
        (!below.is_empty()).then(|| Self {
            lower_centre_m: centre(&below),
            radii_m: (radius(&above), radius(&below)),
            length_m,
        })
    }
}
