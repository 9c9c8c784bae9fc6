//! Elimination of the nodes of one tether, from its `from` end to its `to` end, in linear time.
//!
//! The nodes of a tether couple through its segments alone: the matrix has `-E_i`, symmetric, beside the
//! diagonal, and `m_i + E_(i-1) + E_i` on it. Block Gaussian elimination (Golub and Van Loan 2013,
//! sec. 4.5.1) is
//!
//! ```text
//! F_1 = m_1 + E_0     C_i = (F_i + E_i)^-1     G_i = E_i C_i     F_(i+1) = m_(i+1) + G_i F_i
//! forward    r_(i+1) += G_i r_i          backward   x_i = C_i r_i + G_i' x_(i+1)
//! ```
//!
//! `E - E C E = G F` in this form has no cancellation, however stiff the segments are.
//!
//! Where the `from` end is on a free body, its motion a couples to every node by the spike
//! `Z_1 = -E_0`, `Z_(i+1) = G_i Z_i`, carried along as `P_i = C_i Z_i`. What is left of the tether is
//! the stiffness between its two ends, the Schur complement of its nodes:
//!
//! ```text
//! S_aa = E_0 - sum Z_i' P_i      S_ba = G_n Z_n      S_bb = G_n F_n
//! ```

use glam::{DMat3, DVec3};

use super::symmetric3::Symmetric3;

/// What is left of a tether between its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EndStiffness {
    /// On the `from` end by its own motion; zero if that is held.
    pub from_from: DMat3,
    /// On the `to` end by the motion of the `from` end; zero if that is held. (Its transpose is on
    /// the `from` end by the motion of the `to` end.)
    pub to_from: DMat3,
    /// On the `to` end by its own motion.
    pub to_to: DMat3,
}

/// The eliminated nodes of one tether.
#[derive(Clone, Debug, Default)]
pub struct Chain {
    /// C_i.
    compliance: Vec<Symmetric3>,
    /// G_i.
    carried: Vec<DMat3>,
    /// P_i; empty where the `from` end is held.
    spike: Vec<DMat3>,
    /// Whether the `from` end is on a free body.
    from_moves: bool,
}

/// A diagonal block that is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotPositive {
    /// The node, from 0 at `from`.
    pub node: usize,
}

impl Chain {
    /// For a tether of `nodes` nodes.
    #[must_use]
    pub fn new(nodes: usize, from_moves: bool) -> Self {
        Self {
            compliance: vec![Symmetric3::default(); nodes],
            carried: vec![DMat3::ZERO; nodes],
            spike: vec![DMat3::ZERO; if from_moves { nodes } else { 0 }],
            from_moves,
        }
    }

    /// Eliminates the nodes: `own` are their diagonal blocks without those of the segments, one fewer
    /// than the `segments`.
    ///
    /// # Errors
    /// [`NotPositive`]: the step is too long for what pushes on that node.
    pub fn factorise(
        &mut self,
        own: &[Symmetric3],
        segments: &[Symmetric3],
    ) -> Result<EndStiffness, NotPositive> {
        let nodes = own.len();
        let first = segments[0];
        let mut before = first;
        let mut all_positive = true;
        let spikes = &mut self.spike;
        let (compliance, carried) = (&mut self.compliance[..nodes], &mut self.carried[..nodes]);
        let segments = &segments[1..=nodes];
        let mut worst = 0;
        for i in 0..nodes {
            let so_far = own[i].plus(before);
            let (inverse, positive) = so_far.plus(segments[i]).inverse();
            if !positive && all_positive {
                all_positive = false;
                worst = i;
            }
            compliance[i] = inverse;
            let once = segments[i].by(&inverse);
            carried[i] = once;
            before = Symmetric3::product(&once, &so_far);
        }
        if !all_positive {
            return Err(NotPositive { node: worst });
        }
        let mut left = EndStiffness {
            from_from: DMat3::ZERO,
            to_from: DMat3::ZERO,
            to_to: before.into(),
        };
        if self.from_moves {
            let mut spike = -DMat3::from(first);
            left.from_from = first.into();
            for i in 0..nodes {
                let p = DMat3::from(compliance[i]) * spike;
                left.from_from -= spike.transpose() * p;
                spikes[i] = p;
                spike = carried[i] * spike;
            }
            left.to_from = spike;
        }
        Ok(left)
    }

    /// Carries right-hand sides `r` of the nodes to the ends; returns what is added on `from` and on
    /// `to`.
    pub fn forward(&self, r: &mut [DVec3]) -> (DVec3, DVec3) {
        let mut carried = DVec3::ZERO;
        for (r, g) in r.iter_mut().zip(&self.carried) {
            *r += carried;
            carried = *g * *r;
        }
        let mut from = DVec3::ZERO;
        for (r, p) in r.iter().zip(&self.spike) {
            // P' r, by columns of P.
            from -= DVec3::new(p.x_axis.dot(*r), p.y_axis.dot(*r), p.z_axis.dot(*r));
        }
        (from, carried)
    }

    /// Finds the unknowns of the nodes from those of the ends; `r` as [`Chain::forward`] left it.
    pub fn backward(&self, r: &mut [DVec3], from: DVec3, to: DVec3) {
        let mut next = to;
        if self.from_moves {
            for (r, (c, p)) in r.iter_mut().zip(self.compliance.iter().zip(&self.spike)) {
                *r = c.times(*r) - *p * from;
            }
        } else {
            for (r, c) in r.iter_mut().zip(&self.compliance) {
                *r = c.times(*r);
            }
        }
        for (r, g) in r.iter_mut().zip(&self.carried).rev() {
            next = *r + DVec3::new(g.x_axis.dot(next), g.y_axis.dot(next), g.z_axis.dot(next));
            *r = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nonlinear_solver::test_support::{Random, dense_solve};

    fn vector(random: &mut Random) -> DVec3 {
        DVec3::new(random.signed(), random.signed(), random.signed())
    }

    fn entries(m: DMat3) -> [[f64; 3]; 3] {
        m.transpose().to_cols_array_2d()
    }

    /// The nodes and both ends as one dense system: what the ends and the nodes do under any load.
    #[test]
    fn a_chain_answers_as_the_dense_system_does() {
        let mut random = Random::new(7);
        for nodes in [0, 1, 2, 9] {
            let segments: Vec<Symmetric3> = (0..=nodes)
                .map(|_| {
                    let along = 1e3 * (1.2 + random.signed());
                    let direction = vector(&mut random).normalize();
                    Symmetric3::along(direction, along, 1.2 + random.signed())
                })
                .collect();
            let own: Vec<Symmetric3> = (0..nodes)
                .map(|_| Symmetric3::along(vector(&mut random), 0.5, 1.5 + random.signed()))
                .collect();
            // Points 0 (from), 1..=nodes, nodes + 1 (to); the ends have a mass of their own.
            let points = nodes + 2;
            let ends = [DMat3::from_diagonal(DVec3::splat(2.0)); 2];
            let mut dense = vec![vec![0.0; 3 * points]; 3 * points];
            let mut add = |i: usize, j: usize, m: DMat3, sign: f64| {
                for (r, row) in entries(m).iter().enumerate() {
                    for (c, value) in row.iter().enumerate() {
                        dense[3 * i + r][3 * j + c] += sign * value;
                    }
                }
            };
            add(0, 0, ends[0], 1.0);
            add(points - 1, points - 1, ends[1], 1.0);
            for (i, own) in own.iter().enumerate() {
                add(i + 1, i + 1, (*own).into(), 1.0);
            }
            for (s, segment) in segments.iter().enumerate() {
                let m = DMat3::from(*segment);
                for (i, j, sign) in [
                    (s, s, 1.0),
                    (s + 1, s + 1, 1.0),
                    (s, s + 1, -1.0),
                    (s + 1, s, -1.0),
                ] {
                    add(i, j, m, sign);
                }
            }
            let load: Vec<DVec3> = (0..points).map(|_| vector(&mut random)).collect();
            let flat: Vec<f64> = load.iter().flat_map(|v| v.to_array()).collect();
            let expected = dense_solve(dense, &flat);

            let mut chain = Chain::new(nodes, true);
            let left = chain.factorise(&own, &segments).unwrap();
            let mut r = load[1..=nodes].to_vec();
            let (on_from, on_to) = chain.forward(&mut r);
            let reduced: Vec<Vec<f64>> = {
                let a = entries(ends[0] + left.from_from);
                let b = entries(left.to_from);
                let t = entries(left.to_from.transpose());
                let d = entries(ends[1] + left.to_to);
                (0..6)
                    .map(|r| {
                        let (left, right) = if r < 3 {
                            (a[r], t[r])
                        } else {
                            (b[r - 3], d[r - 3])
                        };
                        left.into_iter().chain(right).collect()
                    })
                    .collect()
            };
            let load_ends: Vec<f64> = (load[0] + on_from)
                .to_array()
                .into_iter()
                .chain((load[points - 1] + on_to).to_array())
                .collect();
            let found = dense_solve(reduced, &load_ends);
            let (from, to) = (DVec3::from_slice(&found), DVec3::from_slice(&found[3..]));
            chain.backward(&mut r, from, to);
            let mut all = vec![from];
            all.extend(r);
            all.push(to);
            for (i, v) in all.iter().enumerate() {
                let error = (*v - DVec3::from_slice(&expected[3 * i..])).length();
                assert!(error < 1e-9, "{nodes} nodes, point {i}: {error}");
            }

            // With the `from` end held.
            let mut held = Chain::new(nodes, false);
            let left = held.factorise(&own, &segments).unwrap();
            let mut r = load[1..=nodes].to_vec();
            let (_, on_to) = held.forward(&mut r);
            let to = (ends[1] + left.to_to).inverse() * (load[points - 1] + on_to);
            held.backward(&mut r, DVec3::ZERO, to);
            let mut before = DVec3::ZERO;
            for (i, x) in r.iter().enumerate() {
                let after = r.get(i + 1).copied().unwrap_or(to);
                let balance = own[i].times(*x)
                    + segments[i].times(*x - before)
                    + segments[i + 1].times(*x - after)
                    - load[i + 1];
                // Round-off of stiffnesses of 1e3.
                assert!(balance.length() < 1e-9, "{nodes} nodes, node {i}");
                before = *x;
            }
        }
    }
}
