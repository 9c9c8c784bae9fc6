//! The linearised motion of rigid links, in the coordinates that joints leave free.
//!
//! With the coordinates `q = Z y` of a basis Z, orthonormal and each column moving one body or one link,
//! `y'' = Z' q''`, and K and D are differences of that. Where loops are closed, Z is restricted to the motions
//! that keep them closed.

use aerobot_components::state::{AngularVelocity, Velocity};
use aerobot_systems::denoc::articulated_link::Stretch;
use aerobot_systems::denoc::closed_dynamics::gaps;
use aerobot_systems::denoc::kinematics::BodyState;
use aerobot_systems::dynamics::joint_layout::{BodyPlace, JointLayout};
use aerobot_systems::dynamics::link_mechanism::LinkMechanism;
use aerobot_systems::dynamics::state_space::StateSpace;
use aerobot_systems::fault::Fault;
use aerobot_systems::modes::Complex;
use aerobot_systems::modes::dense_motion::DenseMotion;
use aerobot_systems::modes::extrapolated_difference::differentiate;
use aerobot_systems::modes::null_space::null_space;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::displaced_forces::first_order_states;
use super::linear_motion::LinearMotion;
use super::sites::{ComplexVector, SiteMotion, Sites};
use crate::evaluation::Evaluation;

/// Largest step of displacements, m and rad, as a part of a link's length for a link.
const STEP: f64 = 0.007_812_5;
/// Steps are shorter by this where loops are closed.
const IN_LOOPS: f64 = 1.0 / 16.0;
/// Largest step of velocities, m/s and rad/s.
const VELOCITY_STEP: f64 = 1.0 / 4096.0;

/// One direction in the space of coordinates.
#[derive(Clone, Debug)]
struct Direction {
    /// Where its three coordinates begin.
    at: usize,
    /// A unit vector.
    along: DVec3,
    /// Largest step of differences along it.
    step: f64,
}

/// The free directions of the coordinates.
pub(super) struct JointBasis {
    directions: Vec<Direction>,
    /// Of each column of Z its parts along the directions, where loops are closed; else Z is the directions.
    combinations: Option<Vec<Vec<f64>>>,
    /// How many constraints of loops are said twice.
    redundant: usize,
}

/// A world of links that is moved about a state.
pub(super) struct JointWorld<'a> {
    pub(super) world: &'a mut World,
    pub(super) evaluation: &'a mut Evaluation,
    pub(super) state: &'a mut dyn StateSpace,
    /// The steady state.
    pub(super) steady: &'a [f64],
}

impl JointBasis {
    /// Of the tree of a world, where its links are now.
    pub(super) fn of(world: &World) -> Self {
        let mechanism = world.resource::<LinkMechanism>();
        let layout = JointLayout::new(mechanism);
        let mut directions = Vec::new();
        let mut add = |at: usize, step: f64, axes: &[DVec3]| {
            directions.extend(axes.iter().map(|along| Direction {
                at,
                along: *along,
                step,
            }));
        };
        for (place, turns) in layout.bodies.iter().zip(&mechanism.entities.turns) {
            if let BodyPlace::Base(at) = place {
                add(*at, STEP, &DVec3::AXES);
            }
            if let (Some(at), true) = (place.rotation(), turns) {
                add(at, STEP, &DVec3::AXES);
            }
        }
        for (limb, kind) in mechanism.tree.limbs.iter().zip(&mechanism.tree.kinds) {
            for link in limb.links.clone() {
                let at = layout.first_link + 3 * link;
                let step = STEP * kind.length_m.min(1.0);
                match kind.stretch {
                    Stretch::Elastic => add(at, step, &DVec3::AXES),
                    Stretch::Rigid => {
                        let along = mechanism.links.span_m[link].normalize_or(DVec3::NEG_Z);
                        add(at, step, &across(along));
                    }
                }
            }
        }
        Self {
            directions,
            combinations: None,
            redundant: 0,
        }
    }

    /// Whether rigid tethers are redundant, so that waves in them are not quite their own.
    pub(super) fn is_redundant(&self) -> bool {
        self.redundant > 0
    }

    /// The directions, whether they keep loops closed or not.
    fn directions_alone(&self) -> Self {
        Self {
            directions: self.directions.clone(),
            combinations: None,
            redundant: 0,
        }
    }

    /// Number of columns of Z.
    pub(super) fn len(&self) -> usize {
        match &self.combinations {
            None => self.directions.len(),
            Some(combinations) => combinations.len(),
        }
    }

    /// Amplitudes along the basis of a vector of coordinates.
    pub(super) fn parts(&self, coordinates: &[f64]) -> Vec<f64> {
        let parts = self.directions.iter().map(|direction| {
            direction
                .along
                .dot(DVec3::from_slice(&coordinates[direction.at..]))
        });
        match &self.combinations {
            None => parts.collect(),
            Some(combinations) => {
                let parts: Vec<f64> = parts.collect();
                let along = |column: &Vec<f64>| column.iter().zip(&parts).map(|(a, b)| a * b).sum();
                combinations.iter().map(along).collect()
            }
        }
    }

    /// Adds a multiple of a column of Z to coordinates.
    fn move_along(&self, k: usize, by: f64, coordinates: &mut [f64]) {
        match &self.combinations {
            None => self.directions[k].move_along(by, coordinates),
            Some(combinations) => {
                for (direction, part) in self.directions.iter().zip(&combinations[k]) {
                    direction.move_along(by * part, coordinates);
                }
            }
        }
    }
}

impl Direction {
    fn move_along(&self, by: f64, coordinates: &mut [f64]) {
        let change = by * self.along;
        for (value, change) in coordinates[self.at..].iter_mut().zip(change.to_array()) {
            *value += change;
        }
    }
}

/// Two unit vectors across a third: the first as near to x as can be, or to y.
fn across(along: DVec3) -> [DVec3; 2] {
    let start = if along.x.abs() < 0.9 {
        DVec3::X
    } else {
        DVec3::Y
    };
    let first = (start - start.dot(along) * along).normalize();
    [first, along.cross(first)]
}

impl JointWorld<'_> {
    /// The free directions of the coordinates, and of them what keeps loops closed.
    pub(super) fn basis(&mut self) -> Result<JointBasis, Fault> {
        let mut basis = JointBasis::of(self.world);
        if self
            .world
            .resource::<LinkMechanism>()
            .tree
            .closures
            .is_empty()
        {
            return Ok(basis);
        }
        // Columns of single directions are stiff, and cancel in a slow motion: their truncation must too.
        for direction in &mut basis.directions {
            direction.step *= IN_LOOPS;
        }
        // The gaps of tips change linearly with velocities: a row of constraints for each of their parts.
        let steady = self.gap_rates(&basis, None)?;
        let mut rows = vec![vec![0.0; basis.len()]; steady.len()];
        for k in 0..basis.len() {
            let moved = self.gap_rates(&basis, Some(k))?;
            for (row, (moved, steady)) in rows.iter_mut().zip(moved.iter().zip(&steady)) {
                row[k] = moved - steady;
            }
        }
        let free = null_space(&rows, basis.len());
        basis.redundant = rows.len() + free.len() - basis.directions.len();
        basis.combinations = Some(free);
        Ok(basis)
    }

    /// How fast tips leave their places in the steady state, with 1 m/s or rad/s along a direction besides.
    fn gap_rates(&mut self, basis: &JointBasis, along: Option<usize>) -> Result<Vec<f64>, Fault> {
        let coordinates = self.state.layout().coordinates;
        let mut state = self.steady.to_vec();
        if let Some(k) = along {
            basis.move_along(k, 1.0, &mut state[coordinates..]);
        }
        self.state.scatter(self.world, &state)?;
        let mechanism = self.world.resource::<LinkMechanism>();
        // What anchors do is the same in all of them.
        let anchors = vec![BodyState::default(); mechanism.tree.closures.len()];
        let offsets = &mechanism.entities.offsets;
        let gaps = gaps(&mechanism.tree, &mechanism.bodies, &anchors, offsets);
        Ok(gaps.flat_map(|gap| gap[1].to_array()).collect())
    }

    /// The linearised motion, and the first-order states that take part in it.
    pub(super) fn linearise(
        &mut self,
        basis: &JointBasis,
    ) -> Result<(LinearMotion, Vec<Entity>), Fault> {
        // Differences are taken direction by direction, each with the step that fits it, and then combined: off
        // the motions that keep loops closed accelerations are as smooth as on them.
        let (combinations, basis) = (&basis.combinations, &basis.directions_alone());
        let n = basis.len();
        let first_order = first_order_states(self.world);
        let (m, coordinates) = (first_order.len(), self.state.layout().coordinates);
        let mut motion = DenseMotion::zeros(n, m);
        motion.mass.fill_diagonal(1.0);
        let mut column = vec![0.0; n + m];
        for k in 0..n {
            let steps = [basis.directions[k].step, VELOCITY_STEP];
            for (part, step) in steps.into_iter().enumerate() {
                column.fill(0.0);
                differentiate(&mut column, step, |h, out| {
                    let mut state = self.steady.to_vec();
                    basis.move_along(k, h, &mut state[part * coordinates..]);
                    self.accelerations(basis, &state, out)
                })?;
                let (matrix, driven) = if part == 0 {
                    (
                        &mut motion.stiffness,
                        &mut motion.first_order_by_displacement,
                    )
                } else {
                    (&mut motion.damping, &mut motion.first_order_by_velocity)
                };
                for (row, value) in column[..n].iter().enumerate() {
                    matrix[(row, k)] = -value;
                }
                for row in 0..m {
                    driven[(row, k)] = column[n + row];
                }
            }
        }
        for k in 0..m {
            column.fill(0.0);
            differentiate(&mut column, STEP, |h, out| {
                let mut state = self.steady.to_vec();
                state[2 * coordinates + k] += h;
                self.accelerations(basis, &state, out)
            })?;
            for (row, value) in column[..n].iter().enumerate() {
                motion.by_first_order[(row, k)] = *value;
            }
            for row in 0..m {
                motion.first_order[(row, k)] = column[n + row];
            }
        }
        if let Some(combinations) = combinations {
            motion = motion.along(combinations);
        }
        let (motion, kept) = motion.without_idle_first_order();
        let kept = kept.into_iter().map(|k| first_order[k].0).collect();
        Ok((LinearMotion::Dense(Box::new(motion)), kept))
    }

    /// Accelerations along the basis, then rates of first-order states.
    fn accelerations(
        &mut self,
        basis: &JointBasis,
        state: &[f64],
        out: &mut [f64],
    ) -> Result<(), Fault> {
        self.state.scatter(self.world, state)?;
        self.evaluation.run(self.world)?;
        let coordinates = self.state.layout().coordinates;
        let mut rates = vec![0.0; state.len()];
        self.state.gather_rates(self.world, state, &mut rates);
        let parts = basis.parts(&rates[coordinates..2 * coordinates]);
        out[..parts.len()].copy_from_slice(&parts);
        out[parts.len()..].copy_from_slice(&rates[2 * coordinates..]);
        Ok(())
    }

    /// Rates along the basis of given velocities and angular velocities of the sites, as far as joints
    /// allow them.
    pub(super) fn rates_of(
        &mut self,
        basis: &JointBasis,
        sites: &Sites,
        motions: &[(DVec3, DVec3)],
    ) -> Vec<f64> {
        let coordinates = self.state.layout().coordinates;
        // The charts that a state counts from are renewed when it is read.
        let before = self.state.scatter(self.world, self.steady);
        for (site, (linear, angular)) in sites.all.iter().zip(motions) {
            let mut entity = self.world.entity_mut(site.entity);
            if let Some(mut velocity) = entity.get_mut::<Velocity>() {
                velocity.0 = *linear;
            }
            if let Some(mut rate) = entity.get_mut::<AngularVelocity>() {
                rate.0 = *angular;
            }
        }
        let mut state = vec![0.0; self.steady.len()];
        if before.is_ok() {
            self.state.gather(self.world, &mut state);
        }
        basis.parts(&state[coordinates..2 * coordinates])
    }

    /// The motions of all sites for amplitudes along the basis.
    pub(super) fn motions(
        &mut self,
        basis: &JointBasis,
        sites: &Sites,
        y: &[Complex<f64>],
    ) -> Result<Vec<SiteMotion>, Fault> {
        let real: Vec<f64> = y.iter().map(|part| part.re).collect();
        let imaginary: Vec<f64> = y.iter().map(|part| part.im).collect();
        let real = self.velocities(basis, sites, &real)?;
        let imaginary = self.velocities(basis, sites, &imaginary)?;
        let pairs = real.into_iter().zip(imaginary);
        Ok(pairs
            .map(|(real, imaginary)| SiteMotion {
                linear: ComplexVector {
                    real: real.0,
                    imaginary: imaginary.0,
                },
                angular: ComplexVector {
                    real: real.1,
                    imaginary: imaginary.1,
                },
            })
            .collect())
    }

    /// Velocities of sites beyond the steady ones, for rates along the basis.
    fn velocities(
        &mut self,
        basis: &JointBasis,
        sites: &Sites,
        rates: &[f64],
    ) -> Result<Vec<(DVec3, DVec3)>, Fault> {
        let coordinates = self.state.layout().coordinates;
        let mut state = self.steady.to_vec();
        for (k, rate) in rates.iter().enumerate() {
            basis.move_along(k, *rate, &mut state[coordinates..]);
        }
        self.state.scatter(self.world, &state)?;
        let velocity = |site: &super::sites::Site| {
            let entity = self.world.entity(site.entity);
            let linear = entity.get::<Velocity>().map_or(DVec3::ZERO, |v| v.0);
            let angular = entity.get::<AngularVelocity>().map_or(DVec3::ZERO, |w| w.0);
            (linear - site.velocity_m_s, angular - site.rate_rad_s)
        };
        Ok(sites.all.iter().map(velocity).collect())
    }
}
