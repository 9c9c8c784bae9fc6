//! The cases: scenes and how long they are flown.

use std::fmt::Write as _;

use super::one_km_line::one_km_line;

/// A case of the study.
pub(crate) struct Case {
    /// Name in the table and above the panel.
    pub(crate) name: &'static str,
    /// Text of the scene.
    pub(crate) scene: String,
    /// How long it is flown, s.
    pub(crate) duration_s: f64,
    /// Outputs after the one at the start: few, for every output cuts a step.
    pub(crate) outputs: u32,
    /// Relative tolerance of the Dormand-Prince run that says what is right.
    pub(crate) reference_tolerance: f64,
}

/// All six.
pub(crate) fn cases() -> Vec<Case> {
    let case = |name, scene, duration_s| Case {
        name,
        scene,
        duration_s,
        outputs: 20,
        reference_tolerance: 1e-11,
    };
    vec![
        case("900 m in three gusts", paper("comparison_900m"), 100.0),
        case(
            "1 km line of 100 nodes",
            one_km_line(100, 11.5e3, 60.0),
            60.0,
        ),
        Case {
            // Less takes minutes and says no more: the stable step keeps even 1e-3 within 1e-10 m of it.
            reference_tolerance: 1e-8,
            ..case(
                "1 km line of 500 nodes",
                one_km_line(500, 11.5e3, 60.0),
                60.0,
            )
        },
        Case {
            reference_tolerance: 1e-10,
            ..case("9.7 km towline of 100 nodes", paper("towing_9700m"), 2000.0)
        },
        case("body on three tethers", suspension(), 10.0),
        case("snap of 100 m", snap(), 0.8),
    ]
}

fn paper(name: &str) -> String {
    let file = format!("{}/scenes/paper/{name}.ron", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(file).expect("the scene is in the repository")
}

/// A body of 50 kg on three stiff tethers of 10 m, yawed by 0.2 rad and 5 cm aside, in vacuum.
fn suspension() -> String {
    let density_kg_m3 = density_kg_m3(0.005, 0.002);
    let mut entities = String::new();
    for (number, degrees) in [0.0_f64, 120.0, 240.0].into_iter().enumerate() {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        let (x_m, y_m) = (0.5 * cos, 0.5 * sin);
        let _ = write!(
            entities,
            r#"
                "anchor-{number}": (Fixed: (position_m: ({cos}, {sin}, 0))),
                "tether-{number}": (Tether: (
                    from: ("anchor-{number}", Centre), to: ("body", ({x_m}, {y_m}, 0.4)),
                    length_m: 10, nodes: 5, diameter_m: 0.002, density_kg_m3: {density_kg_m3},
                    axial_stiffness_n: 5e4, damping_n_s_m: 1,
                    lumping: HalfSegment, drag: (normal: 1, tangential: 0.03), start: Straight,
                )),"#
        );
    }
    format!(
        r#"(
            name: "suspension",
            environment: (atmosphere: Vacuum),
            entities: {{{entities}
                "body": (
                    Body: (
                        mass_kg: 50, inertia: Tensor(xx_kg_m2: 4, yy_kg_m2: 5, zz_kg_m2: 6),
                    ),
                    Pose: (
                        position_m: (0.05, 0, -10.396383),
                        attitude: AxisAngle(axis: (0, 0, 1), angle_rad: 0.2),
                    ),
                ),
            }},
            run: (duration_s: 10, output_every_s: 10),
        )"#
    )
}

/// A point of 10 kg that falls into a slack line of 100 m and 20 nodes from a metre within its reach.
fn snap() -> String {
    let (length_m, kg_m, nodes, stiffness_n) = (100.0, 0.01, 20, 1e5);
    let segments = f64::from(nodes) + 1.0;
    let node_kg = kg_m * length_m / f64::from(nodes);
    let stiffness_n_m = stiffness_n / length_m * segments;
    let damping_n_s_m = 0.1 * (stiffness_n_m * node_kg).sqrt() / segments;
    let density_kg_m3 = density_kg_m3(kg_m, 0.002);
    let (x_m, z_m) = (20.0, -96.9587);
    let mut positions = String::new();
    for number in 1..=nodes {
        let part = f64::from(number) / segments;
        let _ = write!(positions, "({}, 0, {}),", part * x_m, part * z_m);
    }
    format!(
        r#"(
            name: "snap",
            environment: (atmosphere: Vacuum),
            entities: {{
                "top": (Fixed: (position_m: (0, 0, 0))),
                "point": (Body: (mass_kg: 10), Pose: (position_m: ({x_m}, 0, {z_m}))),
                "line": (Tether: (
                    from: ("top", Centre), to: ("point", Centre),
                    length_m: {length_m}, nodes: {nodes},
                    diameter_m: 0.002, density_kg_m3: {density_kg_m3},
                    axial_stiffness_n: {stiffness_n}, damping_n_s_m: {damping_n_s_m},
                    lumping: Interior, drag: (normal: 1, tangential: 0.03),
                    start: Positions([{positions}]),
                )),
            }},
            run: (duration_s: 0.8, output_every_s: 0.8),
        )"#
    )
}

/// Density of a round line of `kg_m` (kg/m) and a diameter of `diameter_m` (m).
fn density_kg_m3(kg_m: f64, diameter_m: f64) -> f64 {
    kg_m / (0.25 * std::f64::consts::PI * diameter_m * diameter_m)
}
