//! Closed loops against Newton's and Euler's equations of every part, and against the multifilar pendulum.

use glam::{DMat3, DQuat, DVec3};

use super::*;
use crate::denoc::articulated_link::Stretch;
use crate::denoc::forward_dynamics::BodyLoad;
use crate::denoc::tree::LinkKind;
use crate::dynamics::rigid_body::CarriedMass;
use crate::linearised_motion::body_block::BodyBlock;
use crate::linearised_motion::topology::{BodySite, End, Line, Topology};
use crate::nonlinear_solver::test_support::Random;

const LENGTH_M: f64 = 10.0;

/// A tether: its ends, the offsets of these on bodies (m, body frame), its number of links.
type Rope = ((End, DVec3), (End, DVec3), usize);

/// A body: mass (kg), moments of inertia (kg m^2), force (N, inertial frame) and torque (N m, body frame).
struct Body {
    kg: f64,
    inertia: DMat3,
    force: DVec3,
    torque: DVec3,
    state: BodyState,
}

struct Case {
    tree: KinematicTree,
    links: LinkStates,
    bodies: Vec<Body>,
    states: Vec<BodyState>,
    offsets: Offsets,
    loads: Loads,
    found: Accelerations,
}

impl Case {
    /// Solves for ropes of links with these spans and rates, their masses `link_kg` (rods) and loads on joints.
    fn new(
        ropes: &[Rope],
        bodies: Vec<Body>,
        link_kg: f64,
        mut link: impl FnMut(usize) -> (DVec3, DVec3),
        mut load: impl FnMut() -> DVec3,
    ) -> Self {
        let topology = topology(ropes, bodies.len());
        let kind = LinkKind {
            length_m: LENGTH_M,
            length_rate_m_s: 0.0,
            coupling_kg: -link_kg / 6.0,
            joint_mass_kg: link_kg,
            stretch: Stretch::Rigid,
        };
        let tree = KinematicTree::new(&topology, &vec![kind; ropes.len()], &[]);
        let mut offsets = Offsets::default();
        let mut carried = vec![CarriedMass::default(); bodies.len()];
        for limb in &tree.limbs {
            let ((from, at_from), (to, at_to), _) = ropes[limb.line];
            for (end, at) in [(from, at_from), (to, at_to)] {
                if let End::OnBody(body) = end {
                    carried[body].add(0.5 * link_kg, at);
                }
            }
            let (near, far) = if limb.is_from_outward {
                (at_from, at_to)
            } else {
                (at_to, at_from)
            };
            let is_cut = limb.child >= bodies.len();
            offsets.limbs.push(LimbOffsets {
                proximal_m: near,
                distal_m: if is_cut { DVec3::ZERO } else { far },
            });
            if is_cut {
                offsets.ties_m.push(far);
            }
        }
        let mut loads = Loads::new(&tree, topology.points);
        for point in &mut loads.point_n {
            *point = load();
        }
        let kg = 0.3;
        for (index, closure) in tree.closures.iter().enumerate() {
            loads.bodies[closure.tip].mass = BodyBlock::point(kg);
            if let Some(body) = closure.onto {
                carried[body].add(-kg, offsets.ties_m[index]);
            }
        }
        for (index, body) in bodies.iter().enumerate() {
            loads.bodies[index] = body.load(&carried[index]);
        }
        let mut states: Vec<BodyState> = bodies.iter().map(|body| body.state).collect();
        states.resize(tree.carried_by.len(), BodyState::default());
        let (span_m, rate_m_s) = (0..tree.links).map(&mut link).unzip();
        let links = LinkStates { span_m, rate_m_s };
        let mut found = Accelerations::new(&tree, topology.points);
        let motion = Motion {
            links: &links,
            bodies: &states,
            ties: &[],
        };
        dynamics(&tree)
            .solve(&tree, motion, &offsets, &loads, &mut found)
            .expect("everything has a mass");
        Self {
            tree,
            links,
            bodies,
            states,
            offsets,
            loads,
            found,
        }
    }

    /// The tensions that are found where the lines were seen slack before, so that no state of self-stress is known.
    fn tensions_after_slack(&self) -> Vec<f64> {
        let mut dynamics = dynamics(&self.tree);
        let slack = LinkStates {
            span_m: self.links.span_m.iter().map(|span| 0.99 * *span).collect(),
            ..self.links.clone()
        };
        let mut found = self.found.clone();
        for links in [&slack, &self.links] {
            let motion = Motion {
                links,
                bodies: &self.states,
                ties: &[],
            };
            dynamics
                .solve(&self.tree, motion, &self.offsets, &self.loads, &mut found)
                .expect("everything has a mass");
        }
        found.tension_n
    }

    /// The largest thing that is left of Newton's and Euler's equations, of the links' lengths, and of what keeps
    /// tips at their places.
    fn residual(&self, link_kg: f64) -> f64 {
        let found = &self.found;
        let place = |body: usize, r: DVec3| {
            let (state, motion) = (&self.states[body], found.bodies[body]);
            let w = state.rate_rad_s;
            motion.linear + state.attitude * (motion.angular.cross(r) + w.cross(w.cross(r)))
        };
        let mut force: Vec<DVec3> = self.bodies.iter().map(|body| body.force).collect();
        let mut torque: Vec<DVec3> = self.bodies.iter().map(|body| body.torque).collect();
        let mut worst = 0.0_f64;
        let mut see = |left: f64| worst = worst.max(left);
        for (index, limb) in self.tree.limbs.iter().enumerate() {
            let tie = self
                .tree
                .closures
                .iter()
                .position(|closure| closure.limb == index);
            let far = match tie {
                None => (Some(limb.child), self.offsets.limbs[index].distal_m),
                Some(tie) => (self.tree.closures[tie].onto, self.offsets.ties_m[tie]),
            };
            let near = (limb.parent, self.offsets.limbs[index].proximal_m);
            let mut at = match near {
                (Some(body), r) => place(body, r),
                (None, _) => self.loads.anchor_m_s2[index],
            };
            let last = limb.links.len() - 1;
            let mut pulled = DVec3::ZERO;
            for (k, link) in limb.links.clone().enumerate() {
                let (span, rate) = (self.links.span_m[link], self.links.rate_m_s[link]);
                let change = found.span_m_s2[link];
                see((change.dot(span) + rate.length_squared()).abs() / LENGTH_M);
                let next = at + change;
                // A rod: its halves' inertia at the ends, less a sixth between them, and its tension.
                let between = -link_kg / 6.0 * change + found.tension_n[link] / LENGTH_M * span;
                let (on_near, on_far) = (between, -between);
                if k == 0 {
                    let half = -0.5 * link_kg * at;
                    push(near, on_near + half, &self.states, &mut force, &mut torque);
                } else {
                    let point = limb.distal_point(k - 1);
                    let left = link_kg * at - self.loads.point_n[point] - pulled - on_near;
                    see(left.length());
                }
                if k == last {
                    let half = -0.5 * link_kg * next;
                    push(far, on_far + half, &self.states, &mut force, &mut torque);
                }
                (at, pulled) = (next, on_far);
            }
            if let (Some(body), r) = far {
                see((at - place(body, r)).length());
            } else {
                see(at.length());
            }
        }
        for (index, body) in self.bodies.iter().enumerate() {
            let (motion, w) = (found.bodies[index], body.state.rate_rad_s);
            see((body.kg * motion.linear - force[index]).length());
            let gyroscopic = w.cross(body.inertia * w);
            see((body.inertia * motion.angular + gyroscopic - torque[index]).length());
        }
        worst
    }
}

/// For a tree of limbs that give alike.
fn dynamics(tree: &KinematicTree) -> ClosedDynamics {
    let elasticity = LimbElasticity {
        compliance_m_n: 1e-4,
        retardation_s: 0.0,
    };
    ClosedDynamics::new(tree, vec![elasticity; tree.limbs.len()])
}

/// Puts a force (inertial frame) on a place of a body.
fn push(
    (body, r): (Option<usize>, DVec3),
    pull: DVec3,
    states: &[BodyState],
    force: &mut [DVec3],
    torque: &mut [DVec3],
) {
    if let Some(body) = body {
        force[body] += pull;
        torque[body] += r.cross(states[body].attitude.conjugate() * pull);
    }
}

impl Body {
    fn load(&self, carried: &CarriedMass) -> BodyLoad {
        let (moment, rate) = (carried.first_moment_kg_m, self.state.rate_rad_s);
        let inertia = self.inertia + carried.inertia_kg_m2;
        let attitude = self.state.attitude;
        BodyLoad {
            mass: BodyBlock::mass(self.kg + carried.mass_kg, moment, inertia, attitude),
            load: Twist {
                linear: self.force - attitude * rate.cross(rate.cross(moment)),
                angular: self.torque - rate.cross(inertia * rate),
            },
            turns: true,
        }
    }
}

fn topology(ropes: &[Rope], bodies: usize) -> Topology {
    let mut topology = Topology {
        bodies: vec![
            BodySite {
                first_state: 0,
                turns: true,
                arm_m: 1.0
            };
            bodies
        ],
        ..Topology::default()
    };
    for ((from, _), (to, _), links) in ropes {
        topology.lines.push(Line {
            first_point: topology.points,
            nodes: links - 1,
            first_state: 0,
            from: *from,
            to: *to,
        });
        topology.points += links + 1;
    }
    topology
}

/// Several loops through several bodies and anchors, with random places, rates and loads.
#[test]
fn every_part_obeys_newton_and_euler() {
    use End::{Held, OnBody};
    let mut random = Random::new(11);
    let mut draw = |size: f64| size * DVec3::new(random.signed(), random.signed(), random.signed());
    let graph = [
        (Held, OnBody(0), 3),
        (OnBody(0), OnBody(1), 4),
        (OnBody(0), OnBody(1), 2),
        (OnBody(1), OnBody(2), 5),
        (OnBody(2), OnBody(0), 3),
        (OnBody(2), Held, 6),
        (OnBody(3), OnBody(4), 1),
        (OnBody(4), OnBody(3), 3),
        (Held, Held, 4),
    ];
    let ropes: Vec<Rope> = graph
        .iter()
        .map(|(from, to, links)| ((*from, draw(0.8)), (*to, draw(0.8)), *links))
        .collect();
    let bodies = (0..5)
        .map(|index| Body {
            kg: 8.0 + 5.0 * f64::from(index),
            inertia: DMat3::from_diagonal(DVec3::new(3.0, 4.0, 5.0)),
            force: draw(60.0),
            torque: draw(5.0),
            state: BodyState {
                attitude: DQuat::from_scaled_axis(draw(1.0)),
                rate_rad_s: draw(0.7),
                ..BodyState::default()
            },
        })
        .collect();
    let mut second = Random::new(5);
    let mut vector =
        |size: f64| size * DVec3::new(second.signed(), second.signed(), second.signed());
    let mut third = Random::new(7);
    let case = Case::new(
        &ropes,
        bodies,
        0.2,
        |_| {
            let direction = (DVec3::NEG_Z + vector(0.6)).normalize();
            (LENGTH_M * direction, vector(1.0).cross(direction))
        },
        || DVec3::new(third.signed(), third.signed(), third.signed() - 2.0),
    );
    assert_eq!(case.tree.closures.len(), 5);
    let residual = case.residual(0.2);
    assert!(residual < 1e-10, "{residual:e}");
}

/// A body on a ring of `count` rods without mass, turned by `psi` and turning at `rate`: its angular
/// acceleration and the sum of tensions by hand. With h the height between the rings of radius a = b = 1 m,
/// `s = dz/dpsi = sin(psi)/h`: `(I + m s^2) psi'' = -m s (g + s_psi psi'^2)`.
#[test]
fn a_multifilar_pendulum_accelerates_as_lagrange_says() {
    let (kg, moment, gravity) = (20.0, 61.0, 8.87);
    for count in [2, 3, 4, 6] {
        let (psi, rate) = (0.3_f64, 0.2);
        let h = (LENGTH_M * LENGTH_M - 2.0 * (1.0 - psi.cos())).sqrt();
        let s = psi.sin() / h;
        let slope = psi.cos() / h + psi.sin() * psi.sin() / h.powi(3);
        let expected = -kg * s * (gravity + slope * rate * rate) / (moment + kg * s * s);
        let lift = kg * (gravity + s * expected + slope * rate * rate);
        let angle = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
        let at = |a: f64| DVec3::new(a.cos(), a.sin(), 0.0);
        let ropes: Vec<Rope> = (0..count)
            .map(|k| ((End::Held, at(angle(k))), (End::OnBody(0), at(angle(k))), 1))
            .collect();
        let state = BodyState {
            attitude: DQuat::from_rotation_z(psi),
            rate_rad_s: rate * DVec3::Z,
            ..BodyState::default()
        };
        let body = Body {
            kg,
            inertia: DMat3::from_diagonal(DVec3::new(30.0, 31.0, moment)),
            force: -kg * gravity * DVec3::Z,
            torque: DVec3::ZERO,
            state,
        };
        let span = |k: usize| {
            let a = angle(k);
            let turning = rate * DVec3::Z.cross(at(a + psi));
            (
                at(a + psi) - at(a) - h * DVec3::Z,
                turning + s * rate * DVec3::Z,
            )
        };
        let case = Case::new(&ropes, vec![body], 0.0, span, || DVec3::ZERO);
        let motion = case.found.bodies[0];
        let error = (motion.angular - expected * DVec3::Z).length();
        assert!(error < 1e-11, "{count}: {error:e}");
        // Also of four and six, where one and three are redundant, all tethers carry the same: where states of
        // self-stress say so, and, as far as round-off over eps lets it, where what became singular on the way is
        // regularised.
        let share = lift / count as f64 * LENGTH_M / h;
        for (tensions, tolerance) in [
            (&case.found.tension_n, 1e-5),
            (&case.tensions_after_slack(), 1e-4),
        ] {
            let errors = tensions.iter().map(|tension| (tension / share - 1.0).abs());
            let error = errors.fold(0.0, f64::max);
            assert!(error < tolerance, "{count}: {error:e}");
        }
    }
}
