//! Bodies and anchors: their state, weight and equations of motion.

use aerobot_components::aerodynamics::{RadiusRule, Sphere, SphereRadius};
use aerobot_components::body::{Anchor, Body, Fixed, Motion, Moving, Pose};
use aerobot_components::derivatives::{ForceDerivatives, TorqueDerivatives};
use aerobot_components::scene_component::FieldReport;
use aerobot_components::state::{
    Acceleration, AddedInertia, AngularAcceleration, AngularVelocity, Attitude, ChartAttitude,
    Force, Inertia, Mass, Origin, Position, Torque, Velocity,
};
use aerobot_components::tether::Tether;
use aerobot_systems::dynamics::accumulators::{clear_accumulators, clear_derivatives};
use aerobot_systems::dynamics::anchors::{move_anchors, on_path};
use aerobot_systems::dynamics::rigid_body::{CarriedMass, accelerate_bodies};
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::forces::weight::weight;
use bevy_ecs::world::World;
use glam::{DQuat, DVec3};

use super::tethers::has_links;
use crate::balloon_sizing::sphere_radii;
use crate::plugin::{Plugin, Simulator};
use crate::scene::{Scene, SceneEntity, SetupError};
use crate::schedule::Phase;
use crate::world::{Free, SceneEntities};

/// Bodies and anchors: what they are and how they are weighed.
pub struct BodiesPlugin;

impl Plugin for BodiesPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .register_component::<Body>()
            .register_component::<Pose>()
            .register_component::<Motion>()
            .register_component::<Fixed>()
            .register_component::<Moving>()
            .add_check(check_inertia)
            .add_check(check_held)
            .add_setup(set_up)
            .add_systems(Phase::Prepare, || clear_accumulators)
            .add_systems_for::<Moving, _, _>(Phase::Prepare, || move_anchors)
            .add_systems(Phase::Forces, || weight)
            .add_systems(Phase::Derivatives, || clear_derivatives);
    }
}

/// The equations of motion of bodies, after everything that loads them.
pub struct MotionPlugin;

impl Plugin for MotionPlugin {
    fn build(&self, simulator: &mut Simulator) {
        let alone = |scene: &Scene, formulation| !has_links(scene, formulation);
        simulator.add_systems_in(Phase::Dynamics, alone, || accelerate_bodies);
    }
}

fn check_inertia(scene: &Scene, report: &mut FieldReport) {
    for (entity, body) in scene.with::<Body>() {
        if body.inertia.needs_sphere() && !entity.has::<Sphere>() {
            report.add(
                &format!("{}.inertia", entity.path::<Body>()),
                "the inertia of a sphere takes its radius from a `Sphere`, and there is none",
                "add `Sphere: (radius_m: ..)` to the entity, or name another shape",
            );
        }
    }
    for (entity, motion) in scene.with::<Motion>() {
        let is_point = entity.get::<Body>().is_some_and(|body| {
            matches!(
                body.inertia,
                aerobot_components::inertia::InertiaShape::Point
            )
        });
        if motion.rate_rad_s.length() > 0.0 && (is_point || entity.has::<Tether>()) {
            report.add(
                &format!("{}.rate_rad_s", entity.path::<Motion>()),
                "what has no inertia cannot turn",
                "give the body an `inertia`",
            );
        }
    }
}

/// What is held must be held somewhere, and at one place.
fn check_held(scene: &Scene, report: &mut FieldReport) {
    for (entity, fixed) in scene.with::<Fixed>() {
        let path = entity.path::<Fixed>();
        let has_pose = entity.has::<Pose>();
        if fixed.position_m.is_some() && has_pose {
            report.add(
                &path,
                "`Fixed` and `Pose` both say where the entity is",
                "leave `position_m` out of `Fixed`, or leave out the `Pose`",
            );
        } else if fixed.position_m.is_none() && !has_pose && floating_altitude_m(entity).is_none() {
            report.add(
                &path,
                "`Fixed` needs a place to be held at",
                "give `position_m`, or the entity a `Pose`",
            );
        }
    }
}

/// The altitude at which the scene wants the entity's sphere to float, m.
fn floating_altitude_m(entity: &SceneEntity) -> Option<f64> {
    entity
        .get::<Sphere>()?
        .radius
        .map(|RadiusRule::Equilibrium { altitude_m }| altitude_m)
}

/// Position (m) and attitude of a held entity.
fn held_at(entity: &SceneEntity, fixed: &Fixed, pose: Option<&Pose>) -> (DVec3, DQuat) {
    if let (None, Some(pose)) = (fixed.position_m, pose) {
        return (pose.position_m, pose.attitude.quaternion());
    }
    let floating = || DVec3::new(0.0, 0.0, floating_altitude_m(entity).unwrap_or(0.0));
    (
        fixed.position_m.unwrap_or_else(floating),
        fixed.attitude.quaternion(),
    )
}

/// State of every body and anchor. Poses that are not given follow when all forces are known.
fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let radii = sphere_radii(scene, &world.resource::<EnvironmentModel>().atmosphere)?;
    for entity in &scene.entities {
        let Some(id) = world.resource::<SceneEntities>().get(&entity.name) else {
            continue;
        };
        let radius_m = radii.get(&entity.name).copied();
        let mut spawned = world.entity_mut(id);
        if let Some(radius_m) = radius_m {
            spawned.insert(SphereRadius(radius_m));
        }
        let body = entity.get::<Body>();
        let fixed = entity.get::<Fixed>();
        let moving = entity.get::<Moving>();
        if body.is_none() && fixed.is_none() && moving.is_none() {
            continue;
        }
        let (position, attitude) = match (fixed, moving, entity.get::<Pose>()) {
            (Some(fixed), _, pose) => held_at(entity, fixed, pose),
            (None, Some(moving), _) => (on_path(moving, 0.0).0, DQuat::IDENTITY),
            (None, None, Some(pose)) => (pose.position_m, pose.attitude.quaternion()),
            (None, None, None) => Default::default(),
        };
        let (velocity, rate) = entity
            .get::<Motion>()
            .map_or_else(Default::default, |motion| {
                (motion.velocity_m_s, motion.rate_rad_s)
            });
        spawned.insert((
            Position(position),
            Origin(position),
            Velocity(velocity),
            Attitude(attitude),
            ChartAttitude(attitude),
            AngularVelocity(rate),
            Force::default(),
            Torque::default(),
            Acceleration::default(),
            AngularAcceleration::default(),
            CarriedMass::default(),
            AddedInertia::default(),
        ));
        if let Some(body) = body {
            spawned.insert(Mass(body.mass_kg));
            if let Some(tensor) = body.inertia.tensor(body.mass_kg, radius_m.unwrap_or(0.0)) {
                spawned.insert(Inertia(tensor));
            }
        }
        if fixed.is_some() || moving.is_some() {
            spawned.insert(Anchor);
        } else {
            spawned.insert((
                Free,
                ForceDerivatives::default(),
                TorqueDerivatives::default(),
            ));
        }
    }
    Ok(())
}
