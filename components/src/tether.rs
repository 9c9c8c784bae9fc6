//! Tethers as a scene describes them, and where they attach.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use glam::DVec3;
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};
use crate::torsion::TetherTorsion;

/// A tether between two bodies or anchors: `nodes` interior point masses, `nodes` + 1 segments,
/// numbered from 1 at `from`.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Tether {
    /// The end from which nodes and segments count.
    pub from: TetherEnd,
    /// The other end.
    pub to: TetherEnd,
    /// Rest length of the whole tether, m.
    pub length_m: f64,
    /// Number of interior nodes; 0 is one segment.
    pub nodes: u32,
    /// Diameter, m: needed for mass and for drag.
    #[serde(default)]
    pub diameter_m: f64,
    /// Density of the material, kg/m^3.
    #[serde(default)]
    pub density_kg_m3: f64,
    /// Axial stiffness EA, N.
    pub axial_stiffness_n: f64,
    /// Damping c of the whole tether, N s/m; a segment has c (nodes + 1).
    #[serde(default)]
    pub damping_n_s_m: f64,
    /// Drag of the line; none unless given.
    #[serde(default)]
    pub drag: Option<TetherDrag>,
    /// Resistance of the line to being twisted; none unless given.
    #[serde(default)]
    pub torsion: Option<TetherTorsion>,
    /// Where the mass of the line goes.
    #[serde(default)]
    pub lumping: Lumping,
    /// Whether a segment goes slack instead of pushing.
    #[serde(default = "Tether::slackens")]
    pub slack: bool,
    /// How the nodes start.
    #[serde(default)]
    pub start: TetherStart,
}

impl Tether {
    fn slackens() -> bool {
        true
    }

    /// Number of segments.
    #[must_use]
    pub fn segments(&self) -> u32 {
        self.nodes + 1
    }

    /// Mass of the whole line, kg.
    #[must_use]
    pub fn mass_kg(&self) -> f64 {
        let radius = 0.5 * self.diameter_m;
        self.density_kg_m3 * self.length_m * std::f64::consts::PI * radius * radius
    }

    /// Rest length of one segment, m.
    #[must_use]
    pub fn segment_length_m(&self) -> f64 {
        self.length_m / f64::from(self.segments())
    }

    /// Stiffness of one segment k (N + 1), N/m.
    #[must_use]
    pub fn segment_stiffness_n_m(&self) -> f64 {
        self.axial_stiffness_n / self.length_m * f64::from(self.segments())
    }

    /// Damping of one segment c (N + 1), N s/m.
    #[must_use]
    pub fn segment_damping_n_s_m(&self) -> f64 {
        self.damping_n_s_m * f64::from(self.segments())
    }

    /// Mass of an interior node by a lumping, kg.
    #[must_use]
    pub fn node_mass_kg(&self, lumping: Lumping) -> f64 {
        match lumping {
            Lumping::HalfSegment => self.mass_kg() / f64::from(self.segments()),
            Lumping::Interior => self.mass_kg() / f64::from(self.nodes.max(1)),
        }
    }

    /// Mass that goes to each attachment by a lumping, kg.
    #[must_use]
    pub fn end_mass_kg(&self, lumping: Lumping) -> f64 {
        match lumping {
            Lumping::HalfSegment => 0.5 * self.mass_kg() / f64::from(self.segments()),
            Lumping::Interior => 0.0,
        }
    }

    /// Mass that hangs in the scene because of this tether, kg.
    #[must_use]
    pub fn lumped_mass_kg(&self) -> f64 {
        self.node_mass_kg(self.lumping) * f64::from(self.nodes)
            + 2.0 * self.end_mass_kg(self.lumping)
    }
}

impl SceneComponent for Tether {
    const NAME: &'static str = "Tether";
    const EXCLUDES: &'static [&'static str] = &["Body", "Fixed", "Moving"];

    fn check(&self, report: &mut FieldReport) {
        report.positive("length_m", self.length_m);
        report.non_negative("diameter_m", self.diameter_m);
        report.non_negative("density_kg_m3", self.density_kg_m3);
        report.positive("axial_stiffness_n", self.axial_stiffness_n);
        report.non_negative("damping_n_s_m", self.damping_n_s_m);
        if let Some(drag) = self.drag {
            report.non_negative("drag.normal", drag.normal);
            report.non_negative("drag.tangential", drag.tangential);
        }
        if let Some(torsion) = self.torsion {
            report.within("torsion", |report| torsion.check(report));
        }
        for (field, end) in [("from", &self.from), ("to", &self.to)] {
            if let AttachmentPoint::Offset(x, y, z) = end.1 {
                report.finite_vector(field, DVec3::new(x, y, z));
            }
        }
        self.check_mass(report);
        self.check_start(report);
    }
}

impl Tether {
    fn check_mass(&self, report: &mut FieldReport) {
        if self.nodes > MOST_NODES {
            let message = format!("`nodes` must be at most {MOST_NODES}, it is {}", self.nodes);
            report.add("nodes", message, "");
        }
        if self.diameter_m == 0.0 && (self.density_kg_m3 > 0.0 || self.drag.is_some()) {
            report.add(
                "",
                "`Tether` needs the field `diameter_m`: it has a density or a drag",
                "give `diameter_m`, or leave out `density_kg_m3` and `drag`",
            );
        } else if self.nodes > 0 && self.mass_kg() == 0.0 && self.length_m > 0.0 {
            report.add(
                "nodes",
                "an interior node without mass cannot be moved",
                "give the tether a `density_kg_m3` and a `diameter_m`, or set `nodes: 0`",
            );
        }
        if self.nodes == 0 && self.lumping == Lumping::Interior && self.mass_kg() > 0.0 {
            report.add(
                "lumping",
                "`Interior` lumping has no node to put the mass of this tether on",
                "use `HalfSegment`, give it nodes, or set `density_kg_m3: 0`",
            );
        }
    }

    /// Whether the positions of its nodes are not what it needs.
    pub(crate) fn has_wrong_start(&self) -> bool {
        let mut report = FieldReport::new("");
        self.check_start(&mut report);
        !report.into_violations().is_empty()
    }

    /// Reports what is wrong with the positions of its nodes.
    pub(crate) fn check_start(&self, report: &mut FieldReport) {
        let positions = match &self.start {
            TetherStart::Equilibrium | TetherStart::Straight => return,
            TetherStart::Positions(positions) => positions,
            TetherStart::Each(_) => {
                report.add(
                    "start",
                    "`Each` is of the tethers of a ring, and this is one tether",
                    "give `Positions([..])`",
                );
                return;
            }
        };
        if positions.len() != self.nodes as usize {
            report.add(
                "start",
                format!(
                    "`Positions` has {} entries, the tether {} nodes",
                    positions.len(),
                    self.nodes
                ),
                "give one position for each interior node, from `from` to `to`",
            );
        }
        if positions.iter().any(|position| !position.is_finite()) {
            report.add("start", "positions must be finite numbers", "");
        }
    }
}

/// The largest number of interior nodes that a tether may have.
pub const MOST_NODES: u32 = 1_000_000;

/// One end of a tether: the entity, and the place on it.
#[derive(Clone, Debug, Deserialize, PartialEq)]
pub struct TetherEnd(
    /// Name of the body or anchor.
    pub String,
    /// The place on it.
    pub AttachmentPoint,
);

/// A place on a body: an offset from the centre of mass in the body frame, or a named one.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(
    untagged,
    expecting = "expected an offset (x, y, z) in metres from the centre of mass, or `Bottom`, \
                 `Top` or `Centre`"
)]
pub enum AttachmentPoint {
    /// A named place.
    Named(NamedPoint),
    /// x, y, z in the body frame, m.
    Offset(f64, f64, f64),
    /// This far from a named place, body frame, m: a place on a [ring](crate::tether_ring::Tethers).
    #[serde(skip)]
    Displaced(NamedPoint, DVec3),
}

/// The named places on a body.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename = "point")]
pub enum NamedPoint {
    /// The lowest point of an upright sphere, box, cylinder or rod.
    Bottom,
    /// The highest point of an upright sphere, box, cylinder or rod.
    Top,
    /// The centre of mass.
    Centre,
}

/// Coefficients of the drag of a line, Morison's form.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "drag", deny_unknown_fields)]
pub struct TetherDrag {
    /// Normal coefficient C_n, on diameter x length.
    pub normal: f64,
    /// Tangential coefficient C_t, on the wetted area pi x diameter x length.
    pub tangential: f64,
}

/// Where the mass of a tether goes.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "lumping")]
pub enum Lumping {
    /// Half of each segment's mass to each of its ends; second order in 1/N.
    #[default]
    HalfSegment,
    /// All of it to the interior nodes in equal parts (the paper's); first order in 1/N.
    Interior,
}

/// How the nodes of a tether start.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "start")]
pub enum TetherStart {
    /// In static equilibrium in still air.
    #[default]
    Equilibrium,
    /// Equally spaced on the straight line between the ends.
    Straight,
    /// At these positions in the inertial frame, m, from `from` to `to`.
    Positions(Vec<DVec3>),
    /// Of a [ring](crate::tether_ring::Tethers): at these positions, a list for each of its tethers.
    Each(Vec<Vec<DVec3>>),
}

/// A point of a tether in the running world: an interior node or an attachment.
///
/// `index` is its place in the scratch arrays that segments read; points of one tether are
/// consecutive from its `from` attachment to its `to` attachment.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct TetherPoint {
    /// Place among all tether points of the world.
    pub index: usize,
}

/// An interior node of a tether.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct TetherNode {
    /// The tether's entity.
    pub tether: Entity,
    /// Number from 1 at `from`.
    pub number: u32,
}

/// The end of a tether on a body or anchor.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// The tether's entity.
    pub tether: Entity,
    /// The body or anchor that carries it.
    pub carrier: Entity,
    /// Place on the carrier, from its centre of mass in the body frame, m.
    pub offset_m: DVec3,
    /// Which end of the tether it is.
    pub side: TetherSide,
}

/// The two ends of a tether.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename = "end")]
pub enum TetherSide {
    /// The end from which nodes and segments count.
    From,
    /// The other end.
    To,
}

/// The entities that a tether consists of in the running world, in order from `from`.
#[derive(Component, Clone, Debug, Default, PartialEq, Eq)]
pub struct TetherParts {
    /// Attachment, interior nodes, attachment.
    pub points: Vec<Entity>,
    /// The segments.
    pub segments: Vec<Entity>,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tether(nodes: u32, lumping: Lumping) -> Tether {
        Tether {
            from: TetherEnd("a".into(), AttachmentPoint::Named(NamedPoint::Bottom)),
            to: TetherEnd("b".into(), AttachmentPoint::Offset(0.0, 0.0, 0.5)),
            length_m: 900.0,
            nodes,
            diameter_m: 0.002,
            density_kg_m3: 1440.0,
            axial_stiffness_n: 2e5,
            damping_n_s_m: 10.0,
            drag: None,
            torsion: None,
            lumping,
            slack: true,
            start: TetherStart::Equilibrium,
        }
    }

    #[test]
    fn lumping_keeps_the_mass() {
        for lumping in [Lumping::HalfSegment, Lumping::Interior] {
            let tether = tether(10, lumping);
            assert!((tether.mass_kg() - 4.071_504_079).abs() < 1e-9);
            assert!((tether.lumped_mass_kg() - tether.mass_kg()).abs() < 1e-14);
        }
    }

    #[test]
    fn a_segment_is_stiffer_than_the_whole() {
        let tether = tether(10, Lumping::Interior);
        assert!((tether.segment_stiffness_n_m() - 2e5 / 900.0 * 11.0).abs() < 1e-9);
        assert!((tether.segment_damping_n_s_m() - 110.0).abs() < 1e-12);
    }
}
