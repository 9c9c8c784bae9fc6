//! A ring of equal tethers, as a scene describes it.

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};
use crate::tether::{
    AttachmentPoint, Lumping, NamedPoint, Tether, TetherDrag, TetherEnd, TetherStart,
};
use crate::torsion::TetherTorsion;

/// `count` equal tethers, spread evenly over a circle about the body z axis at either end.
///
/// Tether k stands at the angle phi_k = `first_angle_deg` + 360 (k - 1)/`count`, from the body x axis
/// towards y, and is attached at r (cos phi_k, sin phi_k, 0) from the place that `from` or `to` names, in
/// the body frame there; r is the radius of that end.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Tethers {
    /// Number of tethers.
    pub count: u32,
    /// Radius of the circle at `from`, m.
    pub from_radius_m: f64,
    /// Radius of the circle at `to`, m.
    pub to_radius_m: f64,
    /// Angle of the first tether, degrees.
    #[serde(default)]
    pub first_angle_deg: f64,
    /// As [`Tether::from`]: the entity, and the centre of the circle on it.
    pub from: TetherEnd,
    /// As [`Tether::to`]: the entity, and the centre of the circle on it.
    pub to: TetherEnd,
    /// As [`Tether::length_m`], of each.
    pub length_m: f64,
    /// As [`Tether::nodes`], of each.
    pub nodes: u32,
    /// As [`Tether::diameter_m`].
    #[serde(default)]
    pub diameter_m: f64,
    /// As [`Tether::density_kg_m3`].
    #[serde(default)]
    pub density_kg_m3: f64,
    /// As [`Tether::axial_stiffness_n`], of each.
    pub axial_stiffness_n: f64,
    /// As [`Tether::damping_n_s_m`], of each.
    #[serde(default)]
    pub damping_n_s_m: f64,
    /// As [`Tether::drag`].
    #[serde(default)]
    pub drag: Option<TetherDrag>,
    /// As [`Tether::torsion`], of each.
    #[serde(default)]
    pub torsion: Option<TetherTorsion>,
    /// As [`Tether::lumping`].
    #[serde(default)]
    pub lumping: Lumping,
    /// As [`Tether::slack`].
    #[serde(default = "slackens")]
    pub slack: bool,
    /// As [`Tether::start`]; positions of nodes as `Each`, a list for each tether.
    #[serde(default)]
    pub start: TetherStart,
}

fn slackens() -> bool {
    true
}

/// The largest number of tethers that a ring may have.
pub const MOST_TETHERS: u32 = 1000;

impl Tethers {
    /// The tethers of the ring, in order; of a ring that has too many, those that one may have.
    #[must_use]
    pub fn members(&self) -> Vec<Tether> {
        (1..=self.count.min(MOST_TETHERS))
            .map(|number| self.member(number))
            .collect()
    }

    /// Tether `number`, from 1.
    fn member(&self, number: u32) -> Tether {
        let direction = self.direction(number);
        let start = match &self.start {
            TetherStart::Each(starts) => {
                let own = starts.get(number as usize - 1).cloned();
                own.map_or(TetherStart::Equilibrium, TetherStart::Positions)
            }
            start => start.clone(),
        };
        Tether {
            from: displaced(&self.from, self.from_radius_m * direction),
            to: displaced(&self.to, self.to_radius_m * direction),
            start,
            ..self.at_the_centre()
        }
    }

    /// A tether between the centres of the two circles.
    fn at_the_centre(&self) -> Tether {
        Tether {
            from: self.from.clone(),
            to: self.to.clone(),
            length_m: self.length_m,
            nodes: self.nodes,
            diameter_m: self.diameter_m,
            density_kg_m3: self.density_kg_m3,
            axial_stiffness_n: self.axial_stiffness_n,
            damping_n_s_m: self.damping_n_s_m,
            drag: self.drag,
            torsion: self.torsion,
            lumping: self.lumping,
            slack: self.slack,
            start: TetherStart::Equilibrium,
        }
    }

    /// Unit vector from the axis to tether `number`, body frame; exact at quarter turns.
    fn direction(&self, number: u32) -> DVec3 {
        let turned_deg = 360.0 * f64::from(number - 1) / f64::from(self.count);
        let angle_deg = (self.first_angle_deg + turned_deg).rem_euclid(360.0);
        if angle_deg == 90.0 {
            DVec3::Y
        } else if angle_deg == 180.0 {
            DVec3::NEG_X
        } else if angle_deg == 270.0 {
            DVec3::NEG_Y
        } else {
            let angle_rad = angle_deg.to_radians();
            DVec3::new(libm::cos(angle_rad), libm::sin(angle_rad), 0.0)
        }
    }

    fn check_start(&self, report: &mut FieldReport) {
        match &self.start {
            TetherStart::Positions(_) if self.count > 1 => report.add(
                "start",
                format!(
                    "`Positions` are of one tether, and the ring has {}",
                    self.count
                ),
                "give `Each([[..], [..]])`, a list of positions for each tether",
            ),
            TetherStart::Each(starts) if starts.len() != self.count as usize => report.add(
                "start",
                format!(
                    "`Each` has {} lists, the ring {} tethers",
                    starts.len(),
                    self.count
                ),
                "give one list of positions for each tether",
            ),
            TetherStart::Each(_) | TetherStart::Positions(_) => {
                if let Some(wrong) = self
                    .members()
                    .iter()
                    .find(|member| member.has_wrong_start())
                {
                    wrong.check_start(report);
                }
            }
            TetherStart::Equilibrium | TetherStart::Straight => {}
        }
    }
}

/// The end of a tether `by_m` from the place where `end` would be.
fn displaced(end: &TetherEnd, by_m: DVec3) -> TetherEnd {
    let place = match end.1 {
        AttachmentPoint::Offset(x, y, z) => {
            let offset_m = DVec3::new(x, y, z) + by_m;
            AttachmentPoint::Offset(offset_m.x, offset_m.y, offset_m.z)
        }
        AttachmentPoint::Named(NamedPoint::Centre) => {
            AttachmentPoint::Offset(by_m.x, by_m.y, by_m.z)
        }
        AttachmentPoint::Named(named) => AttachmentPoint::Displaced(named, by_m),
        AttachmentPoint::Displaced(named, before_m) => {
            AttachmentPoint::Displaced(named, before_m + by_m)
        }
    };
    TetherEnd(end.0.clone(), place)
}

impl SceneComponent for Tethers {
    const NAME: &'static str = "Tethers";
    const EXCLUDES: &'static [&'static str] = &["Tether", "Body", "Fixed", "Moving"];

    fn check(&self, report: &mut FieldReport) {
        report.non_negative("from_radius_m", self.from_radius_m);
        report.non_negative("to_radius_m", self.to_radius_m);
        report.finite("first_angle_deg", self.first_angle_deg);
        if !(1..=MOST_TETHERS).contains(&self.count) {
            let message = format!(
                "`count` must be from 1 to {MOST_TETHERS}, it is {}",
                self.count
            );
            report.add("count", message, "");
        } else if self.count > 1 && self.from_radius_m == 0.0 && self.to_radius_m == 0.0 {
            report.add(
                "count",
                format!(
                    "{} tethers of radius 0 at both ends are all in one place",
                    self.count
                ),
                "give the ring a radius, or set `count: 1` and the stiffness and mass of all",
            );
        } else {
            self.check_start(report);
        }
        let mut of_each = FieldReport::new("");
        self.at_the_centre().check(&mut of_each);
        for violation in of_each.into_violations() {
            let message = violation.message.replace("`Tether`", "`Tethers`");
            report.add(&violation.path, message, violation.help.unwrap_or_default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(count: u32, first_angle_deg: f64) -> Tethers {
        Tethers {
            count,
            from_radius_m: 2.0,
            to_radius_m: 0.5,
            first_angle_deg,
            from: TetherEnd("a".into(), AttachmentPoint::Named(NamedPoint::Bottom)),
            to: TetherEnd("b".into(), AttachmentPoint::Offset(0.1, 0.2, 0.3)),
            length_m: 10.0,
            nodes: 1,
            diameter_m: 0.002,
            density_kg_m3: 1440.0,
            axial_stiffness_n: 1e4,
            damping_n_s_m: 0.0,
            drag: None,
            torsion: None,
            lumping: Lumping::HalfSegment,
            slack: true,
            start: TetherStart::Equilibrium,
        }
    }

    /// Places of the `to` end.
    fn places(ring: &Tethers) -> Vec<DVec3> {
        let ends = ring.members().into_iter().map(|member| member.to.1);
        ends.map(|end| match end {
            AttachmentPoint::Offset(x, y, z) => DVec3::new(x, y, z),
            _ => DVec3::NAN,
        })
        .collect()
    }

    fn messages(ring: &Tethers) -> Vec<String> {
        let mut report = FieldReport::new("");
        ring.check(&mut report);
        let violations = report.into_violations().into_iter();
        violations.map(|violation| violation.message).collect()
    }

    #[test]
    fn tethers_stand_at_equal_angles() {
        let centre = DVec3::new(0.1, 0.2, 0.3);
        for count in 1..=7 {
            let arms: Vec<DVec3> = places(&ring(count, 25.0))
                .iter()
                .map(|p| *p - centre)
                .collect();
            let step = std::f64::consts::TAU / f64::from(count);
            for (index, arm) in arms.iter().enumerate() {
                let next = arms[(index + 1) % arms.len()];
                assert!((arm.length() - 0.5).abs() < 1e-15);
                assert!((arm.dot(next) - 0.25 * step.cos()).abs() < 1e-15);
                assert!((arm.cross(next).z - 0.25 * step.sin()).abs() < 1e-15);
            }
            assert!((arms[0].y.atan2(arms[0].x).to_degrees() - 25.0).abs() < 1e-12);
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        let centre = DVec3::new(0.1, 0.2, 0.3);
        let quarters = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y].map(|d| centre + 0.5 * d);
        assert_eq!(places(&ring(4, 0.0)), quarters);
        assert_eq!(places(&ring(4, -270.0))[0], quarters[1]);
        let from = &ring(4, 0.0).members()[1].from;
        let expected = AttachmentPoint::Displaced(NamedPoint::Bottom, 2.0 * DVec3::Y);
        assert_eq!(from.1, expected);
    }

    #[test]
    fn starts_are_of_each_tether() {
        let at = |x: f64| vec![DVec3::new(x, 0.0, 0.0)];
        let mut ring = ring(2, 0.0);
        ring.start = TetherStart::Each(vec![at(1.0), at(2.0)]);
        assert_eq!(messages(&ring), Vec::<String>::new());
        assert_eq!(ring.members()[1].start, TetherStart::Positions(at(2.0)));
        ring.start = TetherStart::Each(vec![at(1.0), Vec::new()]);
        assert_eq!(
            messages(&ring),
            ["`Positions` has 0 entries, the tether 1 nodes"]
        );
        ring.start = TetherStart::Each(vec![at(1.0)]);
        assert_eq!(messages(&ring), ["`Each` has 1 lists, the ring 2 tethers"]);
        ring.start = TetherStart::Positions(at(1.0));
        assert_eq!(
            messages(&ring),
            ["`Positions` are of one tether, and the ring has 2"]
        );
    }
}
