//! From a steady state to its modes.

use aerobot_components::run::Formulation;
use aerobot_components::tether::Tether;
use aerobot_systems::dynamics::link_mechanism::LinkMechanism;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fault::Fault;
use aerobot_systems::modes::Complex;
use aerobot_systems::modes::cluster::separate;
use aerobot_systems::modes::eigenmodes::{Eigenmode, Method, slowest};
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;

use super::body_coordinates;
use super::closed_loop::{OpenLoop, has_loops, of_each_coordinate};
use super::joint_coordinates::JointWorld;
use super::linear_motion::LinearMotion;
use super::naming;
use super::neutral::{Candidate, candidates, independent};
use super::participation::Participants;
use super::sites::{SiteMotion, Sites};
use super::{Mode, ModeSolver, Modes, ModesRequest};
use crate::evaluation::{Evaluation, Integration, with_integration};
use crate::placement::tethered_systems;
use crate::scene::{Scene, SetupError};
use crate::stopping::owner_name;
use crate::trim::Trim;
use crate::world::EntityName;

/// Coordinates up to which all modes are found at once.
const FEW: usize = 150;
/// Coordinates that full matrices may have.
const MOST: usize = 2400;
/// Modes this much slower than a pendulum of all tethers in a row, which belong to what nothing restores.
const STANDSTILL: f64 = 0.02;
/// Modes this much slower are round-off.
const NOTHING: f64 = 5e-4;
/// Modes that are found besides, in place of such round-off.
const SPARE: usize = 8;
/// Relative difference of eigenvalues that count as equal.
const EQUAL: f64 = 1e-6;

/// Finds the modes about a state that is steady.
pub(super) fn search(
    world: &mut World,
    scene: &Scene,
    trim: Trim,
    request: &ModesRequest,
) -> Result<Modes, SetupError> {
    with_integration(world, |world, integration| {
        let Integration {
            evaluation,
            statics,
            state,
            trajectory,
            ..
        } = integration;
        let sites = Sites::of(world);
        let participants = Participants::of(world, scene, &sites);
        let mut found = Modes {
            trim,
            coordinates: 0,
            first_order_states: 0,
            modes: Vec::new(),
            neutral: Vec::new(),
            closed_loops: Vec::new(),
            notes: Vec::new(),
        };
        let is_rigid = scene.run.formulation == Formulation::Denoc
            && !scene.run.elastic_links
            && world.contains_resource::<LinkMechanism>();
        let outcome = if is_rigid {
            let mut links = JointWorld {
                world,
                evaluation,
                state: &mut **state,
                steady: &trajectory.state,
            };
            of_links(
                &mut links,
                (scene, &sites, &participants),
                request,
                &mut found,
            )
        } else {
            let forces = statics.as_mut().unwrap_or(evaluation);
            of_bodies(
                world,
                forces,
                (scene, &sites, &participants),
                request,
                &mut found,
            )
        };
        // The steady state could be evaluated before.
        let _ = state
            .scatter(world, &trajectory.state)
            .and_then(|()| evaluation.run(world));
        outcome.map(|()| found)
    })
    .unwrap_or_else(|| Err(SetupError::new("", "the simulation is busy", "")))
}

type Of<'a> = (&'a Scene, &'a Sites, &'a Participants);

fn of_bodies(
    world: &mut World,
    forces: &mut Evaluation,
    (scene, sites, participants): Of<'_>,
    request: &ModesRequest,
    found: &mut Modes,
) -> Result<(), SetupError> {
    // The springs of links that stretch are those of this evaluation.
    forces.run(world).map_err(|fault| refused(world, &fault))?;
    let coordinates = sites.pattern.dimension();
    let method = method(request, coordinates);
    let is_small = method == Method::Complete;
    check_size(if is_small { coordinates } else { 0 })?;
    let linearised = body_coordinates::linearise(world, forces, scene, sites, is_small);
    let (mut motion, first_order, slack) = linearised.map_err(|fault| refused(world, &fault))?;
    if slack > 0 {
        found.notes.push(format!(
            "{slack} segments of tethers are slack: they carry nothing in these modes"
        ));
    }
    found.coordinates = coordinates;
    found.first_order_states = first_order.len();
    let coordinates_of = |candidate: &Candidate| {
        let mut u = vec![0.0; coordinates];
        for (site, (linear, angular)) in sites.all.iter().zip(&candidate.motions) {
            linear.write_to_slice(&mut u[site.at..]);
            if site.turns {
                angular.write_to_slice(&mut u[site.at + 3..]);
            }
        }
        u
    };
    let still = neutral_directions(world, scene, sites, &motion, coordinates_of, found);
    let eigenmodes = solve(world, &mut motion, method, request.count, still)?;
    let motions: Vec<Vec<SiteMotion>> = eigenmodes
        .iter()
        .map(|mode| sites.motions(&mode.displacement))
        .collect();
    tell(&eigenmodes, motions, participants, found);
    let displaced = |along: &[Complex<f64>]| Ok(sites.motions(along));
    close_loops(
        world,
        (scene, sites),
        (&motion, &first_order),
        displaced,
        found,
    )
    .map_err(|fault| refused(world, &fault))
}

fn of_links(
    links: &mut JointWorld,
    (scene, sites, participants): Of<'_>,
    request: &ModesRequest,
    found: &mut Modes,
) -> Result<(), SetupError> {
    let basis = links.basis();
    let basis = basis.map_err(|fault| refused(links.world, &fault))?;
    check_size(basis.len())?;
    if basis.is_redundant() {
        found.notes.push(
            "rigid tethers are redundant here: the damping of waves in them is known to some 1e-4 only; \
             `LumpedMass` has it exactly"
                .to_owned(),
        );
    }
    let method = method(request, basis.len());
    let linearised = links.linearise(&basis);
    let (mut motion, first_order) = linearised.map_err(|fault| refused(links.world, &fault))?;
    found.coordinates = basis.len();
    found.first_order_states = first_order.len();
    let systems = candidates_of(links.world, scene, sites);
    let mut vectors = Vec::new();
    for candidate in &systems {
        vectors.push(links.rates_of(&basis, sites, &candidate.motions));
    }
    let mut next = vectors.into_iter();
    let still = neutral_directions(
        links.world,
        scene,
        sites,
        &motion,
        |_| next.next().unwrap_or_default(),
        found,
    );
    let eigenmodes = solve(links.world, &mut motion, method, request.count, still)?;
    let mut motions = Vec::with_capacity(eigenmodes.len());
    for mode in &eigenmodes {
        let moving = links.motions(&basis, sites, &mode.displacement);
        motions.push(moving.map_err(|fault| refused(links.world, &fault))?);
    }
    tell(&eigenmodes, motions, participants, found);
    if !has_loops(scene) {
        return Ok(());
    }
    let displaced = of_each_coordinate(basis.len(), |along| links.motions(&basis, sites, along));
    let mut displaced = displaced
        .map_err(|fault| refused(links.world, &fault))?
        .into_iter();
    let next = |_: &[Complex<f64>]| Ok(displaced.next().unwrap_or_default());
    close_loops(
        links.world,
        (scene, sites),
        (&motion, &first_order),
        next,
        found,
    )
    .map_err(|fault| refused(links.world, &fault))
}

/// Adds the loops that controllers close; `displaced` gives the motions of all sites along coordinates.
fn close_loops(
    world: &World,
    (scene, sites): (&Scene, &Sites),
    (motion, first_order): (&LinearMotion, &[Entity]),
    displaced: impl FnMut(&[Complex<f64>]) -> Result<Vec<SiteMotion>, Fault>,
    found: &mut Modes,
) -> Result<(), Fault> {
    if !has_loops(scene) {
        return Ok(());
    }
    let LinearMotion::Dense(motion) = motion else {
        found.notes.push(format!(
            "loops of controllers are closed for at most {FEW} coordinates; use fewer nodes, or `Denoc`"
        ));
        return Ok(());
    };
    let displaced = of_each_coordinate(motion.mass.nrows(), displaced)?;
    let open = OpenLoop {
        world,
        scene,
        sites,
        motion,
        first_order,
        displaced: &displaced,
    };
    let (loops, notes) = open.close();
    found.closed_loops = loops;
    found.notes.extend(notes);
    Ok(())
}

fn method(request: &ModesRequest, coordinates: usize) -> Method {
    match request.solver {
        ModeSolver::Complete => Method::Complete,
        ModeSolver::Slowest => Method::Slowest,
        ModeSolver::Automatic if coordinates <= FEW => Method::Complete,
        ModeSolver::Automatic => Method::Slowest,
    }
}

fn check_size(coordinates: usize) -> Result<(), SetupError> {
    if coordinates <= MOST {
        return Ok(());
    }
    Err(SetupError::new(
        "run.formulation",
        format!(
            "modes in full matrices are found for at most {MOST} coordinates, not {coordinates}"
        ),
        "use fewer nodes, or `LumpedMass` (`--formulation lumped-mass`)",
    ))
}

fn candidates_of(world: &World, scene: &Scene, sites: &Sites) -> Vec<Candidate> {
    candidates(sites, &tethered_systems(world, scene), |site| {
        world
            .get::<EntityName>(site.entity)
            .map_or_else(String::new, |name| name.0.to_string())
    })
}

/// Says which directions are neutral; how many eigenvalues are zero because of them.
fn neutral_directions(
    world: &World,
    scene: &Scene,
    sites: &Sites,
    motion: &LinearMotion,
    mut coordinates_of: impl FnMut(&Candidate) -> Vec<f64>,
    found: &mut Modes,
) -> usize {
    let mut zeros = 0;
    let mut known: Vec<Vec<f64>> = Vec::new();
    for candidate in candidates_of(world, scene, sites) {
        let u = coordinates_of(&candidate);
        let Some(also_undamped) = motion.is_neutral(&u) else {
            continue;
        };
        if let Some(u) = independent(u, &known) {
            known.push(u);
            zeros += 1 + usize::from(also_undamped);
            found.neutral.push(candidate.words);
        }
    }
    zeros
}

/// The slowest eigenmodes without so many that are zero.
fn solve(
    world: &mut World,
    motion: &mut LinearMotion,
    method: Method,
    count: usize,
    still: usize,
) -> Result<Vec<Eigenmode>, SetupError> {
    let slow_per_s = slow_per_s(world);
    let motion = motion.as_shift_invert();
    let all = slowest(motion, count + still + SPARE, slow_per_s, method);
    let all = all.map_err(|error| SetupError::new("entities", error.to_string(), ""))?;
    let mut left = still;
    let mut modes = Vec::with_capacity(count);
    for mode in all {
        let zeros = if mode.eigenvalue.im > 0.0 { 2 } else { 1 };
        let part = mode.eigenvalue.norm_sqr().sqrt() / slow_per_s;
        if part < NOTHING || part < STANDSTILL && left > 0 {
            left = left.saturating_sub(zeros);
        } else {
            modes.push(mode);
        }
    }
    modes.truncate(count);
    Ok(modes)
}

/// The pendulum of all tethers in a row, rad/s.
fn slow_per_s(world: &mut World) -> f64 {
    let gravity = world.resource::<EnvironmentModel>().gravity;
    let gravity_m_s2 = gravity.acceleration_m_s2(0.0).max(1e-3);
    let mut tethers = world.query::<&Tether>();
    let length_m: f64 = tethers.iter(world).map(|tether| tether.length_m).sum();
    // A balloon without a tether heaves in air that changes over kilometres.
    let length_m = if length_m > 0.0 { length_m } else { 1e4 };
    (gravity_m_s2 / length_m).sqrt()
}

/// Names and shares of modes.
fn tell(
    eigenmodes: &[Eigenmode],
    mut motions: Vec<Vec<SiteMotion>>,
    participants: &Participants,
    found: &mut Modes,
) {
    let mut first = 0;
    while first < eigenmodes.len() {
        let here = eigenmodes[first].eigenvalue;
        let equal = eigenmodes[first..].iter().take_while(|other| {
            (other.eigenvalue - here).norm_sqr() <= EQUAL * EQUAL * here.norm_sqr()
        });
        let end = first + equal.count().max(1);
        sort_equal(&mut motions[first..end], participants);
        first = end;
    }
    for (mode, motions) in eigenmodes.iter().zip(&motions) {
        let oscillates = mode.eigenvalue.im > 0.0;
        let shares = participants.shares(motions);
        let bodies = participants.body_motions(motions);
        found.modes.push(Mode {
            name: naming::name(&shares, &bodies, oscillates),
            growth_per_s: mode.eigenvalue.re,
            angular_frequency_rad_s: mode.eigenvalue.im,
            shares,
        });
    }
}

/// Of equal modes, those that move in the plane of x and z first.
fn sort_equal(motions: &mut [Vec<SiteMotion>], participants: &Participants) {
    if motions.len() < 2 {
        return;
    }
    let weighted: Vec<_> = motions
        .iter()
        .map(|motions| participants.weighted(motions))
        .collect();
    let in_plane = weighted[0].1.clone();
    let vectors: Vec<_> = weighted.into_iter().map(|(vector, _)| vector).collect();
    let Some(combination) = separate(&vectors, |place| in_plane[place]) else {
        return;
    };
    let given: Vec<Vec<SiteMotion>> = motions.to_vec();
    for (column, motions) in motions.iter_mut().enumerate() {
        for (site, motion) in motions.iter_mut().enumerate() {
            *motion = SiteMotion::default();
            for (row, given) in given.iter().enumerate() {
                let factor: Complex<f64> = combination[(row, column)];
                motion.linear.add(factor, &given[site].linear);
                motion.angular.add(factor, &given[site].angular);
            }
        }
    }
}

fn refused(world: &World, fault: &Fault) -> SetupError {
    let name = fault.entity.and_then(|entity| owner_name(world, entity));
    let path = name.map_or_else(|| "entities".to_owned(), |name| format!("entities.{name}"));
    SetupError::new(
        path,
        format!("close to the steady state: {}", fault.message),
        "",
    )
}
