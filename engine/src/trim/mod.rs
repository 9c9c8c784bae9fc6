//! Static equilibrium of a scene in its own wind: what it looks like, and bringing a simulation there.

mod report;
pub mod scene_file;
mod written_out;

use aerobot_systems::fault::Fault;
use bevy_ecs::world::World;
use glam::{DQuat, DVec3};

use crate::builtin::channels::find_supports;
use crate::evaluation::{Integration, with_integration};
use crate::placement;
use crate::scene::{Scene, SceneError, SetupError};
use crate::simulation::Simulation;
use crate::stopping::owner_name;

/// The steady state of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Trim {
    /// What tethers join, each with its own velocity, in the order of the scene.
    pub systems: Vec<TrimmedSystem>,
    /// Bodies and anchors, in the order of the scene.
    pub bodies: Vec<TrimmedBody>,
    /// Tethers, in the order of the scene.
    pub tethers: Vec<TrimmedTether>,
    /// What is left of the forces.
    pub residual: Residual,
    /// What was decided on the way, as sentences.
    pub notes: Vec<String>,
    /// What makes the state doubtful, as sentences.
    pub warnings: Vec<String>,
}

/// Bodies, tethers and anchors that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedSystem {
    /// Names of its anchors; none if it drifts.
    pub anchors: Vec<String>,
    /// Names of its bodies.
    pub bodies: Vec<String>,
    /// Names of its tethers.
    pub tethers: Vec<String>,
    /// The body whose horizontal place was held, if it drifts.
    pub reference: Option<String>,
    /// Velocity that all of it shares, inertial frame, m/s.
    pub velocity_m_s: DVec3,
    /// The wind at the reference body, m/s; zero where anchors hold the system.
    pub wind_at_reference_m_s: DVec3,
}

/// A body or an anchor in the steady state.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedBody {
    /// Its name.
    pub name: String,
    /// Whether it is an anchor.
    pub is_anchor: bool,
    /// Whether it has an attitude of its own: a point has none that matters.
    pub turns: bool,
    /// Position of the centre of mass, inertial frame, m.
    pub position_m: DVec3,
    /// Velocity, inertial frame, m/s.
    pub velocity_m_s: DVec3,
    /// Attitude, body to inertial.
    pub attitude: DQuat,
    /// Angle between its z axis and the vertical, rad.
    pub tilt_rad: f64,
    /// Angle from the inertial x axis to the horizontal part of its x axis, towards y, rad.
    pub heading_rad: f64,
}

/// A tether in the steady state.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedTether {
    /// Its name.
    pub name: String,
    /// The end from which segments count.
    pub from: TrimmedEnd,
    /// The other end.
    pub to: TrimmedEnd,
    /// Largest tension of a segment, N.
    pub largest_tension_n: f64,
    /// The segment that carries it, from 1 at `from`.
    pub largest_segment: usize,
    /// Twist of a tether that resists it, rad.
    pub twist_rad: Option<f64>,
    /// Velocity of its nodes, inertial frame, m/s.
    pub velocity_m_s: DVec3,
    /// Positions of its interior nodes from `from` to `to`, inertial frame, m.
    pub node_positions_m: Vec<DVec3>,
}

/// One end of a tether in the steady state.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedEnd {
    /// Name of what carries it.
    pub carrier: String,
    /// Where it is, inertial frame, m.
    pub position_m: DVec3,
    /// Force on the carrier, with the weight and drag of the half segment that stands there: what the
    /// channels `tension_from_n` and `tension_to_n` record, and the end of a continuous cable carries, N.
    pub force_n: f64,
    /// Tension of the end segment itself, N.
    pub tension_n: f64,
    /// Angle between the line of that force and the vertical, rad, in [0, pi/2]; of the end segment where
    /// there is no force.
    pub angle_from_vertical_rad: f64,
}

/// The largest things that remain unbalanced on bodies and nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Residual {
    /// Largest force, N.
    pub force_n: f64,
    /// The body or node where it remains.
    pub force_at: String,
    /// Largest acceleration, m/s^2.
    pub acceleration_m_s2: f64,
    /// The body or node that has it.
    pub acceleration_at: String,
    /// Largest angular acceleration, rad/s^2.
    pub angular_acceleration_rad_s2: f64,
    /// The body that has it; empty where nothing turns.
    pub angular_acceleration_at: String,
    /// Largest torque about a centre of mass, N m.
    pub torque_n_m: f64,
    /// Force that the round-off of positions makes of the stiffest segment, N: less than this cannot be
    /// asked for.
    pub round_off_n: f64,
}

impl Trim {
    /// The body or anchor of a name.
    #[must_use]
    pub fn body(&self, name: &str) -> Option<&TrimmedBody> {
        self.bodies.iter().find(|body| body.name == name)
    }

    /// The tether of a name.
    #[must_use]
    pub fn tether(&self, name: &str) -> Option<&TrimmedTether> {
        self.tethers.iter().find(|tether| tether.name == name)
    }
}

impl Simulation {
    /// Brings the simulation to its steady state in the scene's own wind, as it stands at the time of
    /// the simulation, from where it is: a system that anchors hold comes to rest against them, one that
    /// nothing holds drifts as a whole, each at its own velocity. A run from there moves nothing against
    /// its system until the wind changes.
    ///
    /// What nothing restores stays: heading, and the horizontal place of a drifting balloon (of its first
    /// body, if it has no balloon). The altitude of a drifting system follows from the density of the air;
    /// where that is uniform, the altitude stays too.
    ///
    /// # Errors
    /// Which entity finds no steady state, and why, rendered; the simulation is then as it was.
    pub fn trim(&mut self, scene: &Scene) -> Result<Trim, SceneError> {
        with_integration(&mut self.world, |world, integration| {
            let Integration {
                evaluation,
                statics,
                state,
                trajectory,
                ..
            } = integration;
            let forces = statics.as_mut().unwrap_or(evaluation);
            let systems = placement::settle(world, forces, scene)?;
            state.gather(world, &mut trajectory.state);
            trajectory.switch();
            state
                .scatter(world, &trajectory.state)
                .and_then(|()| evaluation.run(world))
                .map_err(|fault| not_evaluated(world, &fault))?;
            placement::accept_twists(world);
            find_supports(world);
            Ok(report::report(world, &systems))
        })
        .unwrap_or_else(|| Err(SetupError::new("", "the simulation is busy", "")))
        .map_err(|error| scene.refuse(error))
    }
}

fn not_evaluated(world: &World, fault: &Fault) -> SetupError {
    let name = fault.entity.and_then(|entity| owner_name(world, entity));
    let path = name
        .as_ref()
        .map_or_else(String::new, |name| format!("entities.{name}"));
    SetupError::new(path, fault.message.clone(), "")
}
