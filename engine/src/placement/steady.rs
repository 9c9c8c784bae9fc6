//! The steady state of a scene in its own wind: every system that tethers join at rest against its
//! anchors, or drifting as a whole.

use aerobot_components::body::Moving;
use aerobot_components::state::{Acceleration, AngularAcceleration, StateIndex, Velocity};
use aerobot_systems::clock::Clock;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::environment::wind::Wind;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::With;
use bevy_ecs::world::World;
use glam::DVec3;

use super::drift::{Drift, FreeSystem, NoDrift, set_motion};
use super::equilibrium::{
    NO_EQUILIBRIUM_HELP, OUTSIDE_HELP, fault_on_the_way, no_equilibrium, solve_shape,
};
use super::snapshot::Snapshot;
use super::stability::{self, Instability};
use super::tethered_system::{self, TetheredSystem, anchor_velocity_m_s};
use super::{Unplaced, guess, nodes, take_as_origin};
use crate::evaluation::Evaluation;
use crate::scene::{Scene, SetupError};

/// A wind that cannot be brought up in parts as small as this has no rest.
const SMALLEST_PART_OF_WIND: f64 = 1e-3;

/// A system in its steady state.
pub(crate) struct SteadySystem {
    /// What belongs to it.
    pub(crate) system: TetheredSystem,
    /// The velocity that all of it shares, m/s.
    pub(crate) velocity_m_s: DVec3,
    /// A motion along which it would leave that state by itself.
    pub(crate) instability: Option<Instability>,
    /// Change of the vertical force with altitude, N/m, of a system whose altitude was found.
    pub(crate) vertical_slope_n_m: Option<f64>,
}

/// Brings every system of the scene to its steady state in the wind of the present, from where it
/// stands.
///
/// The wind, and the speed of anchors, are brought up in parts: a part that Newton's method cannot follow
/// is halved.
///
/// # Errors
/// Which entity finds no steady state, and why; then everything is as it was.
pub(crate) fn settle(
    world: &mut World,
    evaluation: &mut Evaluation,
    scene: &Scene,
) -> Result<Vec<SteadySystem>, SetupError> {
    let before = Snapshot::of(world);
    let wind = world.resource::<EnvironmentModel>().wind.clone();
    let systems = tethered_system::find(world, scene);
    let settled: Result<Vec<_>, SetupError> = systems
        .into_iter()
        .map(|system| {
            let mut ascent = Ascent {
                wind: &wind,
                world,
                evaluation,
                system: &system,
            };
            ascent.settle()
        })
        .collect();
    let settled = settled.and_then(|settled| check_finite(world, evaluation).map(|()| settled));
    if settled.is_ok() {
        take_as_origin(world);
    } else {
        before.restore(world);
        // What was there could be evaluated when it was built.
        let _ = evaluation.run(world);
    }
    settled.map_err(for_a_steady_state)
}

/// Everything that would be integrated must have a speed and an acceleration that are numbers.
fn check_finite(world: &mut World, evaluation: &mut Evaluation) -> Result<(), SetupError> {
    evaluation
        .run(world)
        .map_err(|fault| fault_on_the_way(world, &fault))?;
    let mut moving = world.query_filtered::<(
        Entity,
        &Velocity,
        &Acceleration,
        Option<&AngularAcceleration>,
    ), With<StateIndex>>();
    let beyond = moving
        .iter(world)
        .find(|(_, velocity, linear, angular)| {
            let sizes = [velocity.0, linear.0, angular.map_or(DVec3::ZERO, |a| a.0)];
            !sizes.iter().all(|size| size.length().is_finite())
        })
        .map(|(entity, ..)| entity);
    let reason = "its speed or its acceleration is beyond what can be reckoned with";
    match beyond {
        None => Ok(()),
        beyond => Err(no_equilibrium(world, beyond, reason)),
    }
}

/// What does not settle is no failure of the scene's start: its remedies are others.
fn for_a_steady_state(mut error: SetupError) -> SetupError {
    for violation in &mut error.0 {
        let help = violation.help.as_deref();
        if help == Some(OUTSIDE_HELP) || help == Some(NO_EQUILIBRIUM_HELP) {
            violation.help = Some(
                "this wind may leave it no steady state; if it does, a nearer start helps: trim in a \
                 weaker wind, and go on from there"
                    .to_owned(),
            );
        }
    }
    error
}

/// One system on its way into the wind.
struct Ascent<'a> {
    wind: &'a Wind,
    world: &'a mut World,
    evaluation: &'a mut Evaluation,
    system: &'a TetheredSystem,
}

/// A part of the way that was reached.
#[derive(Default)]
struct Reached {
    part: f64,
    drift: Option<Drift>,
    vertical_slope_n_m: Option<f64>,
}

impl Ascent<'_> {
    /// From where it stands; failing that, from where it would hang plumb, the wind brought up in parts;
    /// failing that too, so from where it stands.
    fn settle(&mut self) -> Result<SteadySystem, SetupError> {
        let anchored_m_s = anchor_velocity_m_s(self.world, self.system)?;
        let unplaced = Unplaced {
            bodies: self.system.bodies.clone(),
            floating: self.system.reference.into_iter().collect(),
            tethers: Some(self.system.tethers.clone()),
        };
        let start = Snapshot::of(self.world);
        let mut outcome = self.at_part(&unplaced, anchored_m_s, 1.0, &Reached::default());
        for plumb in [true, false] {
            if outcome.as_ref().is_ok() || outcome.as_ref().is_err_and(|error| error.is_certain) {
                break;
            }
            start.restore(self.world);
            if plumb {
                self.hang_plumb();
            }
            // Of two failures, that of the better guess is told.
            let again = self.bring_up(&unplaced, anchored_m_s);
            if plumb || again.is_ok() {
                outcome = again;
            }
        }
        let reached = outcome.map_err(|failure| failure.error)?;
        let velocity_m_s = match reached.drift {
            Some(drift) => self.free_system(&unplaced)?.velocity_m_s(drift)?,
            None => anchored_m_s,
        };
        Ok(SteadySystem {
            system: self.system.clone(),
            velocity_m_s,
            instability: stability::find(self.world, self.evaluation, &unplaced),
            vertical_slope_n_m: reached.vertical_slope_n_m,
        })
    }

    /// A guess that forgets the poses of the scene, but for the place of a floating reference body and the
    /// headings.
    fn hang_plumb(&mut self) {
        guess::hang_anew(self.world, &self.system.bodies, self.system.reference);
        for tether in &self.system.tethers {
            nodes::place_sagging(self.world, *tether);
        }
    }

    fn bring_up(&mut self, unplaced: &Unplaced, anchored_m_s: DVec3) -> Result<Reached, NoDrift> {
        let mut reached = Reached::default();
        let mut part = 1.0_f64;
        while reached.part < 1.0 {
            let target = (reached.part + part).min(1.0);
            let before = Snapshot::of(self.world);
            match self.at_part(unplaced, anchored_m_s, target, &reached) {
                Ok(now) => {
                    reached = now;
                    part *= 2.0;
                }
                Err(failure) if failure.is_certain || part < SMALLEST_PART_OF_WIND => {
                    return Err(failure);
                }
                Err(_) => {
                    before.restore(self.world);
                    part *= 0.5;
                }
            }
        }
        Ok(reached)
    }

    /// The steady state in a part of the wind, from that in the part reached before.
    fn at_part(
        &mut self,
        unplaced: &Unplaced,
        anchored_m_s: DVec3,
        part: f64,
        reached: &Reached,
    ) -> Result<Reached, NoDrift> {
        self.world.resource_mut::<EnvironmentModel>().wind = self.wind.scaled(part);
        let paths = self.slow_down_anchors(part);
        let result = if self.system.reference.is_some() {
            self.drift_from(unplaced, part, reached)
        } else {
            set_motion(self.world, self.system, part * anchored_m_s);
            let solved = solve_shape(self.world, self.evaluation, unplaced);
            solved.map_err(NoDrift::from).map(|()| Reached {
                part,
                ..Reached::default()
            })
        };
        self.world.resource_mut::<EnvironmentModel>().wind = self.wind.clone();
        for (anchor, path) in paths {
            self.world.entity_mut(anchor).insert(path);
        }
        result
    }

    fn drift_from(
        &mut self,
        unplaced: &Unplaced,
        part: f64,
        reached: &Reached,
    ) -> Result<Reached, NoDrift> {
        let mut free = self.free_system(unplaced)?;
        let begin = free.begin()?;
        let begin = match reached.drift {
            // All velocities of a steady state grow together while its shape stays.
            Some(drift) => Drift {
                against_air_m_s: drift.against_air_m_s * (part / reached.part),
                altitude_m: drift.altitude_m,
            },
            None => free.drift_of_shape(begin)?,
        };
        let (drift, vertical_slope_n_m) = free.solve(begin)?;
        Ok(Reached {
            part,
            drift: Some(drift),
            vertical_slope_n_m,
        })
    }

    fn free_system<'b>(&'b mut self, unplaced: &'b Unplaced) -> Result<FreeSystem<'b>, SetupError> {
        let Some(reference) = self.system.reference else {
            return Err(SetupError::new("entities", "nothing of it is free", ""));
        };
        Ok(FreeSystem {
            world: self.world,
            evaluation: self.evaluation,
            system: self.system,
            unplaced,
            reference,
        })
    }

    /// Takes a part of the speed of moving anchors, with their places as they are; gives their own paths.
    fn slow_down_anchors(&mut self, part: f64) -> Vec<(Entity, Moving)> {
        let time_s = self.world.resource::<Clock>().time_s;
        let mut paths = Vec::new();
        for anchor in &self.system.anchors {
            let Some(mut path) = self.world.get_mut::<Moving>(*anchor) else {
                continue;
            };
            paths.push((*anchor, path.clone()));
            let velocity_m_s = path.velocity_m_s;
            path.position_m += (1.0 - part) * time_s * velocity_m_s;
            path.velocity_m_s = part * velocity_m_s;
        }
        paths
    }
}
