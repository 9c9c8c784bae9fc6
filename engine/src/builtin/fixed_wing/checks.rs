//! What must hold between a drone and the rest of its scene.

use aerobot_components::body::{AttitudeSpec, Body, Fixed, Moving, Pose};
use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::inertia::InertiaShape;
use aerobot_components::scene_component::FieldReport;
use aerobot_components::tether::Tether;

use crate::scene::Scene;
use crate::scene::checks::meant;

/// The body of a drone turns, and what it is to follow is there.
pub(super) fn check(scene: &Scene, report: &mut FieldReport) {
    for (entity, drone) in scene.with::<FixedWing>() {
        let is_point = |body: &Body| matches!(body.inertia, InertiaShape::Point);
        if entity.get::<Body>().is_some_and(is_point) {
            report.add(
                &entity.path::<Body>(),
                "a fixed-wing drone needs an inertia, and this body is a point",
                "the Aerosonde has `inertia: Tensor(xx_kg_m2: 0.8244, yy_kg_m2: 1.135, zz_kg_m2: 1.759, \
                 xz_kg_m2: 0.1204)`",
            );
        }
        let has_attitude = |pose: &Pose| pose.attitude != AttitudeSpec::Upright;
        if entity.get::<Pose>().is_some_and(has_attitude) {
            report.add(
                &format!("{}.attitude", entity.path::<Pose>()),
                "a fixed-wing drone starts in the attitude of its trim",
                "leave it out; airspeed and course stand in `FixedWing.start`",
            );
        }
        let is_held = |tether: &Tether| tether.from.0 == entity.name || tether.to.0 == entity.name;
        if let Some((tether, _)) = scene.with::<Tether>().find(|(_, tether)| is_held(tether)) {
            report.add(
                &tether.path::<Tether>(),
                format!(
                    "`{}` is a fixed-wing drone, and its trim knows no tether",
                    entity.name
                ),
                "tie the tether to another body",
            );
        }
        let Some((field, name)) = drone.guidance.names() else {
            continue;
        };
        let path = format!("{}.guidance.{field}", entity.path::<FixedWing>());
        let moves = scene
            .entities
            .iter()
            .filter(|found| found.has::<Body>() || found.has::<Fixed>() || found.has::<Moving>());
        match scene.entity(name) {
            _ if name == entity.name => {
                report.add(&path, "a drone cannot follow itself", "");
            }
            Some(found) if !found.complete => {}
            Some(found) if found.has::<Body>() || found.has::<Fixed>() || found.has::<Moving>() => {
            }
            Some(_) => report.add(
                &path,
                format!("`{name}` is neither a body nor an anchor"),
                "",
            ),
            None if scene.may_be_unread(name) => {}
            None => report.add(
                &path,
                format!("there is no entity `{name}`"),
                meant(name, moves),
            ),
        }
    }
}
