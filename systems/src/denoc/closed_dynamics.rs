//! Forward dynamics of trees with closed loops: the tree, its loops' multipliers, and what these add.

use glam::DVec3;

use super::articulated_link::Stretch;
use super::forward_dynamics::{Accelerations, ForwardDynamics, Loads, Massless};
use super::kinematics::{BodyState, LimbOffsets, LinkStates};
use super::loops::{LimbElasticity, LoopGeometry, Loops, Told};
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

/// Where everything is in an evaluation, and how it moves.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Of the links.
    pub links: &'a LinkStates,
    /// Of bodies, loose nodes and tips.
    pub bodies: &'a [BodyState],
    /// Of each closure that has one, its anchor; empty where forces are not to answer for gaps that are open.
    pub ties: &'a [BodyState],
}

/// The recursion with its loops.
#[derive(Clone, Debug, Default)]
pub struct ClosedDynamics {
    tree: ForwardDynamics,
    loops: Loops,
    /// Accelerations by which tips leave their places without the multipliers, m/s^2.
    gaps: Vec<DVec3>,
    /// How far they have left them (m), and how fast they do (m/s).
    open: Vec<[DVec3; 2]>,
    loads: Vec<Twist>,
}

impl ClosedDynamics {
    /// Scratch for a tree with these limbs.
    #[must_use]
    pub fn new(tree: &KinematicTree, elasticity: Vec<LimbElasticity>) -> Self {
        Self {
            tree: ForwardDynamics::new(tree),
            loops: Loops::new(tree, elasticity),
            gaps: vec![DVec3::ZERO; tree.closures.len()],
            open: vec![[DVec3::ZERO; 2]; tree.closures.len()],
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
        motion: Motion<'_>,
        offsets: &Offsets,
        loads: &Loads,
        out: &mut Accelerations,
    ) -> Result<(), Massless> {
        let Motion { links, bodies, .. } = motion;
        self.tree
            .sweep_inward(tree, (links, bodies), &offsets.limbs, loads, out)?;
        if !tree.closures.is_empty() {
            let geometry = Standing {
                tree,
                motion,
                offsets,
                dynamics: &self.tree,
            };
            let factors = self.tree.factors();
            self.loops.factorise(tree, &factors, &geometry, None);
            self.load_tips(tree, motion, offsets, loads, &out.bodies);
            self.tree.sweep_more_inward(tree, &mut self.loads, out);
        }
        self.tree.sweep_outward(tree, loads, out);
        Ok(())
    }

    /// Finds the multipliers, and leaves them as loads; `bases` hold the accelerations of bases without them.
    fn load_tips(
        &mut self,
        tree: &KinematicTree,
        motion: Motion<'_>,
        offsets: &Offsets,
        loads: &Loads,
        bases: &[Twist],
    ) {
        let dynamics = &self.tree;
        self.loops
            .drift(tree, bases, dynamics.body_biases(), |limb| {
                dynamics.centripetal(tree, limb, loads)
            });
        for (index, closure) in tree.closures.iter().enumerate() {
            let besides = match closure.onto {
                Some(body) => {
                    let rate = motion.bodies[body].rate_rad_s;
                    motion.bodies[body].attitude * rate.cross(rate.cross(offsets.ties_m[index]))
                }
                None => loads.tie_m_s2[index],
            };
            self.gaps[index] = self.loops.drifting_gap(index) - besides;
        }
        if motion.ties.is_empty() {
            self.open.fill([DVec3::ZERO; 2]);
        } else {
            self.open.clear();
            let open = gaps(tree, motion.bodies, motion.ties, offsets);
            self.open.extend(open);
        }
        self.loops.close(&self.gaps, Told::Forces(&self.open));
        self.loops.add_loads(&mut self.loads);
    }

    /// The tip that was farthest from its place when forces were last solved for: the closure, and how far, m.
    #[must_use]
    pub fn widest(&self) -> Option<(usize, f64)> {
        let gaps = self.open.iter().map(|[gap_m, _]| gap_m.length());
        gaps.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b))
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
        self.loops.close(gaps, Told::Nothing);
        self.loops.add_loads(&mut self.loads);
        self.tree.respond(tree, &mut self.loads, out);
    }
}

/// Where limbs stand in an evaluation.
struct Standing<'a> {
    tree: &'a KinematicTree,
    motion: Motion<'a>,
    offsets: &'a Offsets,
    dynamics: &'a ForwardDynamics,
}

impl LoopGeometry for Standing<'_> {
    fn proximal(&self, limb: usize) -> Place {
        self.dynamics.proximal(limb)
    }

    fn distal(&self, limb: usize) -> Place {
        self.dynamics.distal(limb)
    }

    fn tie(&self, closure: usize, body: usize) -> Place {
        let attitude = self.motion.bodies[body].attitude;
        Place::new(attitude, self.offsets.ties_m[closure])
    }

    fn chord(&self, limb: usize) -> (DVec3, f64, bool) {
        let (own, kind) = (&self.tree.limbs[limb].links, &self.tree.kinds[limb]);
        let length_m = kind.length_m * own.len() as f64;
        let is_rigid = kind.stretch == Stretch::Rigid;
        let spans = self.motion.links.span_m[own.clone()].iter();
        (spans.sum(), length_m, is_rigid)
    }
}

/// Of each closure, how far its tip is from its place (m) and how fast it leaves it (m/s); `anchors` has the
/// anchors of closures.
pub fn gaps<'a>(
    tree: &'a KinematicTree,
    bodies: &'a [BodyState],
    anchors: &'a [BodyState],
    offsets: &'a Offsets,
) -> impl Iterator<Item = [DVec3; 2]> + 'a {
    let each = tree.closures.iter().zip(&offsets.ties_m).enumerate();
    each.map(|(index, (closure, offset_m))| {
        let onto = closure.onto.map_or(&anchors[index], |body| &bodies[body]);
        let (tip, place) = (bodies[closure.tip].centre, onto.place(*offset_m));
        [
            tip.position_m - place.position_m,
            tip.velocity_m_s - place.velocity_m_s,
        ]
    })
}

#[cfg(test)]
mod tests;
