//! What separate programs have computed of the comparison case.

use aerobot_components::run::{Formulation, LinkMass};
use glam::DVec3;

use super::super::flight::formulation_override;
use super::{BALLOON, GONDOLA, TETHER, on_the_nodes};

/// The comparison case in uniform density, the tether's mass on its nodes, attachments at the centres of mass, as
/// computed by separate programs that share nothing with this one: Python, adaptive steps of order 8 (DOP853) at a
/// tolerance of 1e-10. The digits end at 1e-6 m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// What moves.
    pub name: &'static str,
    /// The formulation here.
    pub formulation: Formulation,
    /// Where links have their masses.
    pub links: LinkMass,
    /// Displacements of balloon and gondola from the start at 100 s, m.
    pub displaced_m: [DVec3; 2],
}

/// Displacements from the start at 100 s, balloon then gondola, m.
pub const AT_100_S: [Reference; 3] = [
    Reference {
        name: "lumped masses",
        formulation: Formulation::LumpedMass,
        links: LinkMass::PointMass,
        displaced_m: [
            DVec3::new(52.034_195, 42.198_379, 65.066_100),
            DVec3::new(52.294_133, 44.439_419, 65.071_886),
        ],
    },
    Reference {
        name: "links, masses at the joints",
        formulation: Formulation::Denoc,
        links: LinkMass::PointMass,
        displaced_m: [
            DVec3::new(52.084_772, 42.215_221, 65.085_099),
            DVec3::new(52.307_193, 44.467_665, 65.087_947),
        ],
    },
    Reference {
        name: "links, uniform rods",
        formulation: Formulation::Denoc,
        links: LinkMass::Rod,
        displaced_m: [
            DVec3::new(52.070_530, 42.217_018, 65.080_316),
            DVec3::new(52.302_461, 44.473_286, 65.083_175),
        ],
    },
];

impl Reference {
    /// What makes the scene the case that was computed.
    pub(super) fn overrides(&self) -> Vec<String> {
        let links = match self.links {
            LinkMass::Rod => "Rod",
            LinkMass::PointMass => "PointMass",
        };
        vec![
            formulation_override(self.formulation),
            format!("run.links={links}"),
            "environment.atmosphere=Uniform(density_kg_m3: 0.8183)".to_owned(),
            on_the_nodes(),
            format!("entities.{TETHER}.Tether.from=(\"{BALLOON}\", (0, 0, 0))"),
            format!("entities.{TETHER}.Tether.to=(\"{GONDOLA}\", (0, 0, 0))"),
            "run.integrator=Adaptive(relative_tolerance: 1e-9)".to_owned(),
        ]
    }
}
