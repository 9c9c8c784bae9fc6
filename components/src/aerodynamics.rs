//! Spheres, buoyancy, added mass and the drag of bodies.

use bevy_ecs::component::Component;
use serde::Deserialize;

use crate::scene_component::{FieldReport, SceneComponent};

/// The outer shape of a balloon or of a spherical probe. Give `radius_m`, or `radius` as a rule.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Radius, m.
    #[serde(default)]
    pub radius_m: Option<f64>,
    /// A rule that gives the radius.
    #[serde(default)]
    pub radius: Option<RadiusRule>,
}

/// A rule for the radius of a sphere.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "radius", deny_unknown_fields)]
pub enum RadiusRule {
    /// The radius at which the balloon floats, with all that is tethered to it, at an altitude:
    /// rho V = total mass.
    Equilibrium {
        /// The altitude of the balloon's centre, m.
        altitude_m: f64,
    },
}

impl SceneComponent for Sphere {
    const NAME: &'static str = "Sphere";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Fixed", "Moving"]];

    fn check(&self, report: &mut FieldReport) {
        match (self.radius_m, self.radius) {
            (Some(radius_m), None) => report.positive("radius_m", radius_m),
            (None, Some(RadiusRule::Equilibrium { altitude_m })) => {
                report.finite("radius.altitude_m", altitude_m);
            }
            (None, None) => report.add(
                "",
                "`Sphere` needs its radius",
                "give `radius_m`, or `radius: Equilibrium(altitude_m: ..)`",
            ),
            (Some(_), Some(_)) => report.add(
                "radius",
                "`radius_m` and `radius` exclude each other",
                "keep one of the two",
            ),
        }
    }
}

/// The radius that a sphere has in the run, m.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SphereRadius(pub f64);

impl SphereRadius {
    /// Volume, m^3.
    #[must_use]
    pub fn volume_m3(&self) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.0.powi(3)
    }

    /// Frontal area, m^2.
    #[must_use]
    pub fn frontal_area_m2(&self) -> f64 {
        std::f64::consts::PI * self.0 * self.0
    }
}

/// Lift of the displaced air, +rho V g; the volume is the sphere's unless given.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Buoyancy {
    /// Displaced volume, m^3.
    #[serde(default)]
    pub volume_m3: Option<f64>,
}

impl SceneComponent for Buoyancy {
    const NAME: &'static str = "Buoyancy";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Fixed", "Moving"]];

    fn check(&self, report: &mut FieldReport) {
        if let Some(volume_m3) = self.volume_m3 {
            report.positive("volume_m3", volume_m3);
        }
    }
}

/// The volume of air a body displaces in the run, m^3.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct DisplacedVolume(pub f64);

/// Added mass of the surrounding air: coefficient x rho x volume, in the inertia and not in the
/// weight. A sphere has the coefficient 1/2 (2/3 pi rho R^3).
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct AddedMass {
    /// Fraction of the displaced mass; 1/2 unless given.
    #[serde(default = "AddedMass::sphere")]
    pub coefficient: f64,
}

impl AddedMass {
    fn sphere() -> f64 {
        0.5
    }
}

impl SceneComponent for AddedMass {
    const NAME: &'static str = "AddedMass";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body"], &["Sphere", "Buoyancy"]];

    fn check(&self, report: &mut FieldReport) {
        report.non_negative("coefficient", self.coefficient);
    }
}

/// The displaced volume times the coefficient of added mass, m^3.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct AddedVolume(pub f64);

/// Drag of a body at its centre of mass: -1/2 rho C_d S |v| v, v relative to the air.
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub enum Drag {
    /// A constant coefficient.
    Constant {
        /// Drag coefficient C_d.
        coefficient: f64,
        /// Reference area S, m^2; the frontal area of the entity's sphere unless given.
        #[serde(default)]
        area_m2: Option<f64>,
    },
    /// A smooth sphere whose coefficient follows the Reynolds number (Morrison 2016).
    Morrison,
}

impl SceneComponent for Drag {
    const NAME: &'static str = "Drag";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body", "Fixed", "Moving"]];

    fn check(&self, report: &mut FieldReport) {
        if let Self::Constant {
            coefficient,
            area_m2,
        } = self
        {
            report.non_negative("coefficient", *coefficient);
            if let Some(area_m2) = area_m2 {
                report.non_negative("area_m2", *area_m2);
            }
        }
    }
}

/// Drag of constant coefficient, resolved: C_d S, m^2.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct ConstantDragArea(pub f64);

/// Drag of a smooth sphere by its Reynolds number, resolved.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SphereDrag {
    /// Diameter, m.
    pub diameter_m: f64,
    /// Frontal area, m^2.
    pub area_m2: f64,
}
