//! A sail: a wing and a rudder, both with their span along the body's z axis, on a rigid body whose x axis is
//! its bow.

use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use glam::DVec3;
use serde::Deserialize;

use crate::actuator::ActuatorLimits;
use crate::scene_component::{FieldReport, SceneComponent};

/// Wing and rudder of a steering sail (paper, sec. 5.2.1).
#[derive(Component, Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Sail {
    /// The main wing.
    pub wing: WingSpec,
    /// The rudder behind (or before) it.
    pub rudder: RudderSpec,
    /// Slope of the lift of both; that of a finite span unless given.
    #[serde(default)]
    pub lift_slope: LiftSlope,
    /// What the wing does to the incidence of the rudder.
    #[serde(default)]
    pub downwash: Downwash,
    /// What happens at large incidence; nothing unless given.
    #[serde(default)]
    pub stall: StallSpec,
    /// Which motion through the air counts.
    #[serde(default)]
    pub airspeed: SailAirspeed,
    /// Whether the body may roll and pitch.
    #[serde(default)]
    pub attitude: SailAttitude,
}

/// The main wing of a sail.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "wing", deny_unknown_fields)]
pub struct WingSpec {
    /// Area, m^2.
    pub area_m2: f64,
    /// Aspect ratio: span over mean chord.
    pub aspect_ratio: f64,
    /// Oswald's efficiency number e in C_D = C_D0 + C_L^2/(pi AR e).
    pub oswald_factor: f64,
    /// Drag coefficient without lift C_D0.
    pub zero_lift_drag: f64,
    /// Distance of its aerodynamic centre from the centre of mass along x, m.
    pub arm_m: f64,
    /// To which side.
    pub side: Side,
    /// Height of its aerodynamic centre above the centre of mass, m.
    #[serde(default)]
    pub height_m: f64,
}

/// The rudder of a sail.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "rudder", deny_unknown_fields)]
pub struct RudderSpec {
    /// Area, m^2.
    pub area_m2: f64,
    /// Aspect ratio; the wing's unless given.
    #[serde(default)]
    pub aspect_ratio: Option<f64>,
    /// Oswald's efficiency number; the wing's unless given. Only a rudder with `zero_lift_drag` has drag.
    #[serde(default)]
    pub oswald_factor: Option<f64>,
    /// Drag coefficient without lift; a rudder without it has no drag at all, as the paper's.
    #[serde(default)]
    pub zero_lift_drag: Option<f64>,
    /// Distance of its aerodynamic centre from the centre of mass along x, m.
    pub arm_m: f64,
    /// To which side; aft unless given.
    #[serde(default = "Side::aft")]
    pub side: Side,
    /// Height of its aerodynamic centre above the centre of mass, m.
    #[serde(default)]
    pub height_m: f64,
    /// Limits of its deflection, rad, and how it follows its command. A positive deflection turns the bow
    /// towards -y.
    pub deflection: ActuatorLimits,
}

/// To which side of the centre of mass.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename = "side")]
pub enum Side {
    /// Towards the bow, +x.
    Ahead,
    /// Towards the stern, -x.
    Aft,
}

impl Side {
    fn aft() -> Self {
        Self::Aft
    }

    /// +1 ahead, -1 aft.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Ahead => 1.0,
            Self::Aft => -1.0,
        }
    }
}

/// Slope a of the lift coefficient with incidence.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "lift_slope")]
pub enum LiftSlope {
    /// 2 pi/(1 + 2/AR), a wing of elliptic lift (Prandtl's lifting line), each surface with its own AR.
    #[default]
    FiniteSpan,
    /// 2 pi, the thin aerofoil of infinite span: the paper's.
    ThinAerofoil,
    /// So much per rad.
    PerRad(f64),
}

impl LiftSlope {
    /// For an aspect ratio, 1/rad.
    #[must_use]
    pub fn per_rad(self, aspect_ratio: f64) -> f64 {
        match self {
            Self::FiniteSpan => std::f64::consts::TAU / (1.0 + 2.0 / aspect_ratio),
            Self::ThinAerofoil => std::f64::consts::TAU,
            Self::PerRad(slope) => slope,
        }
    }
}

/// The downwash of the wing at the rudder, epsilon = 2 C_L/(pi AR).
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "downwash")]
pub enum Downwash {
    /// It takes from the incidence of the rudder: alpha_r = alpha_w - epsilon - delta.
    #[default]
    Right,
    /// It adds to it, as the paper prints: alpha_r = alpha_w + epsilon - delta.
    AsPrinted,
    /// None.
    None,
}

impl Downwash {
    /// What epsilon is multiplied by before it adds to the incidence.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Right => -1.0,
            Self::AsPrinted => 1.0,
            Self::None => 0.0,
        }
    }
}

/// What large incidence does.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "stall", deny_unknown_fields)]
pub enum StallSpec {
    /// Nothing: lift grows with incidence without end, as the paper has it.
    #[default]
    None,
    /// Lift and drag go over smoothly to those of a flat plate.
    FlatPlate {
        /// Incidence halfway between the two, rad.
        angle_rad: f64,
        /// How fast they go over, 1/rad.
        #[serde(default = "StallSpec::sharpness")]
        sharpness_per_rad: f64,
    },
}

impl StallSpec {
    fn sharpness() -> f64 {
        50.0
    }
}

/// Which motion through the air counts.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "airspeed")]
pub enum SailAirspeed {
    /// All of it.
    #[default]
    Full,
    /// Its horizontal part alone.
    Horizontal,
}

/// Whether the body of a sail may roll and pitch.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename = "attitude")]
pub enum SailAttitude {
    /// It turns freely about all axes.
    #[default]
    Free,
    /// Its z axis is held upright and only yaw is free, as the paper has it.
    Level,
}

impl SceneComponent for Sail {
    const NAME: &'static str = "Sail";
    const REQUIRES: &'static [&'static [&'static str]] = &[&["Body"]];

    fn check(&self, report: &mut FieldReport) {
        report.within("wing", |report| {
            report.positive("area_m2", self.wing.area_m2);
            report.positive("aspect_ratio", self.wing.aspect_ratio);
            report.positive("oswald_factor", self.wing.oswald_factor);
            report.non_negative("zero_lift_drag", self.wing.zero_lift_drag);
            check_place(report, self.wing.arm_m, self.wing.height_m);
        });
        report.within("rudder", |report| self.rudder.check(report));
        if let LiftSlope::PerRad(slope) = self.lift_slope {
            report.positive("lift_slope.0", slope);
        }
        if let StallSpec::FlatPlate {
            angle_rad,
            sharpness_per_rad,
        } = self.stall
        {
            report.within("stall", |report| {
                report.positive("angle_rad", angle_rad);
                report.positive("sharpness_per_rad", sharpness_per_rad);
                if angle_rad >= std::f64::consts::FRAC_PI_2 {
                    report.add(
                        "angle_rad",
                        format!("a wing stalls below pi/2, not at {angle_rad} rad"),
                        "an angle here is in rad",
                    );
                }
            });
        }
    }
}

impl RudderSpec {
    fn check(&self, report: &mut FieldReport) {
        report.non_negative("area_m2", self.area_m2);
        for (field, value) in [
            ("aspect_ratio", self.aspect_ratio),
            ("oswald_factor", self.oswald_factor),
        ] {
            if let Some(value) = value {
                report.positive(field, value);
            }
        }
        if let Some(drag) = self.zero_lift_drag {
            report.non_negative("zero_lift_drag", drag);
        }
        check_place(report, self.arm_m, self.height_m);
        report.within("deflection", |report| {
            self.deflection.check(report);
            if self.deflection.limit > std::f64::consts::FRAC_PI_2 {
                report.add(
                    "limit",
                    format!(
                        "a rudder does not turn by {} rad to either side",
                        self.deflection.limit
                    ),
                    "an angle here is in rad",
                );
            }
        });
    }
}

/// An arm is a distance: the side says where.
fn check_place(report: &mut FieldReport, arm_m: f64, height_m: f64) {
    if !(arm_m.is_finite() && arm_m >= 0.0) {
        report.add(
            "arm_m",
            format!("`arm_m` must not be negative, it is {arm_m}"),
            "the side is said by `side: Ahead` or `side: Aft`",
        );
    }
    report.finite("height_m", height_m);
}

/// A lifting surface, resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiftingSurface {
    /// Area, m^2.
    pub area_m2: f64,
    /// Slope of its lift coefficient, 1/rad.
    pub lift_slope_per_rad: f64,
    /// Drag coefficient without lift.
    pub zero_lift_drag: f64,
    /// 1/(pi AR e), by which the square of the lift coefficient adds to the drag; zero for a surface without
    /// drag.
    pub induced_drag: f64,
    /// Whether it has drag at all.
    pub has_drag: bool,
    /// Aerodynamic centre from the centre of mass, body frame, m.
    pub centre_m: DVec3,
}

/// A sail, resolved: what its forces are made of.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct SailShape {
    /// The main wing.
    pub wing: LiftingSurface,
    /// The rudder.
    pub rudder: LiftingSurface,
    /// What the lift coefficient of the wing adds to the incidence of the rudder, rad: -2/(pi AR) with the
    /// right sign.
    pub downwash_rad: f64,
    /// Angle (rad) and sharpness (1/rad) of stall.
    pub stall: Option<(f64, f64)>,
    /// Which motion counts.
    pub airspeed: SailAirspeed,
}

impl Sail {
    /// What its forces are made of.
    #[must_use]
    pub fn shape(&self) -> SailShape {
        let pi = std::f64::consts::PI;
        let (wing, rudder) = (&self.wing, &self.rudder);
        let rudder_ratio = rudder.aspect_ratio.unwrap_or(wing.aspect_ratio);
        let rudder_oswald = rudder.oswald_factor.unwrap_or(wing.oswald_factor);
        let has_drag = rudder.zero_lift_drag.is_some();
        SailShape {
            wing: LiftingSurface {
                area_m2: wing.area_m2,
                lift_slope_per_rad: self.lift_slope.per_rad(wing.aspect_ratio),
                zero_lift_drag: wing.zero_lift_drag,
                induced_drag: 1.0 / (pi * wing.aspect_ratio * wing.oswald_factor),
                has_drag: true,
                centre_m: DVec3::new(wing.side.sign() * wing.arm_m, 0.0, wing.height_m),
            },
            rudder: LiftingSurface {
                area_m2: rudder.area_m2,
                lift_slope_per_rad: self.lift_slope.per_rad(rudder_ratio),
                zero_lift_drag: rudder.zero_lift_drag.unwrap_or(0.0),
                induced_drag: if has_drag {
                    1.0 / (pi * rudder_ratio * rudder_oswald)
                } else {
                    0.0
                },
                has_drag,
                centre_m: DVec3::new(rudder.side.sign() * rudder.arm_m, 0.0, rudder.height_m),
            },
            downwash_rad: self.downwash.sign() * 2.0 / (pi * wing.aspect_ratio),
            stall: match self.stall {
                StallSpec::None => None,
                StallSpec::FlatPlate {
                    angle_rad,
                    sharpness_per_rad,
                } => Some((angle_rad, sharpness_per_rad)),
            },
            airspeed: self.airspeed,
        }
    }
}

/// The actuator that turns the rudder of a sail.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct RudderActuator(pub Entity);

/// What holds a sail level: a spring and a damper against tilt (N m/rad, N m s), so stiff that they stand for
/// a constraint.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct LevelHold {
    /// Torque over tilt, N m/rad.
    pub stiffness_n_m: f64,
    /// Torque over rate of tilt, N m s.
    pub damping_n_m_s: f64,
}

/// What acts on a sail now.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct SailLoads {
    /// Incidence of the wing, rad.
    pub wing_incidence_rad: f64,
    /// Incidence of the rudder, rad.
    pub rudder_incidence_rad: f64,
    /// Lift of the wing, N; positive to starboard (-y) of a sail that moves ahead.
    pub wing_lift_n: f64,
    /// Lift of the rudder, N.
    pub rudder_lift_n: f64,
    /// Drag of both, N.
    pub drag_n: f64,
    /// Force, body frame, N.
    pub force_n: DVec3,
    /// Torque about the centre of mass, body frame, N m.
    pub torque_n_m: DVec3,
}
