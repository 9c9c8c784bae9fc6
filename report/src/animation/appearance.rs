//! What entities look like: solids to scale, from the components that give them dimensions.
//!
//! What a scene says nothing of (a point, a tensor) is a small cube or ball; [`Part::to_scale`] says so.

use aerobot_components::aerodynamics::Sphere;
use aerobot_components::body::{Body, Fixed, Moving};
use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::inertia::InertiaShape;
use aerobot_components::rotorcraft::Rotorcraft;
use aerobot_components::sail::{LiftingSurface, Sail};
use aerobot_engine::geometry::Geometry;
use aerobot_engine::scene::SceneEntity;
use glam::DVec3;
use serde::Serialize;

/// Edge of what has no dimensions, m.
const UNKNOWN_M: f64 = 0.4;
/// Thickness of wings over their chord.
const THICKNESS: f64 = 0.06;

/// A solid, centred on its place, its axes those of the body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Solid {
    /// A sphere.
    Sphere {
        /// Radius, m.
        radius_m: f64,
    },
    /// A box.
    Box {
        /// Edges along x, y, z, m.
        size_m: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius, m.
        radius_m: f64,
        /// Height, m.
        height_m: f64,
    },
}

/// What a part is, for its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// An envelope that displaces air.
    Balloon,
    /// A body: gondola, probe, instrument.
    Body,
    /// A wing of a sail.
    Sail,
    /// A drone.
    Drone,
    /// What is fixed or follows a path.
    Anchor,
}

/// A solid of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Its shape.
    pub solid: Solid,
    /// Its centre from the centre of mass, body frame, m.
    pub at_m: [f64; 3],
    /// What it is.
    pub role: Role,
    /// Whether its dimensions are those of the scene, and not a stand-in.
    pub to_scale: bool,
}

/// The solids of an entity.
#[must_use]
pub fn parts(entity: &SceneEntity, geometry: &Geometry) -> Vec<Part> {
    let mut parts = Vec::new();
    let mut add = |solid, at_m: DVec3, role| {
        parts.push(Part {
            solid,
            at_m: at_m.to_array(),
            role,
            to_scale: true,
        });
    };
    if let Some(drone) = entity.get::<FixedWing>() {
        aeroplane(drone, &mut add);
    } else if let Some(drone) = entity.get::<Rotorcraft>() {
        multicopter(drone, &mut add);
    } else if let Some(radius_m) = geometry.sphere_radius_m.get(&entity.name) {
        let floats =
            entity.has::<Sphere>() && entity.has::<aerobot_components::aerodynamics::Buoyancy>();
        let role = if floats { Role::Balloon } else { Role::Body };
        let radius_m = *radius_m;
        add(Solid::Sphere { radius_m }, DVec3::ZERO, role);
    } else if let Some(solid) = entity.get::<Body>().and_then(|body| solid(&body.inertia)) {
        add(solid, DVec3::ZERO, Role::Body);
    }
    if let Some(sail) = entity.get::<Sail>() {
        let shape = sail.shape();
        let rudder_ratio = sail.rudder.aspect_ratio.unwrap_or(sail.wing.aspect_ratio);
        for (surface, ratio) in [
            (shape.wing, sail.wing.aspect_ratio),
            (shape.rudder, rudder_ratio),
        ] {
            add(upright_wing(&surface, ratio), surface.centre_m, Role::Sail);
        }
    }
    if parts.is_empty() {
        let is_anchor = entity.has::<Fixed>() || entity.has::<Moving>();
        parts.push(Part {
            solid: Solid::Box {
                size_m: [UNKNOWN_M; 3],
            },
            at_m: [0.0; 3],
            role: if is_anchor { Role::Anchor } else { Role::Body },
            to_scale: false,
        });
    }
    parts
}

/// The solid of a body with this inertia; nothing for a point or a tensor.
fn solid(inertia: &InertiaShape) -> Option<Solid> {
    match *inertia {
        InertiaShape::Box(x, y, z) => Some(Solid::Box { size_m: [x, y, z] }),
        InertiaShape::SolidCylinder { radius_m, height_m } => {
            Some(Solid::Cylinder { radius_m, height_m })
        }
        InertiaShape::HollowCylinder {
            outer_radius_m,
            height_m,
            ..
        } => Some(Solid::Cylinder {
            radius_m: outer_radius_m,
            height_m,
        }),
        InertiaShape::Rod { length_m } => Some(Solid::Cylinder {
            radius_m: 0.02 * length_m,
            height_m: length_m,
        }),
        _ => None,
    }
}

/// A wing whose span is upright, as that of a sail: S = b c, AR = b / c.
fn upright_wing(surface: &LiftingSurface, aspect_ratio: f64) -> Solid {
    let span_m = libm::sqrt(surface.area_m2 * aspect_ratio);
    let chord_m = span_m / aspect_ratio;
    Solid::Box {
        size_m: [chord_m, THICKNESS * chord_m, span_m],
    }
}

fn aeroplane(drone: &FixedWing, add: &mut impl FnMut(Solid, DVec3, Role)) {
    let geometry = drone.aircraft.coefficients().geometry;
    let (span_m, chord_m) = (geometry.span_m, geometry.chord_m);
    let mut part = |size_m: [f64; 3], at_m: DVec3| add(Solid::Box { size_m }, at_m, Role::Drone);
    part([chord_m, span_m, THICKNESS * chord_m], DVec3::ZERO);
    part(
        [0.6 * span_m, 0.07 * span_m, 0.07 * span_m],
        DVec3::new(-0.05 * span_m, 0.0, 0.0),
    );
    let tail = DVec3::new(-0.35 * span_m, 0.0, 0.0);
    part([0.5 * chord_m, 0.3 * span_m, THICKNESS * chord_m], tail);
    let fin = tail + DVec3::new(0.0, 0.0, 0.06 * span_m);
    part([0.5 * chord_m, THICKNESS * chord_m, 0.14 * span_m], fin);
}

/// Rotors on a circle that leaves a tenth of their diameter between neighbours, about a body within it.
fn multicopter(drone: &Rotorcraft, add: &mut impl FnMut(Solid, DVec3, Role)) {
    let radius_m = 0.5 * drone.rotor_diameter_m;
    let pi = std::f64::consts::PI;
    let circle_m = match drone.rotors {
        0 | 1 => 0.0,
        count => 1.1 * radius_m / libm::sin(pi / f64::from(count)),
    };
    let body_m = if circle_m > 0.0 { circle_m } else { radius_m };
    let size_m = [body_m, body_m, 0.3 * body_m];
    add(Solid::Box { size_m }, DVec3::ZERO, Role::Drone);
    for index in 0..drone.rotors {
        let angle = 2.0 * pi * (f64::from(index) + 0.5) / f64::from(drone.rotors);
        let at_m = DVec3::new(
            circle_m * libm::cos(angle),
            circle_m * libm::sin(angle),
            0.2 * body_m,
        );
        let height_m = 0.05 * radius_m;
        add(Solid::Cylinder { radius_m, height_m }, at_m, Role::Drone);
    }
}
