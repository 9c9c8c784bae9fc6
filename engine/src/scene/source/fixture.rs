//! The sample scene of the design, for the tests.

/// A scene with comments, tuples, variants, a map and numbers of several forms.
pub(crate) const SCENE: &str = r#"(
    name: "comparison-900m",
    about: "Balloon, 900 m tether of ten masses, gondola at 56 km, three step gusts (paper, sec. 4.2)",
    environment: (
        gravity: Constant(8.87),
        atmosphere: Vira,
        wind: [
            Step(velocity_m_s: (5, 0, 0), from_s: 10, until_s: 20),
        ],
    ),
    entities: {
        "balloon": (
            Body: (mass_kg: 50, inertia: ThinSphere),
            Sphere: (radius: Equilibrium(altitude_m: 56_000)),
            Buoyancy: (), Drag: Constant(coefficient: 0.47),   // area: pi R^2 unless given
        ),
        "gondola": (
            Body: (mass_kg: 100, inertia: Box(1, 1, 1)),
            Drag: Constant(coefficient: 1.0, area_m2: 1.0),
        ),
        "tether": (
            Tether: (
                from: ("balloon", Bottom), to: ("gondola", (0, 0, 0.5)),   // Bottom of a sphere: (0, 0, -R)
                length_m: 900, nodes: 10, diameter_m: 0.002, density_kg_m3: 1440,
                axial_stiffness_n: 2e5, damping_n_s_m: 10, drag: (normal: 1.0, tangential: 0.03),
            ),
        ),
    },
    run: (formulation: LumpedMass, duration_s: 100, output_every_s: 1, integrator: Adaptive(relative_tolerance: 1e-8)),
)
"#;
