//! The second formulation against trajectories of separate programs: uniform rods, massless links with
//! point masses at the joints, elastic rods; the comparison case (paper, sec. 4.2), a chain that branches, a
//! pendulum.
//!
//! A few values stand here; where `../shared/reference` exists, every second of the comparison case with
//! attachments at the centres is compared too.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::unreadable_literal,
    reason = "a test fails by panicking, and its digits come from a table"
)]

mod flight;

use aerobot::engine::recording::frame::{Frame, MemorySink, StateRow};
use flight::{assert_below, fly, fly_scene, reference_displacements};
use glam::{DQuat, DVec3};

const CENTRED: [&str; 5] = [
    "environment.atmosphere=Uniform(density_kg_m3: 0.8183)",
    "entities.tether.Tether.lumping=Interior",
    "entities.tether.Tether.from=(\"balloon\", (0, 0, 0))",
    "entities.tether.Tether.to=(\"gondola\", (0, 0, 0))",
    "run.formulation=Denoc",
];

/// Largest differences of a component of a displacement, m: from six printed digits at 100 s, and from a
/// reference file of `shared/` at every second (zero without it).
fn largest_differences(links: &str, file: &str, at_100_s: [DVec3; 2]) -> [f64; 2] {
    let integrator = "Adaptive(relative_tolerance: 1e-9)";
    let links = format!("run.links={links}");
    let integrator = format!("run.integrator={integrator}");
    let mut overrides = CENTRED.to_vec();
    overrides.extend([links.as_str(), integrator.as_str()]);
    let results = fly_scene("paper/comparison_900m.ron", &overrides);
    let tracks = ["balloon", "gondola"].map(|name| results.positions(name));
    let displaced = |which: usize, row: usize| tracks[which][row].1 - tracks[which][0].1;
    let [mut printed, mut every_second] = [0.0_f64; 2];
    for (which, expected) in at_100_s.into_iter().enumerate() {
        let difference = displaced(which, 100) - expected;
        printed = printed.max(difference.abs().max_element());
    }
    for (second, expected) in reference_displacements(file).into_iter().enumerate() {
        for (which, expected) in expected.into_iter().enumerate() {
            assert_eq!(tracks[which][second].0, second as f64);
            let difference = displaced(which, second) - expected;
            every_second = every_second.max(difference.abs().max_element());
        }
    }
    println!("{links}: printed digits {printed:.1e} m, every second {every_second:.1e} m");
    [printed, every_second]
}

const POINTS: [DVec3; 2] = [
    DVec3::new(52.084772, 42.215221, 65.085099),
    DVec3::new(52.307193, 44.467665, 65.087947),
];
const RODS: [DVec3; 2] = [
    DVec3::new(52.070530, 42.217018, 65.080316),
    DVec3::new(52.302461, 44.473286, 65.083175),
];

/// The printed digits end at 5e-7; a step may err by 1e-9, and what adds up stays below five of them.
#[track_caller]
fn assert_follows_the_reference(links: &str, file: &str, at_100_s: [DVec3; 2]) {
    let [printed, every_second] = largest_differences(links, file, at_100_s);
    assert!(printed < 1e-6, "{printed:e}");
    assert!(every_second < 5e-9, "{every_second:e}");
}

#[test]
fn val_point_mass_links_follow_the_reference() {
    assert_follows_the_reference("PointMass", "comparison_rigid_point_mass.csv", POINTS);
}

#[test]
fn val_rods_follow_the_reference() {
    assert_follows_the_reference("Rod", "comparison_rigid_rod.csv", RODS);
}

/// Which scene a case flies, from where its separate program starts.
#[derive(Clone, Copy)]
enum Flight {
    /// `paper/comparison_900m.ron`, from its equilibrium.
    Comparison,
    /// `examples/branched_chain.ron`, upright and with straight lines: not in equilibrium.
    BranchedChain,
    /// [`PENDULUM`].
    Pendulum,
}

/// A case that a separate program has computed (Python; every end of a link a free point, joints and
/// lengths held by Lagrange multipliers, positions and velocities projected every second, scipy's DOP853
/// at 1e-12 or 1e-13). It estimates its own error by tolerances a tenth as tight, and by a second program
/// in tree coordinates, at 2e-9 m, 1e-9 (quaternion) and 2e-8 N or better.
struct Case {
    flight: Flight,
    overrides: &'static [&'static str],
    /// Body, time in s, position in m with z above that of the start.
    positions_m: &'static [(&'static str, u32, [f64; 3])],
    /// Body, time in s, quaternion (body to inertial, scalar last), of either sign.
    attitudes: &'static [(&'static str, u32, [f64; 4])],
    /// Body, time in s, rates in the body frame.
    rates_rad_s: &'static [(&'static str, u32, [f64; 3])],
    /// Tether, link, time in s, tension; where a gust begins or ends, with the new wind.
    tensions_n: &'static [(&'static str, u32, u32, f64)],
    /// Time in s, kinetic energy, change of the mechanical energy since the start.
    energies_j: &'static [(u32, f64, f64)],
}

const POINT_MASSES: &str = "run.links=PointMass";
const INTERIOR: &str = "entities.tether.Tether.lumping=Interior";
const ADDED_MASS: &str = "entities.balloon.AddedMass=()";
const EXPONENTIAL: &str = "environment.atmosphere=Exponential(density_kg_m3: 0.8183, \
                           altitude_m: 56000, scale_height_m: 8200)";

/// Under the balloon of radius 3.687116138900974 m, which carries all that is in the scene.
const BRANCH_START: [&str; 7] = [
    "entities.balloon.Pose=(position_m: (0, 0, 56000))",
    "entities.gondola.Pose=(position_m: (-0.1, 0, 55695.812883861099))",
    "entities.a.Pose=(position_m: (0.3, 0, 55575.312883861099))",
    "entities.b.Pose=(position_m: (-0.55, 0.1, 55635.012883861099))",
    "entities.tether.Tether.start=Straight",
    "entities.line-a.Tether.start=Straight",
    "entities.line-b.Tether.start=Straight",
];

/// A body that turns about the end of a straight tether, which it leaves where it is.
const PENDULUM: &str = r#"(
    name: "pendulum",
    environment: (gravity: Constant(8.87), atmosphere: Vacuum),
    entities: {
        "anchor": (Fixed: (position_m: (0, 0, 1000))),
        "body": (
            Body: (mass_kg: 5, inertia: Box(0.5, 0.3, 0.8)),
            Pose: (position_m: (11.9, 3.95, 984.1080666151703)),
            Motion: (velocity_m_s: (0.105, 0.07, -0.035), rate_rad_s: (0.3, -0.2, 0.5)),
        ),
        "tether": (Tether: (
            from: ("anchor", Centre), to: ("body", (0.1, 0.05, 0.4)),
            length_m: 20, nodes: 5, diameter_m: 0.01, density_kg_m3: 1440,
            axial_stiffness_n: 2000, damping_n_s_m: 20, start: Straight,
        )),
    },
    run: (duration_s: 20, output_every_s: 1, record: (channels: All)),
)"#;

/// Flies a case and compares everything that its program has printed. Bounds are some times what the
/// program says of its own error; the integrator's is below that.
fn assert_follows(case: &Case) {
    let mut overrides = vec![
        "run.formulation=Denoc",
        "run.integrator=Adaptive(relative_tolerance: 1e-10)",
    ];
    if matches!(case.flight, Flight::BranchedChain) {
        overrides.extend(BRANCH_START);
    }
    overrides.extend(case.overrides);
    let (results, base_m) = match case.flight {
        Flight::Comparison => (fly_scene("paper/comparison_900m.ron", &overrides), 56_000.0),
        Flight::BranchedChain => (
            fly_scene("examples/branched_chain.ron", &overrides),
            56_000.0,
        ),
        Flight::Pendulum => (fly(PENDULUM, &overrides), 1000.0),
    };
    assert_same_states(case, &results, base_m);
    assert_same_tensions(case, &results);
    if !case.energies_j.is_empty() {
        assert_same_energies(case, &results);
    }
}

fn frame(results: &MemorySink, time_s: u32) -> &Frame {
    let frame = &results.frames[time_s as usize];
    assert_eq!(frame.time_s, f64::from(time_s));
    frame
}

fn state<'a>(results: &'a MemorySink, body: &str, time_s: u32) -> &'a StateRow {
    let mut states = frame(results, time_s).states.iter();
    states.find(|row| &*row.entity == body).unwrap()
}

fn assert_same_states(case: &Case, results: &MemorySink, base_m: f64) {
    let mut largest = [0.0_f64; 3];
    for (body, time_s, expected) in case.positions_m {
        let found = state(results, body, *time_s).position_m - base_m * DVec3::Z;
        largest[0] = largest[0].max(found.distance(DVec3::from_array(*expected)));
    }
    for (body, time_s, expected) in case.attitudes {
        let (found, expected) = (
            state(results, body, *time_s).rotation.unwrap().0,
            DQuat::from_array(*expected),
        );
        let same = (found - expected).length();
        let opposite = (found + expected).length();
        largest[1] = largest[1].max(same.min(opposite));
    }
    for (body, time_s, expected) in case.rates_rad_s {
        let found = state(results, body, *time_s).rotation.unwrap().1;
        largest[2] = largest[2].max(found.distance(DVec3::from_array(*expected)));
    }
    assert_below("position, m", largest[0], 5e-9);
    assert_below("quaternion", largest[1], 5e-9);
    assert_below("body rate, rad/s", largest[2], 5e-9);
}

fn assert_same_tensions(case: &Case, results: &MemorySink) {
    let mut largest = 0.0_f64;
    for (tether, link, time_s, expected) in case.tensions_n {
        let mut rows = frame(results, *time_s).segments.iter();
        let row = rows
            .find(|row| &*row.tether == *tether && row.segment == *link)
            .unwrap();
        largest = largest.max((row.tension_n - expected).abs());
    }
    assert_below("tension, N", largest, 1e-7);
}

fn assert_same_energies(case: &Case, results: &MemorySink) {
    let kinetic = results.channel("system", "kinetic_energy_j");
    let mechanical = results.channel("system", "mechanical_energy_j");
    let mut largest = 0.0_f64;
    for (time_s, expected_kinetic, expected_change) in case.energies_j {
        let row = *time_s as usize;
        let change = mechanical[row].1 - mechanical[0].1;
        largest = largest.max((kinetic[row].1 - expected_kinetic).abs());
        largest = largest.max((change - expected_change).abs());
    }
    // The mechanical energy counts from z = 0: 63 kJ, of which round-off is 7e-12 J.
    assert_below("energy, J", largest, 1e-8);
}

/// Uniform rods: places of balloon and gondola, attitudes, rates of the gondola, tensions.
#[test]
fn val_rods_with_offsets_follow_the_reference() {
    assert_follows(&OFFSET_RODS);
}

#[test]
fn val_point_masses_with_offsets_follow_the_reference() {
    assert_follows(&OFFSET_POINTS);
    assert_follows(&OFFSET_INTERIOR_POINTS);
}

#[test]
fn val_rods_below_a_balloon_with_added_mass_follow_the_reference() {
    assert_follows(&OFFSET_RODS_ADDED_MASS);
}

#[test]
fn val_a_branched_chain_of_rods_follows_the_reference() {
    assert_follows(&BRANCH_RODS);
}

#[test]
fn val_a_branched_chain_of_point_masses_follows_the_reference() {
    assert_follows(&BRANCH_POINTS);
}

/// Three turns in space at once, the energy, and the tension of links that a body jerks.
#[test]
fn val_a_pendulum_of_rods_follows_the_reference() {
    assert_follows(&PENDULUM_RODS);
}

/// Slack, snaps and dampers in the first milliseconds, then the swing: the separate program locates every
/// change.
#[test]
fn val_a_pendulum_of_elastic_rods_follows_the_reference() {
    assert_follows(&PENDULUM_ELASTIC_RODS);
}

/// Uniform rods, tethers attached off the centres, exponential density.
const OFFSET_RODS: Case = Case {
    flight: Flight::Comparison,
    overrides: &[EXPONENTIAL],
    positions_m: &[
        (
            "balloon",
            20,
            [33.14614896218, 1.904072539069, -0.1671362516953],
        ),
        (
            "balloon",
            60,
            [58.1556190599, 46.16936083909, 25.91106661223],
        ),
        (
            "balloon",
            100,
            [51.58065700406, 42.40355826491, 44.8774928092],
        ),
        (
            "gondola",
            20,
            [10.34874829599, 0.1628072737122, -903.9303277758],
        ),
        (
            "gondola",
            60,
            [56.48986788607, 58.94516850269, -878.0526431767],
        ),
        (
            "gondola",
            100,
            [51.38528058378, 44.69702319265, -859.1751193087],
        ),
    ],
    attitudes: &[
        (
            "balloon",
            60,
            [
                0.006405419018102,
                -0.0001869603742119,
                0.0003594601429288,
                0.9999794030086,
            ],
        ),
        (
            "balloon",
            100,
            [
                0.001761585039938,
                0.0008697560039286,
                0.0003885695138878,
                0.9999979946762,
            ],
        ),
        (
            "gondola",
            60,
            [
                0.007260862821956,
                0.0002551334878672,
                0.0004746782150949,
                0.999973494378,
            ],
        ),
        (
            "gondola",
            100,
            [
                0.00127386430279,
                -0.0005582166712429,
                0.0005446282237122,
                0.9999988845214,
            ],
        ),
    ],
    rates_rad_s: &[
        ("gondola", 60, [-0.0001166552204734, 0.006735068631423, 0.0]),
        (
            "gondola",
            100,
            [0.0008592914985962, -0.004931627293018, 0.0],
        ),
    ],
    tensions_n: &[
        ("tether", 1, 20, 919.3419603347),
        ("tether", 1, 60, 850.0087601236),
        ("tether", 1, 100, 918.6027763242),
        ("tether", 11, 20, 886.5554816777),
        ("tether", 11, 60, 819.0972655444),
        ("tether", 11, 100, 885.8941808097),
    ],
    energies_j: &[],
};

/// Massless links with half of each link's mass at each of its ends.
const OFFSET_POINTS: Case = Case {
    flight: Flight::Comparison,
    overrides: &[EXPONENTIAL, POINT_MASSES],
    positions_m: &[
        (
            "balloon",
            20,
            [33.14612015332, 1.903880165184, -0.1671331890507],
        ),
        (
            "balloon",
            60,
            [58.15561207081, 46.16863124617, 25.91106185699],
        ),
        (
            "balloon",
            100,
            [51.57890386554, 42.40402573323, 44.87723676302],
        ),
        (
            "gondola",
            20,
            [10.34953751252, 0.1629247455064, -903.9303417875],
        ),
        (
            "gondola",
            60,
            [56.49043661373, 58.94609832563, -878.0526230077],
        ),
        (
            "gondola",
            100,
            [51.38425936378, 44.69806869046, -859.1753750838],
        ),
    ],
    attitudes: &[
        (
            "gondola",
            60,
            [
                0.007007298492908,
                0.0005224279700593,
                0.0005031345400331,
                0.9999751855384,
            ],
        ),
        (
            "gondola",
            100,
            [
                0.001294034588103,
                0.0002878581875609,
                0.0005570608978959,
                0.9999989661471,
            ],
        ),
    ],
    rates_rad_s: &[
        ("gondola", 60, [-0.0009233090005559, 0.002751265000893, 0.0]),
        (
            "gondola",
            100,
            [-0.0004561504801191, -0.005735179523644, 0.0],
        ),
    ],
    tensions_n: &[
        ("tether", 1, 20, 919.3657974012),
        ("tether", 1, 60, 850.0074986024),
        ("tether", 1, 100, 918.6036700922),
        ("tether", 11, 20, 886.581257854),
        ("tether", 11, 60, 819.0960601508),
        ("tether", 11, 100, 885.8951497867),
    ],
    energies_j: &[],
};

/// Massless links with the tether's mass on its ten joints.
const OFFSET_INTERIOR_POINTS: Case = Case {
    flight: Flight::Comparison,
    overrides: &[EXPONENTIAL, POINT_MASSES, INTERIOR],
    positions_m: &[
        (
            "balloon",
            20,
            [33.14729665377, 1.905294529329, -0.1672473567116],
        ),
        (
            "balloon",
            60,
            [58.15124201127, 46.17637139937, 25.91090189342],
        ),
        (
            "balloon",
            100,
            [51.59697687715, 42.3996460298, 44.87980650745],
        ),
        (
            "gondola",
            20,
            [10.34131913365, 0.1618392167572, -903.9303152484],
        ),
        (
            "gondola",
            60,
            [56.47705342448, 58.93420225645, -878.0530398292],
        ),
        (
            "gondola",
            100,
            [51.39228499859, 44.68678301072, -859.172828093],
        ),
    ],
    attitudes: &[
        (
            "gondola",
            60,
            [
                0.006962223643165,
                0.0007515018279481,
                0.0004979316274696,
                0.9999753570719,
            ],
        ),
        (
            "gondola",
            100,
            [
                0.00129440017586,
                -4.021329417911e-05,
                0.0005385144040304,
                0.9999990164562,
            ],
        ),
    ],
    rates_rad_s: &[
        ("gondola", 60, [-0.001640744020047, 0.004881994412457, 0.0]),
        (
            "gondola",
            100,
            [-0.0008872473668584, -0.003790323269724, 0.0],
        ),
    ],
    tensions_n: &[
        ("tether", 1, 20, 921.0884569461),
        ("tether", 1, 60, 851.5178764626),
        ("tether", 1, 100, 920.2451402515),
        ("tether", 11, 20, 885.0285424269),
        ("tether", 11, 60, 817.6037885644),
        ("tether", 11, 100, 884.2627870777),
    ],
    energies_j: &[],
};

/// Uniform rods, and the balloon with added mass.
const OFFSET_RODS_ADDED_MASS: Case = Case {
    flight: Flight::Comparison,
    overrides: &[EXPONENTIAL, ADDED_MASS],
    positions_m: &[
        (
            "balloon",
            20,
            [26.57868947796, 0.9980433726165, -0.06945646682272],
        ),
        (
            "balloon",
            60,
            [60.57376413123, 46.51761813298, 21.54115925062],
        ),
        (
            "balloon",
            100,
            [54.48748148557, 51.90874145023, 54.27293775473],
        ),
        (
            "gondola",
            20,
            [9.423456410089, 0.1688859756465, -903.9567205923],
        ),
        (
            "gondola",
            60,
            [61.82257378871, 61.51865200425, -882.3890453751],
        ),
        (
            "gondola",
            100,
            [59.44934411463, 54.62478825974, -849.7649138528],
        ),
    ],
    attitudes: &[
        (
            "balloon",
            60,
            [
                0.00775216907721,
                -0.001106346883845,
                0.0003314992568413,
                0.999969284518,
            ],
        ),
        (
            "balloon",
            100,
            [
                0.001790092080068,
                -0.002443822969464,
                0.0004340446784191,
                0.9999953174415,
            ],
        ),
        (
            "gondola",
            60,
            [
                0.008478167974483,
                -0.00152513181786,
                0.000292771489131,
                0.9999628537729,
            ],
        ),
        (
            "gondola",
            100,
            [
                0.001580048980107,
                -0.003774682090205,
                0.0004263834686765,
                0.9999915366729,
            ],
        ),
    ],
    rates_rad_s: &[
        ("gondola", 60, [-0.000186542084765, 0.009411104461943, 0.0]),
        ("gondola", 100, [0.001772730760384, -0.004078629286763, 0.0]),
    ],
    tensions_n: &[
        ("tether", 1, 20, 919.3878011188),
        ("tether", 1, 60, 886.3371548305),
        ("tether", 1, 100, 917.8442257561),
        ("tether", 11, 20, 886.5829168247),
        ("tether", 11, 60, 854.2754781395),
        ("tether", 11, 100, 885.1456324473),
    ],
    energies_j: &[],
};

/// The branched chain from straight lines, uniform rods.
const BRANCH_RODS: Case = Case {
    flight: Flight::BranchedChain,
    overrides: &[],
    positions_m: &[
        (
            "balloon",
            20,
            [27.92224117654, 2.201730169706, -0.1339159490593],
        ),
        (
            "balloon",
            60,
            [54.13465175556, 53.51511877171, 25.1694206912],
        ),
        (
            "balloon",
            100,
            [55.66052475109, 53.63279793355, 45.80003273851],
        ),
        (
            "gondola",
            20,
            [15.47827499915, 0.1474143504575, -304.0659544321],
        ),
        (
            "gondola",
            60,
            [54.25863212444, 53.38703516887, -279.0267240904],
        ),
        (
            "gondola",
            100,
            [55.01655282394, 54.00021690168, -258.395851949],
        ),
        ("a", 20, [10.93457648796, 0.1444393497951, -424.4434681662]),
        ("a", 60, [63.34006707949, 51.58321534626, -399.0987418985]),
        ("a", 100, [53.86960568544, 53.89736942574, -378.7984452997]),
        ("b", 20, [11.10287700938, 0.3663898932353, -364.7533210083]),
        ("b", 60, [54.14253803767, 53.24498030143, -339.9132518901]),
        ("b", 100, [53.28264381212, 52.05967228336, -319.2199202869]),
    ],
    attitudes: &[
        (
            "gondola",
            60,
            [
                -0.03290613669763,
                -0.1152436092212,
                -0.1095004995965,
                0.9867348870337,
            ],
        ),
        (
            "gondola",
            100,
            [
                0.09625153111574,
                -0.04259886625343,
                0.9458366417165,
                0.3071058881531,
            ],
        ),
        (
            "b",
            60,
            [
                -0.004483614365134,
                -0.1050996372154,
                -0.01561202146908,
                0.994329034196,
            ],
        ),
        (
            "b",
            100,
            [
                -0.01760264867304,
                -0.05810021746383,
                -0.04017819751746,
                0.9973465916794,
            ],
        ),
    ],
    rates_rad_s: &[
        (
            "gondola",
            60,
            [0.1098322094096, -0.2325246619169, -0.4891504113684],
        ),
        (
            "gondola",
            100,
            [-0.1030529005885, 0.2742997377081, 0.0711346377461],
        ),
    ],
    tensions_n: &[
        ("tether", 1, 20, 1072.341931319),
        ("tether", 1, 60, 1006.701680065),
        ("tether", 1, 100, 1078.058606616),
        ("line-a", 5, 20, 82.85744940975),
        ("line-a", 5, 60, 61.30066606899),
        ("line-a", 5, 100, 69.26428673966),
        ("line-b", 1, 20, 94.46091264572),
        ("line-b", 1, 60, 107.8786597654),
        ("line-b", 1, 100, 111.3692697805),
    ],
    energies_j: &[],
};

/// The same with massless links and half of each link's mass at each of its ends.
const BRANCH_POINTS: Case = Case {
    flight: Flight::BranchedChain,
    overrides: &[POINT_MASSES],
    positions_m: &[
        (
            "balloon",
            20,
            [27.9231376845, 2.201459915214, -0.1355420687551],
        ),
        (
            "balloon",
            60,
            [54.13344431444, 53.512871742, 25.16854629052],
        ),
        (
            "balloon",
            100,
            [55.67257890566, 53.66072674535, 45.7960434688],
        ),
        (
            "gondola",
            20,
            [15.47951581422, 0.1475603224448, -304.0660479418],
        ),
        (
            "gondola",
            60,
            [54.26084301827, 53.38655550523, -279.0272914637],
        ),
        (
            "gondola",
            100,
            [55.037044117, 53.97198371987, -258.3990860991],
        ),
        ("a", 20, [10.93428301299, 0.1447936535569, -424.4533512326]),
        ("a", 60, [63.39278202684, 51.52577552953, -399.1096089025]),
        ("a", 100, [53.62461927653, 53.84792082568, -378.773864872]),
        ("b", 20, [11.10741743695, 0.3657356309739, -364.7450305822]),
        ("b", 60, [54.10666176164, 53.27155963928, -339.9063996638]),
        ("b", 100, [53.25019088124, 52.17038676682, -319.2372274132]),
    ],
    attitudes: &[
        (
            "gondola",
            60,
            [
                -0.04448061395639,
                -0.09728688895212,
                -0.1174340593039,
                0.9873023741162,
            ],
        ),
        (
            "gondola",
            100,
            [
                0.1255832785182,
                -0.03615530666337,
                0.9586767996134,
                0.2527062085501,
            ],
        ),
        (
            "b",
            60,
            [
                -0.004382129697155,
                -0.1113765783247,
                -0.01418535387866,
                0.9936673640989,
            ],
        ),
        (
            "b",
            100,
            [
                -0.01760039496677,
                -0.04935107411761,
                -0.04116354908118,
                0.9977776605073,
            ],
        ),
    ],
    rates_rad_s: &[
        (
            "gondola",
            60,
            [0.03183962328198, -0.3864861004737, -0.4373655850332],
        ),
        (
            "gondola",
            100,
            [-0.136632617461, 0.1407279188674, 0.01547594629332],
        ),
    ],
    tensions_n: &[
        ("tether", 1, 20, 1066.935839724),
        ("tether", 1, 60, 1007.607877356),
        ("tether", 1, 100, 1073.894814658),
        ("line-a", 5, 20, 84.4817687698),
        ("line-a", 5, 60, 65.34421806984),
        ("line-a", 5, 100, 62.08845432524),
        ("line-b", 1, 20, 89.44002748445),
        ("line-b", 1, 60, 104.690644534),
        ("line-b", 1, 100, 114.8644661932),
    ],
    energies_j: &[],
};

/// A turning body on five joints of uniform rods in vacuum.
const PENDULUM_RODS: Case = Case {
    flight: Flight::Pendulum,
    overrides: &[],
    positions_m: &[
        (
            "body",
            5,
            [-11.81604260573, -3.955874325836, -15.94671765207],
        ),
        (
            "body",
            10,
            [11.37039458636, 3.825353208841, -16.15315290546],
        ),
        (
            "body",
            20,
            [9.565800946656, 3.283926074978, -17.56760620201],
        ),
    ],
    attitudes: &[
        (
            "body",
            10,
            [
                0.04029685306556,
                -0.2020572491344,
                0.03397526067704,
                0.9779543513719,
            ],
        ),
        (
            "body",
            20,
            [
                -0.0679430578037,
                -0.1305046900847,
                -0.0466101949001,
                0.9880180952258,
            ],
        ),
    ],
    rates_rad_s: &[
        (
            "body",
            10,
            [0.1668943740567, 0.3419983080489, 0.04041809586927],
        ),
        (
            "body",
            20,
            [0.6219196481121, -1.583392081335, -2.282417454613],
        ),
    ],
    tensions_n: &[
        ("tether", 1, 5, 29.75357099364),
        ("tether", 1, 10, 28.74842371233),
        ("tether", 1, 20, 41.66692233825),
        ("tether", 6, 5, 19.12152521817),
        ("tether", 6, 10, 16.43417713356),
        ("tether", 6, 20, 28.54607377043),
    ],
    energies_j: &[
        (5, 8.55769357687, 6.139089236967e-12),
        (10, 24.27534725748, -7.389644451905e-12),
        (20, 88.55171436796, 6.139089236967e-12),
    ],
};

/// The same on elastic rods with dampers; at the start links go slack and taut again.
const PENDULUM_ELASTIC_RODS: Case = Case {
    flight: Flight::Pendulum,
    overrides: &["run.elastic_links=true", "run.duration_s=5"],
    positions_m: &[
        ("body", 2, [3.679842666245, 1.265587189408, -20.75588579178]),
        (
            "body",
            5,
            [-12.19494534065, -4.080412470375, -16.32654486087],
        ),
    ],
    attitudes: &[(
        "body",
        5,
        [
            0.03573027683762,
            0.3080843761191,
            0.15602405765,
            0.9377973437491,
        ],
    )],
    rates_rad_s: &[(
        "body",
        5,
        [0.1490843765536, -1.732679412874, 0.8634748320162],
    )],
    tensions_n: &[
        ("tether", 1, 2, 95.37587229857),
        ("tether", 1, 5, 48.82265004693),
        ("tether", 6, 2, 72.01168271771),
        ("tether", 6, 5, 36.34719403077),
    ],
    energies_j: &[
        (2, 221.9303982054, -14.79835133221),
        (5, 3.085188601652, -17.62267040233),
    ],
};
