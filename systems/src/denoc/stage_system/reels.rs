//! Links at winches in the matrix of an implicit step: their lengths, and how these change their tensions.

use super::LinkStages;
use crate::denoc::articulated_link::Stretch;
use crate::denoc::tree::Limb;
use crate::linearised_motion::derivatives::{Derivatives, LinearReel};

impl LinkStages {
    /// The limb of one link that a segment at a winch is.
    fn reeled_limb(&self, reel: &LinearReel) -> Option<usize> {
        let is_it = |limb: &Limb| limb.links.len() == 1 && limb.segment(0) == reel.segment;
        self.tree.limbs.iter().position(is_it)
    }

    /// Gives links at winches the lengths and the masses that they have at the state.
    pub(super) fn take_reels(&mut self, derivatives: &Derivatives) {
        for reel in &derivatives.reels {
            if let Some(limb) = self.reeled_limb(reel) {
                self.tree.kinds[limb].reel(reel.length_m);
            }
        }
    }

    /// Adds `g^2 dT/dL0 r_s` of elastic links at winches, whose unstretched length L0 is a first-order state:
    /// what the motion does not change is known beforehand.
    pub(super) fn pull_reels(&mut self, derivatives: &Derivatives, r_s: &[f64]) {
        for reel in &derivatives.reels {
            let Some(index) = self.reeled_limb(reel) else {
                continue;
            };
            if self.tree.kinds[index].stretch == Stretch::Rigid {
                continue;
            }
            let limb = &self.tree.limbs[index];
            let direction = limb.sign() * derivatives.segments[reel.segment].direction;
            let pull = self.g * self.g * reel.tension_by_length_n_m * r_s[reel.state];
            self.flows[limb.links.start] -= pull * direction;
        }
    }
}
