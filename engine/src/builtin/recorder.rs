//! Makes rows of what is due, and keeps the largest tension.

use std::sync::Arc;

use aerobot_components::run::{Cadence, InstrumentSelection};
use aerobot_components::sampling::Sampling;
use aerobot_components::segment::{Segment, SegmentGeometry, Tension};
use aerobot_components::state::{AngularVelocity, Attitude, Position, Velocity};
use aerobot_components::tether::TetherParts;
use aerobot_systems::clock::Clock;
use aerobot_systems::instruments::channel_log::ChannelLog;
use bevy_ecs::entity::Entity;
use bevy_ecs::resource::Resource;
use bevy_ecs::schedule::IntoScheduleConfigs;
use bevy_ecs::system::{IntoSystem, Query, Res, ResMut};
use bevy_ecs::world::World;

use crate::plugin::{Plugin, Simulator};
use crate::recording::frame::{ChannelRow, Frame, SegmentRow, StateRow};
use crate::scene::{Scene, SetupError};
use crate::schedule::Phase;
use crate::world::{EntityName, SceneEntities, SpawnOrder};

/// Recording.
pub struct RecorderPlugin;

impl Plugin for RecorderPlugin {
    fn build(&self, simulator: &mut Simulator) {
        simulator
            .add_setup(set_up)
            .add_systems(Phase::Record, || track_largest_tension)
            .add_systems(Phase::Record, || {
                record_states.pipe(record_segments).run_if(rows_due)
            })
            .add_systems(Phase::Record, || record_channels);
    }
}

/// What is recorded when, and the rows of the current time.
#[derive(Resource)]
pub struct Recorder {
    bodies: Option<Sampling>,
    nodes: Option<Sampling>,
    tethers: Option<Sampling>,
    channels: Option<Sampling>,
    instruments: InstrumentSelection,
    body_rows: Vec<(Arc<str>, Entity)>,
    node_rows: Vec<(Arc<str>, Entity)>,
    segment_rows: Vec<(Arc<str>, u32, Entity)>,
    end_s: f64,
    /// Rows of the current time.
    pub frame: Frame,
    /// A channel whose value was not finite, and its entity.
    pub not_finite: Option<(Arc<str>, &'static str)>,
    /// The largest tension so far (N), its time (s) and its segment as it was then.
    pub largest_tension: Option<(f64, f64, Segment)>,
}

impl Recorder {
    /// The next time at which something is due, s. A multiple of a period that misses the end of the
    /// run by round-off is the end.
    #[must_use]
    pub fn next_s(&self) -> f64 {
        let next_s = self.next_sample_s();
        let is_end = (next_s - self.end_s).abs() <= 1e-12 * self.end_s;
        if is_end { self.end_s } else { next_s }
    }

    fn next_sample_s(&self) -> f64 {
        [&self.bodies, &self.nodes, &self.tethers, &self.channels]
            .into_iter()
            .flatten()
            .map(Sampling::next_s)
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether built-in channels are due at `time_s`.
    #[must_use]
    pub fn channels_due(&self, time_s: f64) -> bool {
        is_due(&self.channels, time_s, self.end_s)
    }

    /// Moves on to what is due after `time_s`.
    pub fn done(&mut self, time_s: f64) {
        for sampling in [
            &mut self.bodies,
            &mut self.nodes,
            &mut self.tethers,
            &mut self.channels,
        ]
        .into_iter()
        .flatten()
        {
            sampling.done(time_s);
        }
    }
}

fn is_due(sampling: &Option<Sampling>, time_s: f64, end_s: f64) -> bool {
    sampling
        .as_ref()
        .is_some_and(|sampling| sampling.is_due(time_s) || time_s >= end_s)
}

fn set_up(world: &mut World, scene: &Scene) -> Result<(), SetupError> {
    let run = &scene.run;
    let sampling = |cadence: Cadence| match cadence {
        Cadence::Output => Some(Sampling::every(run.output_every_s)),
        Cadence::Every { period_s } => Some(Sampling::every(period_s)),
        Cadence::Never => None,
    };
    let recorder = Recorder {
        bodies: sampling(run.record.bodies),
        nodes: sampling(run.record.nodes),
        tethers: sampling(run.record.tethers),
        channels: sampling(run.record.channels_at),
        instruments: run.record.instruments.clone(),
        body_rows: Vec::new(),
        node_rows: Vec::new(),
        segment_rows: Vec::new(),
        end_s: run.duration_s,
        frame: Frame::default(),
        not_finite: None,
        largest_tension: None,
    };
    world.insert_resource(recorder);
    bind_rows(world);
    Ok(())
}

/// Finds which entities the rows of states and segments are of.
pub(crate) fn bind_rows(world: &mut World) {
    let (mut bodies, mut nodes, mut segments) = (Vec::new(), Vec::new(), Vec::new());
    for &entity in world.resource::<SceneEntities>().in_order() {
        let Some(EntityName(name)) = world.get(entity) else {
            continue;
        };
        if world.get::<Attitude>(entity).is_some() {
            bodies.push((name.clone(), entity));
        }
        let Some(parts) = world.get::<TetherParts>(entity) else {
            continue;
        };
        for point in &parts.points {
            if let Some(EntityName(node)) = world.get(*point) {
                nodes.push((node.clone(), *point));
            }
        }
        for (index, segment) in parts.segments.iter().enumerate() {
            segments.push((name.clone(), index as u32 + 1, *segment));
        }
    }
    let mut recorder = world.resource_mut::<Recorder>();
    recorder.body_rows = bodies;
    recorder.node_rows = nodes;
    recorder.segment_rows = segments;
}

fn track_largest_tension(
    clock: Res<Clock>,
    mut recorder: ResMut<Recorder>,
    segments: Query<(&Segment, &Tension)>,
) {
    let mut largest = recorder
        .largest_tension
        .map_or(f64::NEG_INFINITY, |found| found.0);
    for (segment, tension) in &segments {
        if tension.0 > largest {
            largest = tension.0;
            recorder.largest_tension = Some((tension.0, clock.time_s, *segment));
        }
    }
}

/// Whether states or segments are due at the time of the accepted state.
fn rows_due(clock: Res<Clock>, recorder: Res<Recorder>) -> bool {
    clock.time_s >= recorder.next_s().min(recorder.end_s)
}

fn record_states(
    clock: Res<Clock>,
    mut recorder: ResMut<Recorder>,
    states: Query<(&Position, &Velocity, Option<(&Attitude, &AngularVelocity)>)>,
) {
    let recorder = &mut *recorder;
    let time_s = clock.time_s;
    let bodies = is_due(&recorder.bodies, time_s, recorder.end_s);
    let nodes = is_due(&recorder.nodes, time_s, recorder.end_s);
    let rows = recorder
        .body_rows
        .iter()
        .filter(|_| bodies)
        .chain(recorder.node_rows.iter().filter(|_| nodes));
    for (name, entity) in rows {
        let Ok((position, velocity, rotation)) = states.get(*entity) else {
            continue;
        };
        recorder.frame.states.push(StateRow {
            entity: name.clone(),
            position_m: position.0,
            velocity_m_s: velocity.0,
            rotation: rotation.map(|(attitude, rate)| (attitude.0, rate.0)),
        });
    }
}

fn record_segments(
    clock: Res<Clock>,
    mut recorder: ResMut<Recorder>,
    segments: Query<(&Tension, &SegmentGeometry)>,
) {
    let recorder = &mut *recorder;
    if !is_due(&recorder.tethers, clock.time_s, recorder.end_s) {
        return;
    }
    for (tether, number, entity) in &recorder.segment_rows {
        let Ok((tension, geometry)) = segments.get(*entity) else {
            continue;
        };
        recorder.frame.segments.push(SegmentRow {
            tether: tether.clone(),
            segment: *number,
            tension_n: tension.0,
            length_m: geometry.length_m,
        });
    }
}

/// Rows of channels are sorted by entity and name, so that the order of systems is not in the file.
fn record_channels(
    mut recorder: ResMut<Recorder>,
    mut log: ResMut<ChannelLog>,
    names: Query<(&EntityName, &SpawnOrder)>,
) {
    if log.is_empty() {
        return;
    }
    let recorder = &mut *recorder;
    let mut rows: Vec<(usize, ChannelRow)> = Vec::new();
    for sample in log.drain() {
        let (order, entity) = match sample.entity {
            None => (usize::MAX, "system".into()),
            Some(entity) => match names.get(entity) {
                Ok((name, order)) => (order.0, name.0.clone()),
                Err(_) => continue,
            },
        };
        if !sample.value.is_finite() {
            recorder.not_finite.get_or_insert((entity, sample.channel));
            continue;
        }
        rows.push((
            order,
            ChannelRow {
                entity,
                channel: sample.channel,
                value: sample.value,
            },
        ));
    }
    rows.sort_by(|a, b| (a.0, a.1.channel).cmp(&(b.0, b.1.channel)));
    let wanted = |row: &ChannelRow| match &recorder.instruments {
        InstrumentSelection::All => true,
        InstrumentSelection::None => false,
        InstrumentSelection::Only(names) => names.iter().any(|name| **name == *row.entity),
    };
    let is_built_in = |row: &ChannelRow| super::channels::is_built_in(row.channel);
    let rows = rows.into_iter().map(|(_, row)| row);
    recorder
        .frame
        .channels
        .extend(rows.filter(|row| is_built_in(row) || wanted(row)));
}

/// Names of the tether and number of a segment, for summaries.
pub(crate) fn segment_name(world: &World, entity: Entity) -> (String, u32) {
    let Some(segment) = world.get::<Segment>(entity) else {
        return (String::new(), 0);
    };
    let tether = world
        .get::<EntityName>(segment.tether)
        .map_or("", |name| &name.0);
    (tether.to_owned(), segment.number)
}
