//! Loops that controllers close, about the steady state: each with its own law, linear where nothing is cut, while
//! the commands of others are held.

use aerobot_components::actuator::Actuator;
use aerobot_components::control::{BoundController, Controller, Law, Measurement, QuantityKind};
use aerobot_systems::fault::Fault;
use aerobot_systems::modes::dense_motion::DenseMotion;
use aerobot_systems::modes::sampled_loop::{LinearLaw, Margins, SampledLoop};
use aerobot_systems::modes::{Complex, Matrix};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::sites::{Site, SiteMotion, Sites};
use crate::builtin::actuators::Actuators;
use crate::scene::Scene;
use crate::world::SceneEntities;

/// Modes slower than this are those that nothing restores, 1/s.
const NOTHING_PER_S: f64 = 1e-5;

/// A loop that a controller closes.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedLoop {
    /// Name of the controller's entity.
    pub controller: String,
    /// Name of the actuator: `sail.rudder`.
    pub actuator: String,
    /// Period of the controller, s.
    pub period_s: f64,
    /// Growth (1/s) and angular frequency (rad/s) of its modes, slowest first; without what nothing restores.
    pub modes: Vec<(f64, f64)>,
    /// Its margins, broken at the command.
    pub margins: Margins,
}

impl ClosedLoop {
    /// Whether every motion in it dies out.
    #[must_use]
    pub fn is_stable(&self) -> bool {
        self.modes.iter().all(|(growth, _)| *growth < 0.0)
    }
}

/// What the loops of a scene are found from.
pub(super) struct OpenLoop<'a> {
    pub(super) world: &'a World,
    pub(super) scene: &'a Scene,
    pub(super) sites: &'a Sites,
    /// The linearised motion.
    pub(super) motion: &'a DenseMotion,
    /// The first-order states in it.
    pub(super) first_order: &'a [Entity],
    /// Of each coordinate the motion of all sites.
    pub(super) displaced: &'a [Vec<SiteMotion>],
}

/// Whether a scene has loops.
pub(super) fn has_loops(scene: &Scene) -> bool {
    scene.with::<Controller>().next().is_some()
}

/// The motions of all sites for each of so many coordinates.
pub(super) fn of_each_coordinate(
    coordinates: usize,
    mut motions: impl FnMut(&[Complex<f64>]) -> Result<Vec<SiteMotion>, Fault>,
) -> Result<Vec<Vec<SiteMotion>>, Fault> {
    (0..coordinates)
        .map(|k| {
            let mut along = vec![Complex::from(0.0); coordinates];
            along[k] = Complex::from(1.0);
            motions(&along)
        })
        .collect()
}

impl OpenLoop<'_> {
    /// All loops; and why some are not found, as sentences.
    pub(super) fn close(&self) -> (Vec<ClosedLoop>, Vec<String>) {
        let (mut loops, mut notes) = (Vec::new(), Vec::new());
        for (entity, controller) in self.scene.with::<Controller>() {
            let id = self.world.resource::<SceneEntities>().get(&entity.name);
            let Some(bound) = id.and_then(|id| self.world.get::<BoundController>(id)) else {
                continue;
            };
            let names = self.world.get_resource::<Actuators>();
            let name = names.and_then(|names| names.name(bound.actuator));
            let actuator = name.unwrap_or_default();
            let Some(command) = self.command_column(bound.actuator) else {
                notes.push(format!(
                    "the loop of `{}` is not closed here: `{actuator}` moves nothing that modes know, or has no lag (a rudder: give `lag_s`)",
                    entity.name
                ));
                continue;
            };
            let broken = SampledLoop::new(
                &self.state_matrix(),
                &command,
                &self.measured_rows(&bound.measurements),
                &linear_law(controller),
                controller.period_s,
            );
            let modes = broken
                .closed()
                .into_iter()
                .map(|value| (value.re, value.im));
            loops.push(ClosedLoop {
                controller: entity.name.clone(),
                actuator,
                period_s: controller.period_s,
                modes: modes
                    .filter(|(growth, turn)| growth.hypot(*turn) > NOTHING_PER_S)
                    .collect(),
                margins: broken.margins(),
            });
        }
        (loops, notes)
    }

    /// A of x' = A x with the state (displacements, velocities, first-order states).
    fn state_matrix(&self) -> Matrix {
        let motion = self.motion;
        let (n, m) = (motion.mass.nrows(), motion.first_order.nrows());
        let mut a = Matrix::zeros(2 * n + m, 2 * n + m);
        a.view_mut((0, n), (n, n)).fill_with_identity();
        let mass = motion.mass.clone().lu();
        for (matrix, sign, column) in [
            (&motion.stiffness, -1.0, 0),
            (&motion.damping, -1.0, n),
            (&motion.by_first_order, 1.0, 2 * n),
        ] {
            // What has no inertia was refused when the scene was read.
            if let Some(solved) = mass.solve(matrix) {
                a.view_mut((n, column), (n, matrix.ncols()))
                    .copy_from(&(solved * sign));
            }
        }
        for (matrix, column) in [
            (&motion.first_order_by_displacement, 0),
            (&motion.first_order_by_velocity, n),
            (&motion.first_order, 2 * n),
        ] {
            a.view_mut((2 * n, column), (m, matrix.ncols()))
                .copy_from(matrix);
        }
        a
    }

    /// What a command does to the rates: d' = (u - d)/lag.
    fn command_column(&self, actuator: Entity) -> Option<Matrix> {
        let place = self
            .first_order
            .iter()
            .position(|other| *other == actuator)?;
        let lag_s = self.world.get::<Actuator>(actuator)?.limits.lag_s;
        let (n, m) = (self.motion.mass.nrows(), self.first_order.len());
        let mut column = Matrix::zeros(2 * n + m, 1);
        column[(2 * n + place, 0)] = 1.0 / lag_s;
        Some(column)
    }

    /// How measured quantities change with the state, a row each.
    fn measured_rows(&self, measurements: &[Measurement]) -> Matrix {
        let (n, m) = (self.motion.mass.nrows(), self.first_order.len());
        let mut rows = Matrix::zeros(measurements.len(), 2 * n + m);
        for (row, measurement) in measurements.iter().enumerate() {
            for (sign, kind, entity) in &measurement.parts {
                // An anchor is not moved.
                let Some(index) = self.sites.index.get(entity).copied() else {
                    continue;
                };
                for (k, motions) in self.displaced.iter().enumerate() {
                    let (value, is_rate) = change(*kind, &self.sites.all[index], &motions[index]);
                    rows[(row, if is_rate { n + k } else { k })] += sign * value;
                }
            }
        }
        rows
    }
}

/// How a quantity changes with a motion of its site; whether that is with its velocity.
fn change(kind: QuantityKind, site: &Site, motion: &SiteMotion) -> (f64, bool) {
    let linear = motion.linear.real;
    let turned = || {
        let bow = site.attitude * DVec3::X;
        let turning = site.attitude * motion.angular.real.cross(DVec3::X);
        let across = bow.truncate().length_squared();
        (bow.x * turning.y - bow.y * turning.x) / across.max(f64::MIN_POSITIVE)
    };
    match kind {
        QuantityKind::X => (linear.x, false),
        QuantityKind::Y => (linear.y, false),
        QuantityKind::Altitude => (linear.z, false),
        QuantityKind::VelocityX => (linear.x, true),
        QuantityKind::VelocityY => (linear.y, true),
        QuantityKind::VelocityZ => (linear.z, true),
        QuantityKind::Heading => (turned(), false),
        QuantityKind::HeadingRate => (turned(), true),
    }
}

/// The law where nothing is cut.
fn linear_law(controller: &Controller) -> LinearLaw {
    let stateless = |gains: &[f64]| LinearLaw {
        state: Matrix::zeros(0, 0),
        by_error: Matrix::zeros(0, gains.len()),
        command_by_state: Matrix::zeros(1, 0),
        command_by_error: Matrix::from_row_slice(1, gains.len(), gains),
    };
    match &controller.law {
        Law::Proportional { gain, .. } => stateless(&[*gain]),
        Law::StateFeedback { terms, .. } => {
            let gains: Vec<f64> = terms.iter().map(|term| term.gain).collect();
            stateless(&gains)
        }
        Law::Pid {
            proportional,
            integral_per_s,
            derivative_s,
            filter_s,
            ..
        } => {
            // States: integral part, derivative part and error of the last sample.
            let period_s = controller.period_s;
            let kept = filter_s / (filter_s + period_s);
            let by_change = derivative_s / (filter_s + period_s);
            LinearLaw {
                state: Matrix::from_row_slice(
                    3,
                    3,
                    &[1.0, 0.0, 0.0, 0.0, kept, -by_change, 0.0, 0.0, 0.0],
                ),
                by_error: Matrix::from_column_slice(
                    3,
                    1,
                    &[integral_per_s * period_s, by_change, 1.0],
                ),
                command_by_state: Matrix::from_row_slice(1, 3, &[1.0, kept, -by_change]),
                command_by_error: Matrix::from_element(1, 1, proportional + by_change),
            }
        }
    }
}
