//! Keeping loops closed: joint coordinates leave the tips of cut tethers free, and accelerations that keep
//! them at their places let errors of every step add up.
//!
//! So an accepted state whose tips have left their places is projected back, positions and then velocities,
//! by the change that moves the least of mass ([`ClosedDynamics::closing_change`]). Baumgarte's springs, the
//! usual remedy, add a motion of their own that has to be fast to be of use, and that an implicit step would
//! have to know; a projection has no parameter, and what it changes is of the size of the integrator's error.

use bevy_ecs::world::World;
use glam::DVec3;

use super::JointVector;
use crate::denoc::articulated_link::Stretch;
use crate::denoc::closed_dynamics::{ClosedDynamics, Motion, gaps};
use crate::denoc::joint_coordinates::LinkChart;
use crate::denoc::tree::KinematicTree;
use crate::dynamics::link_mechanism::LinkMechanism;
use crate::dynamics::rotation_chart::exponential;
use crate::integration::Correction;

/// Gaps (m, m/s) below this are left as they are: round-off of altitudes is near.
const CLOSED: f64 = 1e-10;
/// Gaps that a projection leaves are below this (m, m/s): what round-off of altitudes allows on Venus.
const TIGHT: f64 = 3e-11;
/// Gaps below this (m, m/s) are closed without evaluating the state anew between steps: its rates change by as
/// little, and a step that starts from them errs by less than it does itself.
const SMALL: f64 = 1e-6;
const PASSES_AFTER_STEP: usize = 8;
const PASSES_AT_START: usize = 50;

/// What a gap consists of.
#[derive(Clone, Copy)]
enum Of {
    Position,
    Velocity,
}

impl JointVector {
    /// Gaps of the tips, and the largest.
    fn gaps(
        &self,
        mechanism: &LinkMechanism,
        dynamics: &ClosedDynamics,
        of: Of,
    ) -> (Vec<DVec3>, f64) {
        let components = &self.components;
        let offsets = &mechanism.entities.offsets;
        let found = gaps(
            &mechanism.tree,
            &components.bodies,
            &components.ties,
            offsets,
        );
        let mut gaps: Vec<DVec3> = found.map(|gap| gap[of as usize]).collect();
        dynamics.drop_redundant(&mut gaps);
        let largest = gaps.iter().map(|gap| gap.length()).fold(0.0, f64::max);
        (gaps, largest)
    }

    /// Closes the loops of a configuration that may be far from closed.
    pub(super) fn close_at_start(&mut self, mechanism: &LinkMechanism) {
        if mechanism.tree.closures.is_empty() {
            return;
        }
        let mut dynamics = mechanism.dynamics.clone();
        for _ in 0..PASSES_AT_START {
            let motion = Motion {
                links: &self.links,
                bodies: &self.components.bodies,
                ties: &[],
            };
            let solved = dynamics.solve(
                &mechanism.tree,
                motion,
                &mechanism.entities.offsets,
                &mechanism.loads,
                &mut self.change,
            );
            if solved.is_err() {
                break;
            }
            let (gaps, largest_m) = self.gaps(mechanism, &dynamics, Of::Position);
            if largest_m <= TIGHT {
                break;
            }
            dynamics.closing_change(&mechanism.tree, &gaps, &mut self.change);
            self.shift(&mechanism.tree);
            self.sweep(mechanism);
        }
        self.take_spans();
    }

    /// Closes the loops of an accepted state, whose evaluation was the last one.
    pub(super) fn close_after_step(&mut self, world: &mut World) -> Correction {
        let mechanism = &mut *world.resource_mut::<LinkMechanism>();
        if mechanism.tree.closures.is_empty() {
            return Correction::None;
        }
        let mut dynamics = std::mem::take(&mut mechanism.dynamics);
        let positions = self.gaps(mechanism, &dynamics, Of::Position).1;
        let velocities = self.gaps(mechanism, &dynamics, Of::Velocity).1;
        let largest = positions.max(velocities);
        if largest > CLOSED {
            self.project(mechanism, &mut dynamics);
        }
        mechanism.dynamics = dynamics;
        match largest {
            CLOSED..SMALL => {
                self.components.write(world, &self.links);
                Correction::Slight
            }
            SMALL.. => Correction::Large,
            _ => Correction::None,
        }
    }

    fn project(&mut self, mechanism: &LinkMechanism, dynamics: &mut ClosedDynamics) {
        for _ in 0..PASSES_AFTER_STEP {
            let (gaps, largest_m) = self.gaps(mechanism, dynamics, Of::Position);
            if largest_m <= TIGHT {
                break;
            }
            dynamics.closing_change(&mechanism.tree, &gaps, &mut self.change);
            self.shift(&mechanism.tree);
            self.sweep(mechanism);
        }
        for _ in 0..PASSES_AFTER_STEP {
            let (gaps, largest_m_s) = self.gaps(mechanism, dynamics, Of::Velocity);
            if largest_m_s <= TIGHT {
                break;
            }
            dynamics.closing_change(&mechanism.tree, &gaps, &mut self.change);
            self.speed(&mechanism.tree);
            self.sweep(mechanism);
        }
        self.take_spans();
    }

    /// Changes positions of bases, attitudes and spans by what closes the loops.
    fn shift(&mut self, tree: &KinematicTree) {
        let bodies = &mut self.components.bodies;
        for &base in &tree.bases {
            bodies[base].centre.position_m += self.change.bodies[base].linear;
        }
        for (body, change) in bodies.iter_mut().zip(&self.change.bodies) {
            body.attitude = (body.attitude * exponential(change.angular)).normalize();
        }
        let spans = self.links.span_m.iter_mut().zip(&self.change.span_m_s2);
        for ((span, change), kind) in spans.zip(&self.kinds) {
            *span += *change;
            if kind.stretch == Stretch::Rigid {
                *span *= kind.length_m / span.length();
            }
        }
    }

    /// Changes velocities of bases, rates of bodies and of spans by what keeps the loops closed.
    fn speed(&mut self, tree: &KinematicTree) {
        let bodies = &mut self.components.bodies;
        for &base in &tree.bases {
            bodies[base].centre.velocity_m_s += self.change.bodies[base].linear;
        }
        for (body, change) in bodies.iter_mut().zip(&self.change.bodies) {
            body.rate_rad_s += change.angular;
        }
        let rates = self.links.rate_m_s.iter_mut().zip(&self.change.span_m_s2);
        for ((rate, change), (span, kind)) in rates.zip(self.links.span_m.iter().zip(&self.kinds)) {
            *rate += *change;
            if kind.stretch == Stretch::Rigid {
                let apart = kind.length_m * kind.length_rate_m_s - rate.dot(*span);
                *rate += (apart / span.length_squared()) * *span;
            }
        }
    }

    /// Makes the spans the centres of the charts.
    fn take_spans(&mut self) {
        let spans = self.links.span_m.iter_mut().zip(&mut self.links.rate_m_s);
        let charts = self.charts.iter_mut().zip(&self.kinds);
        for ((span, rate), (chart, kind)) in spans.zip(charts) {
            (*chart, *rate) = LinkChart::around(*span, *rate, kind);
            *span = chart.centre_m;
        }
    }
}
