//! The steady drift of a system that nothing fixes: the velocity along the horizontal, common to all of
//! it, and the altitude at which no force remains on its reference body while all else is in
//! equilibrium.
//!
//! ```text
//! R(u, z) = force on the reference body = sum of the outer forces on the system
//! v       = (W_x(z) + u_x, W_y(z) + u_y, 0)
//! ```
//!
//! z altitude of the reference body (m), W wind (m/s), v the drift (m/s) and u its part against the air
//! at the reference body: in uniform wind u = 0, whatever the altitude. R = 0 is solved by Newton's
//! method with differences, halving steps that do not help; the shape is solved anew for every R, from
//! the one before. Where the air is the same at all altitudes, z is held.

use aerobot_components::state::{AngularVelocity, Force, Position, Velocity};
use aerobot_systems::environment::EnvironmentModel;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::{DMat2, DMat3, DVec2, DVec3};

use super::equilibrium::{Scales, fault_on_the_way, solve_shape};
use super::snapshot::Snapshot;
use super::tethered_system::{
    TetheredSystem, is_air_uniform, refused, uniform_vertical_velocity_m_s,
};
use super::{Unplaced, buoyant_altitude};
use crate::evaluation::Evaluation;
use crate::scene::SetupError;

/// Newton iterations at most.
const MOST_ITERATIONS: usize = 30;
/// Halvings of a step before it counts as useless.
const HALVINGS: usize = 10;
/// Longest step in altitude, m, and in velocity, m/s.
const LONGEST_STEP: DVec3 = DVec3::new(20.0, 20.0, 1000.0);
/// Difference in altitude, m: far below a scale height, far above round-off.
const ALTITUDE_DIFFERENCE_M: f64 = 1.0;
/// Difference in velocity, as a part of the differences of wind within the system.
const VELOCITY_DIFFERENCE: f64 = 1e-3;
/// Slope of the horizontal force, in parts of the weight per m/s, below which nothing steers the drift:
/// in air that moves as the system does, drag begins with the square.
const LEAST_SLOPE: f64 = 1e-7;
/// Iterations, and the force as a part of all weight that may remain, for a guess.
const SHAPE_ITERATIONS: usize = 10;
const SHAPE_TOLERANCE: f64 = 1e-6;
/// The force that may remain, as a part of all weight, beside what round-off explains.
const TOLERANCE: f64 = 1e-10;

/// The unknowns: the drift against the air at the reference body, m/s, and its altitude, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    pub(super) against_air_m_s: DVec2,
    pub(super) altitude_m: f64,
}

/// Why there is no steady drift, or no steady state at all.
#[derive(Debug)]
pub(super) struct NoDrift {
    pub(super) error: SetupError,
    /// Whether no other guess, and no smaller step, can help.
    pub(super) is_certain: bool,
}

impl From<SetupError> for NoDrift {
    fn from(error: SetupError) -> Self {
        Self {
            error,
            is_certain: false,
        }
    }
}

impl NoDrift {
    fn certain(error: SetupError) -> Self {
        Self {
            error,
            is_certain: true,
        }
    }
}

impl Drift {
    fn moved(self, step: DVec3) -> Self {
        Self {
            against_air_m_s: self.against_air_m_s + step.truncate(),
            altitude_m: self.altitude_m + step.z,
        }
    }
}

/// One free system, with what solving it takes.
pub(super) struct FreeSystem<'a> {
    pub(super) world: &'a mut World,
    pub(super) evaluation: &'a mut Evaluation,
    pub(super) system: &'a TetheredSystem,
    pub(super) unplaced: &'a Unplaced,
    pub(super) reference: Entity,
}

/// Which unknowns there are, and how large a force is none.
struct Goal {
    /// 1 for a component that is balanced by its unknown, 0 for one that is held.
    free: DVec3,
    force_n: f64,
    /// Round-off of an altitude, seen through the stiffest spring, N.
    vertical_noise_n: f64,
}

impl Goal {
    /// The size of a force: what is balanced, and of the vertical what round-off does not explain.
    fn size_n(&self, force_n: DVec3) -> f64 {
        let vertical = (force_n.z.abs() - self.vertical_noise_n).max(0.0);
        (DVec3::new(force_n.x, force_n.y, vertical) * self.free).length()
    }

    fn tolerance_n(&self) -> f64 {
        TOLERANCE * self.force_n + 2.0 * self.vertical_noise_n
    }
}

impl FreeSystem<'_> {
    /// Where the search begins: drifting with the air, where buoyancy carries the weight.
    pub(super) fn begin(&self) -> Result<Drift, NoDrift> {
        let mut altitude_m = self.altitude_m();
        let environment = self.world.resource::<EnvironmentModel>();
        if !is_air_uniform(environment) {
            match buoyant_altitude::shift_m(self.world, self.system) {
                Ok(shift_m) => altitude_m += shift_m,
                // An updraft may carry what buoyancy does not.
                Err(error) if self.wind_m_s(altitude_m)?.z == 0.0 => {
                    return Err(NoDrift::certain(error));
                }
                Err(_) => {}
            }
        }
        Ok(Drift {
            against_air_m_s: DVec2::ZERO,
            altitude_m,
        })
    }

    /// The drift at which the shape as it stands is pushed nowhere along the horizontal, from `here`: a
    /// far better beginning in shear than the wind at the reference body, and cheap.
    pub(super) fn drift_of_shape(&mut self, mut here: Drift) -> Result<Drift, SetupError> {
        let environment = self.world.resource::<EnvironmentModel>();
        if !environment.wind.depends_on_altitude() {
            return Ok(here);
        }
        let force_n = Scales::of(self.world).force_n;
        let step = VELOCITY_DIFFERENCE * self.wind_spread_m_s(here)?;
        let mut push = self.push_on_shape(here)?;
        for _ in 0..SHAPE_ITERATIONS {
            if push.length() <= SHAPE_TOLERANCE * force_n {
                break;
            }
            let mut slope = |axis: DVec2| -> Result<DVec2, SetupError> {
                let there = self.push_on_shape(here.moved((step * axis).extend(0.0)))?;
                Ok((there - push) / step - LEAST_SLOPE * force_n * axis)
            };
            let slopes = DMat2::from_cols(slope(DVec2::X)?, slope(DVec2::Y)?);
            let next = here.moved(-(slopes.inverse() * push).extend(0.0));
            let next_push = self.push_on_shape(next)?;
            if !next_push.is_finite() || next_push.length() >= push.length() {
                break;
            }
            (here, push) = (next, next_push);
        }
        Ok(here)
    }

    /// Sum of the horizontal forces on all of the system in a drift, its shape as it stands, N.
    fn push_on_shape(&mut self, drift: Drift) -> Result<DVec2, SetupError> {
        self.place(drift)?;
        self.evaluation
            .run(self.world)
            .map_err(|fault| fault_on_the_way(self.world, &fault))?;
        let parts = self.system.bodies.iter().chain(&self.system.nodes);
        let forces = parts.filter_map(|part| self.world.get::<Force>(*part));
        Ok(forces.map(|force| force.0.truncate()).sum())
    }

    /// Brings the system to its steady drift from `begin`; gives that with the slope of the vertical
    /// force over altitude, N/m, if the altitude was free.
    pub(super) fn solve(&mut self, begin: Drift) -> Result<(Drift, Option<f64>), NoDrift> {
        let mut here = begin;
        self.velocity_m_s(here).map_err(NoDrift::certain)?;
        let mut force = self.settle(here)?;
        let goal = self.goal(force);
        let mut slope_n_m = None;
        let mut stalled = false;
        for _ in 0..MOST_ITERATIONS {
            let size = goal.size_n(force);
            if size <= 1e-15 * goal.force_n || (stalled && size <= goal.tolerance_n()) {
                break;
            }
            let jacobian = self.jacobian(here, force, &goal)?;
            slope_n_m = (goal.free.z > 0.0).then_some(jacobian.z_axis.z);
            let Some((next, next_force)) = self.step(here, force, &jacobian, &goal)? else {
                break;
            };
            stalled = goal.size_n(next_force) > 0.5 * size;
            (here, force) = (next, next_force);
        }
        self.check(force, &goal)?;
        if slope_n_m.is_none() && goal.free.z > 0.0 {
            slope_n_m = Some(self.jacobian(here, force, &goal)?.z_axis.z);
        }
        self.settle(here)?;
        Ok((here, slope_n_m))
    }

    /// The velocity of a drift, m/s.
    pub(super) fn velocity_m_s(&self, drift: Drift) -> Result<DVec3, SetupError> {
        let wind_m_s = self.wind_m_s(drift.altitude_m)?;
        let horizontal = wind_m_s.truncate() + drift.against_air_m_s;
        let vertical = if is_air_uniform(self.world.resource::<EnvironmentModel>()) {
            uniform_vertical_velocity_m_s(self.world, self.system, wind_m_s)?
        } else {
            0.0
        };
        Ok(horizontal.extend(vertical))
    }

    fn altitude_m(&self) -> f64 {
        let position = self.world.get::<Position>(self.reference);
        position.map_or(0.0, |position| position.0.z)
    }

    fn wind_m_s(&self, altitude_m: f64) -> Result<DVec3, SetupError> {
        let wind = &self.world.resource::<EnvironmentModel>().wind;
        wind.velocity_m_s(altitude_m).map_err(|outside| {
            let reason = format!("would drift where no wind is known: {outside}");
            refused(self.world, self.reference, "", &reason, "")
        })
    }

    fn goal(&mut self, force: DVec3) -> Goal {
        let scales = Scales::of(self.world);
        let environment = self.world.resource::<EnvironmentModel>();
        let tolerance_n = TOLERANCE * scales.force_n;
        // In air that moves as one there is nothing to steer by, and nothing to steer.
        let steers =
            environment.wind.depends_on_altitude() || force.truncate().length() > tolerance_n;
        let rises = !is_air_uniform(environment);
        Goal {
            free: DVec3::new(f64::from(steers), f64::from(steers), f64::from(rises)),
            force_n: scales.force_n,
            vertical_noise_n: scales.position_noise_n,
        }
    }

    /// Puts the system into a drift as it is.
    fn place(&mut self, drift: Drift) -> Result<(), SetupError> {
        let velocity_m_s = self.velocity_m_s(drift)?;
        let shift_m = drift.altitude_m - self.altitude_m();
        set_motion(self.world, self.system, velocity_m_s);
        let parts = self.system.bodies.iter().chain(&self.system.nodes);
        for part in parts.filter(|_| shift_m != 0.0) {
            if let Some(mut position) = self.world.get_mut::<Position>(*part) {
                position.0.z += shift_m;
            }
        }
        if let Some(mut position) = self.world.get_mut::<Position>(self.reference) {
            position.0.z = drift.altitude_m;
        }
        Ok(())
    }

    /// Puts the system into a drift, lets its shape settle, and gives the force that holds it there, N.
    fn settle(&mut self, drift: Drift) -> Result<DVec3, SetupError> {
        self.place(drift)?;
        solve_shape(self.world, self.evaluation, self.unplaced)?;
        self.evaluation
            .run(self.world)
            .map_err(|fault| fault_on_the_way(self.world, &fault))?;
        let force = self.world.get::<Force>(self.reference);
        Ok(force.map_or(DVec3::ZERO, |force| force.0))
    }

    /// Change of the force with the unknowns, N s/m and N/m; the identity where one is held.
    fn jacobian(&mut self, here: Drift, force: DVec3, goal: &Goal) -> Result<DMat3, SetupError> {
        let velocity_step = VELOCITY_DIFFERENCE * self.wind_spread_m_s(here)?;
        let steps = DVec3::new(velocity_step, velocity_step, ALTITUDE_DIFFERENCE_M);
        let mut jacobian = DMat3::IDENTITY;
        for axis in 0..3 {
            if goal.free[axis] == 0.0 {
                continue;
            }
            let step = DVec3::AXES[axis] * steps[axis];
            // At the edge of the air one side will do.
            let (there, length) = match self.settle(here.moved(step)) {
                Ok(there) => (there, steps[axis]),
                Err(_) => (self.settle(here.moved(-step))?, -steps[axis]),
            };
            let mut column = goal.free * (there - force) / length;
            if axis < 2 {
                column[axis] -= LEAST_SLOPE * goal.force_n;
            }
            *jacobian.col_mut(axis) = column;
        }
        Ok(jacobian)
    }

    /// The largest difference of wind between the reference body and the rest, m/s, with the motion
    /// against the air; never quite zero.
    fn wind_spread_m_s(&self, here: Drift) -> Result<f64, SetupError> {
        let at_reference_m_s = self.wind_m_s(here.altitude_m)?;
        let wind = &self.world.resource::<EnvironmentModel>().wind;
        let parts = self.system.bodies.iter().chain(&self.system.nodes);
        let spread = parts
            .filter_map(|part| self.world.get::<Position>(*part))
            .filter_map(|position| wind.velocity_m_s(position.0.z).ok())
            .map(|wind_m_s| (wind_m_s - at_reference_m_s).length())
            .fold(1e-3, f64::max);
        Ok(spread + here.against_air_m_s.length())
    }

    /// One Newton step, halved until it helps; nothing if no part of it does.
    fn step(
        &mut self,
        here: Drift,
        force: DVec3,
        jacobian: &DMat3,
        goal: &Goal,
    ) -> Result<Option<(Drift, DVec3)>, SetupError> {
        let step = -(jacobian.inverse() * (force * goal.free));
        if !step.is_finite() {
            return Ok(None);
        }
        let step = step / (step.abs() / LONGEST_STEP).max_element().max(1.0);
        let before = Snapshot::of(self.world);
        let mut fraction = 1.0;
        let mut failure = None;
        for _ in 0..=HALVINGS {
            let there = here.moved(fraction * step);
            match self.settle(there) {
                Ok(next) if goal.size_n(next) < (1.0 - 1e-4 * fraction) * goal.size_n(force) => {
                    return Ok(Some((there, next)));
                }
                Ok(_) => failure = None,
                Err(error) => failure = Some(error),
            }
            before.restore(self.world);
            fraction *= 0.5;
        }
        failure.map_or(Ok(None), Err)
    }

    /// Nothing that an unknown could have balanced may remain, and nothing along a vertical that is held.
    fn check(&self, force: DVec3, goal: &Goal) -> Result<(), NoDrift> {
        if goal.free.z == 0.0 && force.z.abs() > goal.tolerance_n() {
            return Err(NoDrift::certain(self.unbalanced(force.z)));
        }
        if goal.size_n(force) > goal.tolerance_n() {
            let reason = format!(
                "finds no steady drift: a force of {:.3e} N remains on it",
                (force * goal.free).length()
            );
            let help = "start it nearer to where it floats, or hold it with `Fixed: ()`";
            return Err(refused(self.world, self.reference, "", &reason, help).into());
        }
        Ok(())
    }

    fn unbalanced(&self, vertical_n: f64) -> SetupError {
        match buoyant_altitude::shift_m(self.world, self.system) {
            Err(error) if vertical_n < 0.0 => return error,
            _ => {}
        }
        let size = if vertical_n.abs() >= 1e-3 {
            format!("{vertical_n:.6} N")
        } else {
            format!("{vertical_n:.3e} N")
        };
        refused(
            self.world,
            self.reference,
            "",
            &format!(
                "finds no equilibrium: {size} remain along the vertical, and no altitude changes that in \
                 air of uniform density"
            ),
            "size the balloon with `radius: Equilibrium(altitude_m: ..)`, or give the air a density that \
             falls with altitude",
        )
    }
}

/// Gives everything of a system that is not an anchor one velocity, m/s, and no rotation.
pub(super) fn set_motion(world: &mut World, system: &TetheredSystem, velocity_m_s: DVec3) {
    for part in system.bodies.iter().chain(&system.nodes) {
        if let Some(mut velocity) = world.get_mut::<Velocity>(*part) {
            velocity.0 = velocity_m_s;
        }
        if let Some(mut rate) = world.get_mut::<AngularVelocity>(*part) {
            rate.0 = DVec3::ZERO;
        }
    }
}
