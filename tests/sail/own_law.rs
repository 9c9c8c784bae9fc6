//! A plugin with a law of its own.

use crate::STEP;
use crate::flight::{self, load};
use aerobot::engine::plugin::Simulator;

/// A law of one's own: full rudder to the one or the other side.
mod bang_bang {
    use aerobot::components::actuator::Command;
    use aerobot::components::sampling::Sampling;
    use aerobot::components::scene_component::SceneComponent;
    use aerobot::components::state::Position;
    use aerobot::engine::builtin::actuators::Actuators;
    use aerobot::engine::plugin::{Plugin, Simulator};
    use aerobot::engine::schedule::Phase;
    use aerobot::engine::world::SceneEntities;
    use aerobot::systems::clock::Clock;
    use bevy_ecs::component::Component;
    use bevy_ecs::entity::Entity;
    use bevy_ecs::system::{Query, Res};
    use serde::Deserialize;

    #[derive(Component, Clone, Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    pub(crate) struct BangBang {
        period_s: f64,
        rudder_rad: f64,
    }

    impl SceneComponent for BangBang {
        const NAME: &'static str = "BangBang";
    }

    #[derive(Component)]
    struct Steers {
        body: Entity,
        rudder: Entity,
    }

    pub(crate) struct BangBangPlugin;

    impl Plugin for BangBangPlugin {
        fn build(&self, simulator: &mut Simulator) {
            simulator
                .register_component::<BangBang>()
                .add_setup(|world, scene| {
                    for (entity, law) in scene.with::<BangBang>() {
                        let body = world.resource::<SceneEntities>().get(&entity.name);
                        let rudder = world.resource::<Actuators>().get(&entity.name, "rudder");
                        if let (Some(body), Some(rudder)) = (body, rudder) {
                            world.spawn((Steers { body, rudder }, Sampling::every(law.period_s)));
                        }
                    }
                    Ok(())
                })
                .add_systems_for::<BangBang, _, _>(Phase::Control, || steer);
        }
    }

    fn steer(
        clock: Res<Clock>,
        mut laws: Query<(&Steers, &mut Sampling)>,
        bodies: Query<(&BangBang, &Position)>,
        mut rudders: Query<&mut Command>,
    ) {
        for (steers, mut sampling) in &mut laws {
            if !sampling.is_due(clock.time_s) {
                continue;
            }
            sampling.done(clock.time_s);
            if let (Ok((law, position)), Ok(mut rudder)) =
                (bodies.get(steers.body), rudders.get_mut(steers.rudder))
            {
                rudder.0 = if position.0.y > 1.0 {
                    law.rudder_rad
                } else {
                    -law.rudder_rad
                };
            }
        }
    }
}

/// A plugin's law commands a rudder as the built-in laws do: sampled, held, within the limits, at once where there is
/// no lag.
#[test]
fn a_plugin_brings_its_own_law() {
    let mut simulator = Simulator::new();
    simulator.add_plugin(&bang_bang::BangBangPlugin);
    let start = STEP.find("\"helm\"").unwrap();
    let end = STEP.find("    },\n    run:").unwrap();
    let text = format!("{}{}", &STEP[..start], &STEP[end..]).replace(
        "        \"sail\": (\n",
        "        \"sail\": (\n            BangBang: (period_s: 2, rudder_rad: 0.5),\n",
    );
    let scene = load(
        &simulator,
        &text,
        &["run.duration_s=60", "run.output_every_s=0.5"],
    );
    let results = flight::run(&simulator, &scene);
    let rudder = results.channel("sail", "rudder_rad");
    let sail = results.positions("sail");
    let mut sides = [false; 2];
    for ((time_s, value), (_, position)) in rudder.iter().zip(&sail) {
        assert_eq!(value.abs(), if *time_s > 0.0 { 0.27 } else { value.abs() });
        sides[usize::from(*value > 0.0)] = true;
        // What a sample decided holds until the next.
        if *time_s > 0.0 && (time_s % 2.0) == 0.5 {
            let before = sail
                .iter()
                .find(|(at, _)| (*at - (time_s - 0.5)).abs() < 1e-9);
            assert_eq!(
                *value > 0.0,
                before.unwrap().1.y > 1.0,
                "{time_s} {}",
                position.y
            );
        }
    }
    assert!(sides[0] && sides[1]);
}
