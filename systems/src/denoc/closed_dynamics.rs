//! Forward dynamics of trees with closed loops: the tree, its loops' multipliers, and what these add.

use glam::DVec3;

use super::articulated_link::Stretch;
use super::forward_dynamics::{Accelerations, ForwardDynamics, Loads, Massless};
use super::kinematics::{BodyState, LimbOffsets, LinkStates};
use super::loops::Loops;
use super::tree::KinematicTree;
use crate::linearised_motion::body_block::{Place, Twist};

/// Where tethers are attached.
#[derive(Clone, Debug, Default)]
pub struct Offsets {
    /// The ends of each limb.
    pub limbs: Vec<LimbOffsets>,
    /// Of each closure: its place on the body or anchor that it is tied to, body frame, m.
    pub ties_m: Vec<DVec3>,
}

/// The recursion with its loops.
#[derive(Clone, Debug, Default)]
pub struct ClosedDynamics {
    tree: ForwardDynamics,
    loops: Loops,
    gaps: Vec<DVec3>,
    holds: Vec<DVec3>,
    loads: Vec<Twist>,
}

impl ClosedDynamics {
    /// Scratch for a tree whose limbs have these compliances (m/N, up to a common factor).
    #[must_use]
    pub fn new(tree: &KinematicTree, compliance: Vec<f64>) -> Self {
        Self {
            tree: ForwardDynamics::new(tree),
            loops: Loops::new(tree, compliance),
            gaps: vec![DVec3::ZERO; tree.closures.len()],
            holds: Vec::new(),
            loads: vec![Twist::default(); tree.carried_by.len()],
        }
    }

    /// Solves for all accelerations and tensions.
    ///
    /// # Errors
    /// [`Massless`].
    pub fn solve(
        &mut self,
        tree: &KinematicTree,
        states: (&LinkStates, &[BodyState]),
        offsets: &Offsets,
        loads: &Loads,
        out: &mut Accelerations,
    ) -> Result<(), Massless> {
        self.tree.solve(tree, states, &offsets.limbs, loads, out)?;
        if tree.closures.is_empty() {
            return Ok(());
        }
        let bodies = states.1;
        self.loops.factorise(
            tree,
            &self.tree.factors(),
            |limb| self.tree.proximal(limb),
            |closure, body| Place::new(bodies[body].attitude, offsets.ties_m[closure]),
            |limb| self.tree.distal(limb),
            |limb| chord(tree, states.0, limb),
        );
        for (index, closure) in tree.closures.iter().enumerate() {
            let besides = match closure.onto {
                Some(body) => {
                    let (rate, offset_m) = (bodies[body].rate_rad_s, offsets.ties_m[index]);
                    bodies[body].attitude * rate.cross(rate.cross(offset_m))
                }
                None => loads.tie_m_s2[index],
            };
            self.gaps[index] = self.loops.gap(index, &out.bodies) - besides;
        }
        self.tree.holds(tree, out, &mut self.holds);
        self.loops.close(&self.gaps, Some(&self.holds));
        self.loops.add_loads(&mut self.loads);
        self.tree.respond(tree, &mut self.loads, out);
        Ok(())
    }

    /// Takes from gaps of tips what the lengths of redundant tethers say twice, as far as the last solution tells.
    pub fn drop_redundant(&self, gaps: &mut [DVec3]) {
        self.loops.drop_redundant(gaps);
    }

    /// The change, of positions or of velocities, that closes `gaps` of tips from their places (m or m/s) with
    /// the least of mass moved: -M^-1 G' (G M^-1 G')^-1 times the gaps, at the state that was solved last.
    /// Momentum and centre of mass of what is free stay as they are.
    pub fn closing_change(
        &mut self,
        tree: &KinematicTree,
        gaps: &[DVec3],
        out: &mut Accelerations,
    ) {
        out.clear();
        self.loops.close(gaps, None);
        self.loops.add_loads(&mut self.loads);
        self.tree.respond(tree, &mut self.loads, out);
    }
}

/// The chord of a limb, its length (m) and whether it is rigid.
fn chord(tree: &KinematicTree, links: &LinkStates, limb: usize) -> (DVec3, f64, bool) {
    let (own, kind) = (tree.limbs[limb].links.clone(), &tree.kinds[limb]);
    let length_m = kind.length_m * own.len() as f64;
    let is_rigid = kind.stretch == Stretch::Rigid;
    (links.span_m[own].iter().sum(), length_m, is_rigid)
}

/// Of each closure, how far its tip is from its place (m) and how fast it leaves it (m/s); `anchors` has the
/// anchors of closures.
#[must_use]
pub fn gaps(
    tree: &KinematicTree,
    bodies: &[BodyState],
    anchors: &[BodyState],
    offsets: &Offsets,
) -> Vec<[DVec3; 2]> {
    let each = tree.closures.iter().zip(&offsets.ties_m).enumerate();
    each.map(|(index, (closure, offset_m))| {
        let onto = closure.onto.map_or(&anchors[index], |body| &bodies[body]);
        let (tip, place) = (bodies[closure.tip].centre, onto.place(*offset_m));
        [
            tip.position_m - place.position_m,
            tip.velocity_m_s - place.velocity_m_s,
        ]
    })
    .collect()
}

#[cfg(test)]
mod tests;
