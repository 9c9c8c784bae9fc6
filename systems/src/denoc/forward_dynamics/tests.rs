//! The recursion against inverse dynamics, against the dense natural orthogonal complement, and on systems
//! worked by hand.

use glam::{DMat3, DQuat, DVec3};

use super::*;
use crate::denoc::inverse_dynamics::inverse_dynamics;
use crate::denoc::tree::LinkKind;
use crate::dynamics::rigid_body::CarriedMass;
use crate::linearised_motion::topology::{BodySite, End, Line, Topology};
use crate::nonlinear_solver::test_support::Random;

mod dense;

const GRAVITY: f64 = 8.87;
const LENGTH_M: f64 = 10.0;

fn vector(random: &mut Random, size: f64) -> DVec3 {
    size * DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Tethers of rods between bodies, with random poses, rates and forces.
struct Sample {
    tree: KinematicTree,
    links: LinkStates,
    bodies: Vec<BodyState>,
    offsets: Vec<LimbOffsets>,
    loads: Loads,
    points: usize,
    weight_n: f64,
}

/// A tether of a sample: its ends, and its number of links.
type Rope = (End, End, usize);

/// How a sample is drawn.
#[derive(Clone, Copy)]
struct Drawn {
    /// By how much the directions of links stray from straight down.
    spread: f64,
    /// Mass of each link, kg.
    rod_kg: f64,
    seed: u64,
}

impl Sample {
    fn new(ropes: &[Rope], body_kg: &[f64], drawn: Drawn) -> Self {
        let mut draws = Random::new(drawn.seed);
        let (topology, points) = topology(ropes, body_kg.len());
        let kind = LinkKind {
            length_m: LENGTH_M,
            length_rate_m_s: 0.0,
            coupling_kg: -drawn.rod_kg / 6.0,
            joint_mass_kg: drawn.rod_kg,
            stretch: Stretch::Rigid,
        };
        let tree = KinematicTree::new(&topology, &vec![kind; ropes.len()], &[]);
        let mut sample = Self {
            links: LinkStates::default(),
            bodies: Vec::new(),
            offsets: Vec::new(),
            loads: Loads::new(&tree, points),
            points,
            weight_n: 0.0,
            tree,
        };
        sample.pose(drawn.spread, &mut draws);
        sample.load(body_kg, drawn.rod_kg, &mut draws);
        sample
    }

    fn pose(&mut self, spread: f64, draws: &mut Random) {
        for _ in 0..self.tree.links {
            let direction = (DVec3::NEG_Z + vector(draws, spread)).normalize();
            self.links.span_m.push(LENGTH_M * direction);
            self.links
                .rate_m_s
                .push(vector(draws, 1.0).cross(direction));
        }
        for _ in 0..self.tree.carried_by.len() {
            self.bodies.push(BodyState {
                attitude: DQuat::from_scaled_axis(vector(draws, 1.0)),
                rate_rad_s: vector(draws, 0.5),
                ..BodyState::default()
            });
        }
        for _ in 0..self.tree.limbs.len() {
            self.offsets.push(LimbOffsets {
                proximal_m: vector(draws, 0.5),
                distal_m: vector(draws, 0.5),
            });
        }
    }

    /// Weights, and besides them forces about half as large in random directions.
    fn load(&mut self, body_kg: &[f64], rod_kg: f64, draws: &mut Random) {
        let mut push = |kg: f64| kg * (GRAVITY * DVec3::NEG_Z + vector(draws, 5.0));
        for point in &mut self.loads.point_n {
            *point = push(rod_kg);
            self.weight_n += rod_kg * GRAVITY;
        }
        let mut carried = vec![CarriedMass::default(); body_kg.len()];
        for (limb, offsets) in self.tree.limbs.iter().zip(&self.offsets) {
            carried[limb.child].add(0.5 * rod_kg, offsets.distal_m);
            if let Some(parent) = limb.parent {
                carried[parent].add(0.5 * rod_kg, offsets.proximal_m);
            }
        }
        for (index, kg) in body_kg.iter().enumerate() {
            let (carried, state) = (carried[index], self.bodies[index]);
            let own = *kg * DMat3::from_diagonal(DVec3::new(0.3, 0.2, 0.4));
            let inertia = own + carried.inertia_kg_m2;
            let moment = carried.first_moment_kg_m;
            let rate = state.rate_rad_s;
            let force = push(*kg) - state.attitude * rate.cross(rate.cross(moment));
            let torque = 0.1 * push(*kg) - rate.cross(inertia * rate);
            self.loads.bodies[index] = BodyLoad {
                mass: BodyBlock::mass(kg + carried.mass_kg, moment, inertia, state.attitude),
                load: Twist {
                    linear: force,
                    angular: torque,
                },
                turns: true,
            };
            self.weight_n += kg * GRAVITY;
        }
        for acceleration in &mut self.loads.anchor_m_s2 {
            *acceleration = vector(draws, 2.0);
        }
    }

    /// Makes a body a point of this mass, with all its tethers at its centre.
    fn be_point(&mut self, body: usize, kg: f64) {
        self.loads.bodies[body].mass = BodyBlock {
            linear: DMat3::from_diagonal(DVec3::splat(kg)),
            ..BodyBlock::ZERO
        };
        self.loads.bodies[body].load.angular = DVec3::ZERO;
        self.loads.bodies[body].turns = false;
        self.tree.knots[body] = true;
        for (limb, offsets) in self.tree.limbs.iter().zip(&mut self.offsets) {
            if limb.parent == Some(body) {
                offsets.proximal_m = DVec3::ZERO;
            }
            if limb.child == body {
                offsets.distal_m = DVec3::ZERO;
            }
        }
    }

    fn solve(&self) -> (ForwardDynamics, Accelerations) {
        let mut dynamics = ForwardDynamics::new(&self.tree);
        let mut out = Accelerations::new(&self.tree, self.points);
        dynamics
            .solve(
                &self.tree,
                (&self.links, &self.bodies),
                &self.offsets,
                &self.loads,
                &mut out,
            )
            .expect("everything has a mass");
        (dynamics, out)
    }

    /// The largest joint torque left by the solution, over weight times length.
    fn residual(&self) -> f64 {
        let (_, mut out) = self.solve();
        let spans = out.span_m_s2.iter_mut();
        for (span, (d, rate)) in spans.zip(self.links.span_m.iter().zip(&self.links.rate_m_s)) {
            // Only what a joint can do: across the link as solved, along it as the length asks.
            let along = (span.dot(*d) + rate.length_squared()) / (LENGTH_M * LENGTH_M);
            *span -= along * d;
        }
        let left = inverse_dynamics(
            &self.tree,
            (&self.links, &self.bodies),
            &self.offsets,
            &self.loads,
            &out,
        );
        left.largest_n_m(LENGTH_M) / (self.weight_n * LENGTH_M)
    }
}

fn topology(ropes: &[Rope], bodies: usize) -> (Topology, usize) {
    let mut lines = Vec::new();
    let mut points = 0;
    for (from, to, links) in ropes {
        lines.push(Line {
            first_point: points,
            nodes: links - 1,
            first_state: 0,
            from: *from,
            to: *to,
        });
        points += links + 1;
    }
    let site = BodySite {
        first_state: 0,
        turns: true,
        arm_m: 1.0,
    };
    let topology = Topology {
        lines,
        bodies: vec![site; bodies],
        points,
        coordinates: 0,
    };
    (topology, points)
}

/// A chain of `links` from an anchor, or from a heavy base that is free, with a tip.
fn chain(links: usize, tip_kg: f64, is_free: bool, drawn: Drawn) -> Sample {
    if is_free {
        let ropes = [(End::OnBody(0), End::OnBody(1), links)];
        Sample::new(&ropes, &[50.0, tip_kg], drawn)
    } else {
        Sample::new(&[(End::Held, End::OnBody(0), links)], &[tip_kg], drawn)
    }
}

/// Written as differences of full inertias the recursion can lose all digits on chains of 100 links. Here
/// it is round-off; of tips 200 000 times as heavy as a link, what round-off makes of that ratio.
#[test]
fn inverse_dynamics_of_forward_dynamics_leaves_no_torque() {
    for links in [20, 100, 1000] {
        let mut worst = [0.0_f64; 2];
        for (number, tip_kg) in [1e-3, 0.05, 10.0, 1e4].into_iter().enumerate() {
            for (spread, is_free) in [(0.0, false), (0.3, false), (0.3, true), (3.0, true)] {
                let drawn = Drawn {
                    spread,
                    rod_kg: 0.05,
                    seed: number as u64 + 17,
                };
                let residual = chain(links, tip_kg, is_free, drawn).residual();
                let of = &mut worst[usize::from(tip_kg > 100.0)];
                *of = of.max(residual);
            }
        }
        let [light, heavy] = worst;
        println!("{links} links: tips to 10 kg {light:.1e}, of 10 t {heavy:.1e}");
        assert!(light < 1e-13, "{links} links: {light:e}");
        assert!(heavy < 1e-10, "{links} links: {heavy:e}");
    }
}

/// A knot of a milligram between two chains is no worse than a joint between links.
#[test]
fn a_light_knot_carries_a_heavy_tip() {
    let ropes = [
        (End::Held, End::OnBody(0), 4),
        (End::OnBody(0), End::OnBody(1), 4),
    ];
    let drawn = Drawn {
        spread: 0.3,
        rod_kg: 1e-3,
        seed: 8,
    };
    let mut sample = Sample::new(&ropes, &[1e-6, 1e3], drawn);
    sample.be_point(0, 1e-6 + 1e-3);
    let residual = sample.residual();
    println!("{residual:.1e}");
    assert!(residual < 1e-9, "{residual:e}");
}

/// With forces and torques on everything a tree of several limbs closes as a chain does.
#[test]
fn a_tree_of_branches_leaves_no_torque() {
    let at = End::OnBody;
    let ropes = [
        (at(0), at(1), 12),
        (at(2), at(1), 5),
        (at(1), at(3), 1),
        (at(3), at(4), 7),
    ];
    let kg = [40.0, 100.0, 8.0, 12.0, 0.3];
    let drawn = Drawn {
        spread: 0.8,
        rod_kg: 0.2,
        seed: 5,
    };
    let residual = Sample::new(&ropes, &kg, drawn).residual();
    assert!(residual < 1e-13, "{residual:e}");
    let held = [(at(0), End::Held, 6), (at(0), at(1), 4), (at(2), at(0), 3)];
    let residual = Sample::new(&held, &kg[..3], drawn).residual();
    assert!(residual < 1e-13, "{residual:e}");
}

/// A plumb chain at rest: every rod carries what hangs below its middle.
#[test]
fn a_hanging_chain_carries_what_is_below() {
    let drawn = Drawn {
        spread: 0.0,
        rod_kg: 0.2,
        seed: 1,
    };
    let mut sample = chain(8, 3.0, false, drawn);
    for rate in &mut sample.links.rate_m_s {
        *rate = DVec3::ZERO;
    }
    let weight = |kg: f64| kg * GRAVITY * DVec3::NEG_Z;
    sample.loads.point_n.fill(weight(0.2));
    sample.loads.anchor_m_s2.fill(DVec3::ZERO);
    sample.offsets.fill(LimbOffsets::default());
    sample.bodies[0].rate_rad_s = DVec3::ZERO;
    let inertia = DMat3::IDENTITY;
    sample.loads.bodies[0] = BodyLoad {
        mass: BodyBlock::mass(3.1, DVec3::ZERO, inertia, sample.bodies[0].attitude),
        load: Twist {
            linear: weight(3.1),
            angular: DVec3::ZERO,
        },
        turns: true,
    };
    let (_, out) = sample.solve();
    for (k, tension) in out.tension_n.iter().enumerate() {
        let below_kg = 3.0 + 0.2 * (7.5 - k as f64);
        assert!((tension - below_kg * GRAVITY).abs() < 1e-12, "{k}");
        assert!(out.span_m_s2[k].length() < 1e-13);
    }
}

/// A uniform rod on a pivot starts to fall with 3/2 g sin(angle) at its end, and a quarter of its weight
/// stays on the pivot when it is level.
#[test]
fn a_falling_rod_has_its_closed_form() {
    let drawn = Drawn {
        spread: 0.0,
        rod_kg: 2.0,
        seed: 1,
    };
    let mut sample = chain(1, 1e-9, false, drawn);
    sample.links.span_m[0] = LENGTH_M * DVec3::X;
    sample.links.rate_m_s[0] = DVec3::ZERO;
    sample.loads.anchor_m_s2.fill(DVec3::ZERO);
    sample.offsets.fill(LimbOffsets::default());
    sample.bodies[0].rate_rad_s = DVec3::ZERO;
    sample.loads.bodies[0] = BodyLoad {
        mass: BodyBlock::mass(1.0, DVec3::ZERO, DMat3::IDENTITY, DQuat::IDENTITY),
        load: Twist {
            linear: GRAVITY * DVec3::NEG_Z,
            angular: DVec3::ZERO,
        },
        turns: false,
    };
    let (_, out) = sample.solve();
    assert!((out.span_m_s2[0] - 1.5 * GRAVITY * DVec3::NEG_Z).length() < 1e-14);
    assert!(out.tension_n[0].abs() < 1e-14);
}

/// An elastic link passes on its force and nothing else: two masses on it fall apart as Newton says.
#[test]
fn an_elastic_link_has_no_constraint() {
    let drawn = Drawn {
        spread: 0.5,
        rod_kg: 0.6,
        seed: 3,
    };
    let mut sample = chain(3, 4.0, true, drawn);
    for kind in &mut sample.tree.kinds {
        kind.stretch = Stretch::Elastic;
    }
    let (_, out) = sample.solve();
    // The consistent mass matrix of three rods, by hand: rows of the two joints.
    let (m, c) = (0.6, -0.6 / 6.0);
    let a: Vec<DVec3> = (1..=2).map(|k| out.point_m_s2[k]).collect();
    let first = a[0] - out.span_m_s2[0];
    let last = a[1] + out.span_m_s2[2];
    let ends = [first, a[0], a[1], last];
    for k in 1..=2 {
        let left = m * ends[k] + c * (2.0 * ends[k] - ends[k - 1] - ends[k + 1]);
        assert!((left - sample.loads.point_n[k]).length() < 1e-12);
    }
    assert_eq!(out.tension_n, [0.0; 3]);
}
