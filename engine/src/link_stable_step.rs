//! The stable step of trees of links: the fastest of their transverse waves, of bodies turning about their
//! joints, of elastic links, and of what drag and dampers bring to rest, at the tensions of the start.

use aerobot_components::winch::Reeled;
use aerobot_systems::dynamics::state_space::StateSpace;
use aerobot_systems::integration::stability::largest_stable_step_s;
use aerobot_systems::linearised_motion::probed_motion::ProbedMotion;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use crate::builtin::recorder::segment_name;
use crate::linearisation::Linearisation;
use crate::stable_step::StableStep;
use crate::world::EntityName;

/// Shift of the matrix by which the motion of rigid links is probed, s: short against any of it.
const PROBE_S: f64 = 1e-6;
/// The same for elastic links, as a part of the stable step of their springs between point masses.
const PART_OF_SPRINGS: f64 = 1e-4;
/// A longer step than this, s, is limited by round-off of forces alone.
const NO_LIMIT_S: f64 = 1e5;

/// Finds the stable step with the linearised motion of a world whose last evaluation was of the state it is
/// in; `springs` is the stable step of its springs, if links are elastic.
pub(crate) fn find(
    world: &mut World,
    linearisation: &mut Linearisation,
    state: &mut dyn StateSpace,
    springs: Option<&StableStep>,
) -> StableStep {
    linearisation.linearise(world);
    let none = StableStep {
        step_s: f64::INFINITY,
        segment: String::new(),
    };
    let probe_s = springs.map_or(PROBE_S, |springs| PART_OF_SPRINGS * springs.step_s);
    if linearisation.factorise(probe_s, 1.0).is_err() {
        return none;
    }
    let mut solve = |r: &mut [f64]| linearisation.solve(r);
    let mut motion = ProbedMotion::new(&mut solve, state.layout(), probe_s);
    let (elastic, damped) = (motion.fastest_vibration(), motion.strongest_damper());
    let (lambda, gamma) = (elastic.0, damped.0);
    // The fastest vibration and the strongest damper may be of one mode or of two.
    let by_damper = largest_stable_step_s(0.0, gamma);
    let step_s = largest_stable_step_s(lambda, 0.0)
        .min(by_damper)
        .min(largest_stable_step_s(lambda, gamma));
    if step_s > NO_LIMIT_S {
        return none;
    }
    let place = if by_damper == step_s {
        damped.1
    } else {
        elastic.1
    };
    let part = state.owner(world, place);
    // At a winch an elastic link becomes shorter, and the node beyond it lighter, as in the step of springs.
    let shortest = springs.and_then(|_| shortest_part(world));
    let step_s = step_s * shortest.map_or(1.0, |part| part * 0.5 * (1.0 + part));
    StableStep {
        step_s,
        segment: part.map_or_else(String::new, |part| name_of(world, part)),
    }
}

/// The shortest that a segment at a winch becomes, as a part of a nominal one, if there is a winch.
fn shortest_part(world: &mut World) -> Option<f64> {
    let mut reeled = world.query::<&Reeled>();
    let parts = reeled.iter(world).map(|reeled| reeled.shortest_part);
    parts.min_by(f64::total_cmp)
}

/// The name of a body or node, or `tether/3` of a segment.
fn name_of(world: &World, part: Entity) -> String {
    if let Some(name) = world.get::<EntityName>(part) {
        return name.0.to_string();
    }
    let (tether, number) = segment_name(world, part);
    format!("{tether}/{number}")
}
