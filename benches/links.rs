//! What the recursion of the second formulation costs per link: forward dynamics without the forces, of a
//! chain of rods from an anchor with a heavy tip, in random poses.
//!
//! `cargo bench --bench links` prints a table with the exponent of cost against length;
//! `cargo bench --bench links -- --peer` prints lines `link,<n>,<ns per link>` for
//! `benches/peers/pinocchio_chain.py`. One core, release build; every figure is the least of several repeats.

#![allow(clippy::expect_used, clippy::panic, reason = "a bench may fail loudly")]

use aerobot_engine::run_folder::thread_cpu_time;
use aerobot_systems::denoc::articulated_link::Stretch;
use aerobot_systems::denoc::forward_dynamics::{Accelerations, BodyLoad, ForwardDynamics, Loads};
use aerobot_systems::denoc::kinematics::{BodyState, LimbOffsets, LinkStates};
use aerobot_systems::denoc::tree::{KinematicTree, LinkKind};
use aerobot_systems::linearised_motion::body_block::{BodyBlock, Twist};
use aerobot_systems::linearised_motion::topology::{BodySite, End, Line, Topology};
use glam::{DMat3, DQuat, DVec3};

const SIZES: [usize; 7] = [20, 50, 100, 300, 1000, 3000, 10_000];
const REPEATS: usize = 15;
const GRAVITY_M_S2: f64 = 8.87;
const LENGTH_M: f64 = 10.0;
const ROD_KG: f64 = 0.05;
const TIP_KG: f64 = 10.0;

fn main() {
    let is_peer = std::env::args().any(|argument| argument == "--peer");
    let costs: Vec<(usize, f64)> = SIZES.iter().map(|n| (*n, ns_per_link(*n))).collect();
    if is_peer {
        for (n, ns) in costs {
            println!("link,{n},{ns:.2}");
        }
        return;
    }
    println!("| links | forward dynamics, ns per link |");
    println!("|---:|---:|");
    for (n, ns) in &costs {
        println!("| {n} | {ns:.1} |");
    }
    println!(
        "\nexponent of the cost against the number of links: {:.3}",
        exponent(&costs)
    );
}

/// Slope of log cost of the whole against log n, by least squares.
fn exponent(costs: &[(usize, f64)]) -> f64 {
    let points: Vec<(f64, f64)> = costs
        .iter()
        .map(|(n, ns)| ((*n as f64).ln(), (*n as f64 * ns).ln()))
        .collect();
    let count = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / count;
    let covariance: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let variance: f64 = points.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    covariance / variance
}

fn ns_per_link(links: usize) -> f64 {
    let mut chain = Chain::new(links);
    let calls = (2_000_000 / links).max(20);
    chain.solve();
    let least = (0..REPEATS)
        .map(|_| {
            let start = thread_cpu_time();
            for _ in 0..calls {
                chain.solve();
            }
            (thread_cpu_time() - start).as_nanos() as f64 / calls as f64
        })
        .fold(f64::INFINITY, f64::min);
    least / links as f64
}

struct Chain {
    tree: KinematicTree,
    links: LinkStates,
    bodies: [BodyState; 1],
    offsets: [LimbOffsets; 1],
    loads: Loads,
    dynamics: ForwardDynamics,
    out: Accelerations,
}

impl Chain {
    fn new(links: usize) -> Self {
        let topology = Topology {
            lines: vec![Line {
                first_point: 0,
                nodes: links - 1,
                first_state: 0,
                from: End::Held,
                to: End::OnBody(0),
            }],
            bodies: vec![BodySite {
                first_state: 0,
                turns: true,
                arm_m: 0.1,
            }],
            points: links + 1,
            coordinates: 0,
        };
        let kind = LinkKind {
            length_m: LENGTH_M,
            length_rate_m_s: 0.0,
            coupling_kg: -ROD_KG / 6.0,
            joint_mass_kg: ROD_KG,
            stretch: Stretch::Rigid,
        };
        let tree = KinematicTree::new(&topology, &[kind], &[]);
        let mut draws = Draws(1);
        let mut states = LinkStates::default();
        for _ in 0..links {
            let direction = (DVec3::NEG_Z + draws.vector(0.3)).normalize();
            states.span_m.push(LENGTH_M * direction);
            states.rate_m_s.push(draws.vector(1.0).cross(direction));
        }
        let mut loads = Loads::new(&tree, links + 1);
        loads.point_n.fill(ROD_KG * GRAVITY_M_S2 * DVec3::NEG_Z);
        let kg = TIP_KG + 0.5 * ROD_KG;
        loads.bodies[0] = BodyLoad {
            mass: BodyBlock::mass(kg, DVec3::ZERO, 0.1 * DMat3::IDENTITY, DQuat::IDENTITY),
            load: Twist {
                linear: kg * GRAVITY_M_S2 * DVec3::NEG_Z,
                angular: DVec3::ZERO,
            },
            turns: true,
        };
        Self {
            dynamics: ForwardDynamics::new(&tree),
            out: Accelerations::new(&tree, links + 1),
            tree,
            links: states,
            bodies: [BodyState::default()],
            offsets: [LimbOffsets::default()],
            loads,
        }
    }

    fn solve(&mut self) {
        self.dynamics
            .solve(
                &self.tree,
                (&self.links, &self.bodies),
                &self.offsets,
                &self.loads,
                &mut self.out,
            )
            .expect("everything has a mass");
    }
}

/// Numbers between -1 and 1, the same in every run (Knuth's MMIX generator).
struct Draws(u64);

impl Draws {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn vector(&mut self, size: f64) -> DVec3 {
        size * DVec3::new(self.next(), self.next(), self.next())
    }
}
