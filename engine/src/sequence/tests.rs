//! Whatever runs the systems, they leave the same.

use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::{
    IntoScheduleConfigs, LogLevel, ScheduleBuildSettings, ScheduleLabel, SystemSet,
};
use bevy_ecs::system::{Commands, Local, Res, ResMut};

use super::*;

#[derive(ScheduleLabel, Clone, Debug, PartialEq, Eq, Hash)]
struct Label;

#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
struct Late;

/// What has run.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
struct Log(Vec<&'static str>);

#[derive(Resource)]
struct Made;

fn first(mut log: ResMut<Log>) {
    log.0.push("first");
}

fn second(mut log: ResMut<Log>) {
    log.0.push("second");
}

fn third(mut log: ResMut<Log>) {
    log.0.push("third");
}

fn exclusive(world: &mut World) {
    world.resource_mut::<Log>().0.push("exclusive");
}

fn make(mut commands: Commands) {
    commands.insert_resource(Made);
}

fn every_other_time(mut count: Local<u32>) -> bool {
    *count += 1;
    *count % 2 == 1
}

fn has_made(made: Option<Res<Made>>) -> bool {
    made.is_some()
}

fn schedule() -> Schedule {
    let mut schedule = Schedule::new(Label);
    schedule.set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..ScheduleBuildSettings::default()
    });
    schedule
}

/// Three runs as a sequence and by the executor: the log of both, and whether the first was direct.
fn both(assemble: impl Fn() -> Schedule) -> (bool, Log) {
    let mut world = World::new();
    world.init_resource::<Log>();
    let mut sequence = Sequence::new(&assemble, &mut world).unwrap();
    let mut expected = World::new();
    expected.init_resource::<Log>();
    let mut executor = assemble();
    for _ in 0..3 {
        sequence.run(&mut world);
        executor.run(&mut expected);
    }
    let log = world.resource::<Log>().clone();
    assert_eq!(log, *expected.resource::<Log>());
    (sequence.is_direct(), log)
}

#[test]
fn systems_run_in_the_order_of_the_schedule() {
    let (direct, log) = both(|| {
        let mut schedule = schedule();
        schedule.configure_sets(Late.after(first));
        schedule.add_systems((third, second.before(third), exclusive.after(third)).in_set(Late));
        schedule.add_systems(first);
        schedule
    });
    assert!(direct);
    assert_eq!(log.0[..4], ["first", "second", "third", "exclusive"]);
}

#[test]
fn a_condition_of_a_system_holds() {
    let (direct, log) = both(|| {
        let mut schedule = schedule();
        schedule.add_systems((first, second.run_if(every_other_time), third).chain());
        schedule
    });
    assert!(direct);
    let expected = ["first", "second", "third", "first", "third"];
    assert_eq!(log.0[..5], expected);
}

#[test]
fn a_condition_in_common_is_asked_once() {
    let (direct, log) = both(|| {
        let mut schedule = schedule();
        let pair = (second, third).chain();
        schedule.add_systems((first, pair.run_if(every_other_time)).chain());
        schedule
    });
    assert!(!direct);
    assert_eq!(log.0[..4], ["first", "second", "third", "first"]);
}

#[test]
fn commands_are_applied_before_what_comes_after() {
    let (direct, log) = both(|| {
        let mut schedule = schedule();
        schedule.add_systems((make, first.run_if(has_made)).chain());
        schedule
    });
    assert!(!direct);
    assert_eq!(log.0, ["first"; 3]);
    let (direct, _) = both(|| {
        let mut schedule = schedule();
        schedule.add_systems(make);
        schedule
    });
    assert!(!direct);
}

#[test]
fn an_ambiguity_is_an_error() {
    let mut world = World::new();
    world.init_resource::<Log>();
    let assemble = || {
        let mut schedule = schedule();
        schedule.add_systems((first, second));
        schedule
    };
    let error = Sequence::new(assemble, &mut world).err().unwrap();
    assert!(
        error.contains("first") && error.contains("second"),
        "{error}"
    );
}

#[test]
fn a_known_order_is_used_again_in_another_world() {
    let orders = Orders::default();
    let of = |registrations: &[usize]| OrderOf {
        registrations: registrations.to_vec(),
        shuffle_seed: None,
    };
    let assemble = || {
        let mut schedule = schedule();
        schedule.add_systems((third.after(second), exclusive, first.after(exclusive)));
        schedule.add_systems(second.after(first).run_if(every_other_time));
        schedule
    };
    let mut logs = Vec::new();
    for _ in 0..2 {
        let mut world = World::new();
        world.init_resource::<Log>();
        let sequence = orders.sequence(of(&[1]), assemble, &mut world);
        let mut sequence = sequence.expect("it can be ordered");
        assert!(sequence.is_direct());
        sequence.run(&mut world);
        sequence.run(&mut world);
        logs.push(world.resource::<Log>().clone());
    }
    assert_eq!(logs[0].0.len(), 7);
    assert_eq!(logs[0], logs[1]);

    // Other systems under the same name are ordered anew.
    let mut world = World::new();
    world.init_resource::<Log>();
    let others = || {
        let mut schedule = schedule();
        schedule.add_systems((second, first).chain());
        schedule
    };
    let sequence = orders.sequence(of(&[1]), others, &mut world);
    sequence.expect("it can be ordered").run(&mut world);
    assert_eq!(world.resource::<Log>().0, ["second", "first"]);
}
