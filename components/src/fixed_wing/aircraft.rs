//! The coefficients of a fixed-wing aircraft: geometry, aerodynamics, propeller and motor.
//!
//! Definitions as in Beard and McLain, "Small Unmanned Aircraft: Theory and Practice", Princeton University
//! Press 2012, ch. 4; the propeller and the motor as in the revision of that chapter (2018) that the authors
//! publish with the book. Body axes forward, right, down; angles in rad; rates made dimensionless with
//! b/(2 V_a) (roll, yaw) and c/(2 V_a) (pitch).

use bevy_ecs::component::Component;
use serde::Deserialize;

use crate::scene_component::FieldReport;

/// Which aircraft.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "aircraft", deny_unknown_fields)]
#[expect(
    clippy::large_enum_variant,
    reason = "one to an aircraft, and copied once"
)]
pub enum AircraftSpec {
    /// The Aerosonde of Beard and McLain: 11 kg, wing of 0.55 m^2. Its `Body` has the tensor
    /// (0.8244, 1.135, 1.759) kg m^2 with the element xz 0.1204.
    #[default]
    Aerosonde,
    /// All coefficients.
    Coefficients(Aircraft),
}

impl AircraftSpec {
    /// The coefficients.
    #[must_use]
    pub fn coefficients(&self) -> Aircraft {
        match self {
            Self::Aerosonde => AEROSONDE,
            Self::Coefficients(aircraft) => *aircraft,
        }
    }

    pub(super) fn check(&self, report: &mut FieldReport) {
        if let Self::Coefficients(aircraft) = self {
            aircraft.check(report);
        }
    }
}

/// An aircraft without its mass and inertia, which are those of its body.
#[derive(Component, Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Aircraft {
    /// Its dimensions.
    pub geometry: Geometry,
    /// Lift, drag, pitching moment.
    pub longitudinal: Longitudinal,
    /// Side force, rolling and yawing moment.
    pub lateral: Lateral,
    /// Propeller and motor.
    pub propulsion: Propulsion,
    /// How far the control surfaces go.
    #[serde(default)]
    pub limits: SurfaceLimits,
}

/// Dimensions of the wing.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Geometry {
    /// Area S, m^2.
    pub wing_area_m2: f64,
    /// Span b, m.
    pub span_m: f64,
    /// Mean chord c, m.
    pub chord_m: f64,
}

/// Derivatives of C_L, C_D and C_m.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Longitudinal {
    /// C_L0.
    pub lift_zero: f64,
    /// C_L alpha.
    pub lift_alpha: f64,
    /// C_L q.
    pub lift_q: f64,
    /// C_L delta_e.
    pub lift_elevator: f64,
    /// How drag grows with the angle of attack.
    pub drag: DragLaw,
    /// C_D q.
    #[serde(default)]
    pub drag_q: f64,
    /// C_D delta_e, on the deflection with its sign, as published.
    #[serde(default)]
    pub drag_elevator: f64,
    /// C_m0.
    pub pitch_zero: f64,
    /// C_m alpha.
    pub pitch_alpha: f64,
    /// C_m q.
    pub pitch_q: f64,
    /// C_m delta_e.
    pub pitch_elevator: f64,
    /// alpha_0, the angle of attack about which the wing stalls, rad.
    pub stall_rad: f64,
    /// M, how sharply it does.
    pub stall_sharpness: f64,
}

/// Drag below the stall.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(rename = "drag", deny_unknown_fields)]
pub enum DragLaw {
    /// C_D = C_D0 + C_D alpha alpha.
    Line {
        /// C_D0.
        zero: f64,
        /// C_D alpha.
        alpha: f64,
    },
    /// C_D = C_Dp + (C_L0 + C_L alpha alpha)^2 / (pi e b^2/S).
    Polar {
        /// C_Dp.
        parasitic: f64,
        /// Oswald's factor e.
        oswald: f64,
    },
}

/// Derivatives of C_Y, C_l and C_n.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Lateral {
    /// C_Y.
    pub side: LateralDerivatives,
    /// C_l.
    pub roll: LateralDerivatives,
    /// C_n.
    pub yaw: LateralDerivatives,
}

/// How one lateral coefficient follows from sideslip, rates and deflections.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct LateralDerivatives {
    /// Its value in symmetric flight.
    #[serde(default)]
    pub zero: f64,
    /// By sideslip.
    #[serde(default)]
    pub beta: f64,
    /// By the rate of roll.
    #[serde(default)]
    pub p: f64,
    /// By the rate of yaw.
    #[serde(default)]
    pub r: f64,
    /// By the aileron.
    #[serde(default)]
    pub aileron: f64,
    /// By the rudder.
    #[serde(default)]
    pub rudder: f64,
}

/// Propeller and electric motor.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Propulsion {
    /// Diameter of the propeller D, m.
    pub diameter_m: f64,
    /// C_T(J) = C_T0 + C_T1 J + C_T2 J^2.
    pub thrust: (f64, f64, f64),
    /// C_Q(J) = C_Q0 + C_Q1 J + C_Q2 J^2.
    pub torque: (f64, f64, f64),
    /// K_V = K_Q of the motor, V s/rad = N m/A.
    pub motor_constant_v_s: f64,
    /// Resistance of the windings R, ohm.
    pub resistance_ohm: f64,
    /// Current without load i_0, A.
    pub no_load_current_a: f64,
    /// Voltage of the battery, V.
    pub battery_v: f64,
    /// Whether the torque of the propeller turns the airframe.
    #[serde(default = "yes")]
    pub reaction: bool,
}

fn yes() -> bool {
    true
}

/// How far the control surfaces go to either side.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct SurfaceLimits {
    /// Aileron, deg.
    pub aileron_deg: f64,
    /// Elevator, deg.
    pub elevator_deg: f64,
    /// Rudder, deg.
    pub rudder_deg: f64,
}

impl Default for SurfaceLimits {
    /// 45 deg each, as the authors' simulation has them.
    fn default() -> Self {
        Self {
            aileron_deg: 45.0,
            elevator_deg: 45.0,
            rudder_deg: 45.0,
        }
    }
}

/// The Aerosonde as Beard and McLain have it (2012; aerodynamics, propeller and motor of their revision of
/// 2018). The sign of C_n p differs between their programs; this is that of the Simulink one.
pub const AEROSONDE: Aircraft = Aircraft {
    geometry: Geometry {
        wing_area_m2: 0.55,
        span_m: 2.8956,
        chord_m: 0.18994,
    },
    longitudinal: Longitudinal {
        lift_zero: 0.23,
        lift_alpha: 5.61,
        lift_q: 7.95,
        lift_elevator: 0.13,
        drag: DragLaw::Line {
            zero: 0.043,
            alpha: 0.03,
        },
        drag_q: 0.0,
        drag_elevator: 0.0135,
        pitch_zero: 0.0135,
        pitch_alpha: -2.74,
        pitch_q: -38.21,
        pitch_elevator: -0.99,
        stall_rad: 0.47,
        stall_sharpness: 50.0,
    },
    lateral: Lateral {
        side: LateralDerivatives {
            zero: 0.0,
            beta: -0.98,
            p: 0.0,
            r: 0.0,
            aileron: 0.075,
            rudder: 0.19,
        },
        roll: LateralDerivatives {
            zero: 0.0,
            beta: -0.13,
            p: -0.51,
            r: 0.25,
            aileron: 0.17,
            rudder: 0.0024,
        },
        yaw: LateralDerivatives {
            zero: 0.0,
            beta: 0.073,
            p: -0.069,
            r: -0.095,
            aileron: -0.011,
            rudder: -0.069,
        },
    },
    propulsion: Propulsion {
        diameter_m: 0.508,
        thrust: (0.09357, -0.06044, -0.1079),
        torque: (0.00523, 0.00497, -0.01664),
        // 60/(2 pi 145): 145 turns a minute and volt.
        motor_constant_v_s: 0.065_857_22,
        resistance_ohm: 0.042,
        no_load_current_a: 1.5,
        battery_v: 44.4,
        reaction: true,
    },
    limits: SurfaceLimits {
        aileron_deg: 45.0,
        elevator_deg: 45.0,
        rudder_deg: 45.0,
    },
};

impl Aircraft {
    /// Aspect ratio b^2/S.
    #[must_use]
    pub fn aspect_ratio(&self) -> f64 {
        self.geometry.span_m * self.geometry.span_m / self.geometry.wing_area_m2
    }

    fn check(&self, report: &mut FieldReport) {
        report.within("geometry", |report| {
            report.positive("wing_area_m2", self.geometry.wing_area_m2);
            report.positive("span_m", self.geometry.span_m);
            report.positive("chord_m", self.geometry.chord_m);
        });
        report.within("longitudinal", |report| self.longitudinal.check(report));
        report.within("lateral", |report| {
            for (name, of) in [
                ("side", self.lateral.side),
                ("roll", self.lateral.roll),
                ("yaw", self.lateral.yaw),
            ] {
                report.within(name, |report| of.check(report));
            }
        });
        report.within("propulsion", |report| self.propulsion.check(report));
        report.within("limits", |report| {
            report.positive("aileron_deg", self.limits.aileron_deg);
            report.positive("elevator_deg", self.limits.elevator_deg);
            report.positive("rudder_deg", self.limits.rudder_deg);
        });
    }
}

impl Longitudinal {
    fn check(&self, report: &mut FieldReport) {
        for (name, value) in [
            ("lift_zero", self.lift_zero),
            ("lift_q", self.lift_q),
            ("lift_elevator", self.lift_elevator),
            ("drag_q", self.drag_q),
            ("drag_elevator", self.drag_elevator),
            ("pitch_zero", self.pitch_zero),
            ("pitch_alpha", self.pitch_alpha),
            ("pitch_q", self.pitch_q),
        ] {
            report.finite(name, value);
        }
        report.positive("lift_alpha", self.lift_alpha);
        if !(self.pitch_elevator.is_finite() && self.pitch_elevator != 0.0) {
            report.add(
                "pitch_elevator",
                "an elevator without a pitching moment steers nothing",
                "negative where a positive deflection pitches down",
            );
        }
        report.positive("stall_rad", self.stall_rad);
        report.positive("stall_sharpness", self.stall_sharpness);
        report.within("drag", |report| match self.drag {
            DragLaw::Line { zero, alpha } => {
                report.non_negative("zero", zero);
                report.finite("alpha", alpha);
            }
            DragLaw::Polar { parasitic, oswald } => {
                report.non_negative("parasitic", parasitic);
                report.positive("oswald", oswald);
            }
        });
    }
}

impl LateralDerivatives {
    fn check(&self, report: &mut FieldReport) {
        for (name, value) in [
            ("zero", self.zero),
            ("beta", self.beta),
            ("p", self.p),
            ("r", self.r),
            ("aileron", self.aileron),
            ("rudder", self.rudder),
        ] {
            report.finite(name, value);
        }
    }
}

impl Propulsion {
    fn check(&self, report: &mut FieldReport) {
        report.positive("diameter_m", self.diameter_m);
        for (name, (zero, one, two)) in [("thrust", self.thrust), ("torque", self.torque)] {
            if !(zero > 0.0 && (zero + one + two).is_finite()) {
                report.add(
                    name,
                    format!(
                        "the coefficients of `{name}` must be finite, and that of a propeller at rest above \
                         zero: ({zero}, {one}, {two})"
                    ),
                    "they are those of 1, J and J^2",
                );
            }
        }
        report.positive("motor_constant_v_s", self.motor_constant_v_s);
        report.positive("resistance_ohm", self.resistance_ohm);
        report.non_negative("no_load_current_a", self.no_load_current_a);
        report.positive("battery_v", self.battery_v);
    }
}
