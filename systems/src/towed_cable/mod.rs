//! The static shape of a cable that a held top tows a body on, as a continuous line: an answer to
//! compare discrete tethers with, which shares no line of code with them.
//!
//! ```text
//! dT/ds   = m' g cos phi + (1 + e) 1/2 rho pi C_t d u |u| sin phi |sin phi|
//! dphi/ds = (-m' g sin phi + (1 + e) 1/2 rho C_n d u |u| cos phi |cos phi|) / T
//! dx/ds   = -(1 + e) sin phi        dz/ds = (1 + e) cos phi        e = T / EA
//!
//! at the body:  T sin phi = 1/2 rho C_d S u |u|        T cos phi = (m - rho V) g
//! at the top:   z = z_top
//! ```
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s | arc length of the unstretched line, from the body upwards | m |
//! | T, phi | tension; angle of the line from the vertical, positive where it trails towards +x downwards | N, rad |
//! | x, z | horizontal place along the wind; altitude | m |
//! | e, EA | strain; axial stiffness, infinite for a line that does not stretch | 1, N |
//! | m', d | mass of a metre of unstretched line; diameter, which stretching leaves as it is | kg/m, m |
//! | C_n, C_t | drag across the line, and along it on the wetted area (hence pi) | 1 |
//! | rho, u, g | density, horizontal wind along x in the frame of the top, gravity; all of altitude | kg/m^3, m/s, m/s^2 |
//! | m, C_d S, V | mass of the body, its drag area, the volume it displaces | kg, m^2, m^3 |
//!
//! Sources: M. S. Triantafyllou and F. S. Hover, "Maneuvering and Control of Marine Vehicles" (Dept.
//! of Ocean Engineering, MIT, 2003), on towing; F. S. Hover, M. A. Grosenbaugh and M. S. Triantafyllou,
//! "Calculation of Dynamic Motions and Tensions in Towed Underwater Cables", IEEE J. Oceanic Eng. 19
//! (1994) 449-457. The drag is per metre of stretched line, as in `forces/segment_drag.rs`.
//!
//! Assumptions: the plane of wind and vertical; no bending stiffness; no buoyancy of the line; nothing
//! moves. Found by shooting: from a guess of the body's altitude upwards, until the top comes out where
//! it is held. Where the wind grows with altitude more than one shape may be in equilibrium; then this
//! is one of them.

mod bracketed_root;
mod runge_kutta;
mod shooting;

#[cfg(test)]
mod tests;

use thiserror::Error;

use shooting::{Shooting, State};

/// The line: uniform, round, linear in its stretch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Unstretched length, m; above zero.
    pub length_m: f64,
    /// Mass of a metre of unstretched line m', kg/m; zero or more.
    pub mass_per_length_kg_m: f64,
    /// Diameter d, m; zero or more.
    pub diameter_m: f64,
    /// Axial stiffness EA, N; above zero, infinite for a line that does not stretch.
    pub axial_stiffness_n: f64,
    /// Coefficient C_n of drag across the line; zero or more.
    pub normal_drag: f64,
    /// Coefficient C_t of drag along the line; zero or more.
    pub tangential_drag: f64,
}

/// What hangs at the lower end, as a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TowedBody {
    /// Mass, kg; zero or more.
    pub mass_kg: f64,
    /// Drag coefficient times reference area C_d S, m^2; zero or more.
    pub drag_area_m2: f64,
    /// Volume of air that it displaces, m^3; zero or more. Lift above the weight tows it upwards.
    pub displaced_volume_m3: f64,
}

/// Air and gravity at one altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Density of the air, kg/m^3.
    pub density_kg_m3: f64,
    /// Horizontal velocity of the air along x, in the frame of the held top, m/s.
    pub wind_m_s: f64,
    /// Gravity along -z, m/s^2.
    pub gravity_m_s2: f64,
}

/// Air and gravity over altitude; any `Fn(altitude_m) -> Option<Conditions>` is one.
pub trait Surroundings {
    /// What there is at an altitude in m; `None` where it is not known.
    fn at(&self, altitude_m: f64) -> Option<Conditions>;
}

impl<F: Fn(f64) -> Option<Conditions>> Surroundings for F {
    fn at(&self, altitude_m: f64) -> Option<Conditions> {
        self(altitude_m)
    }
}

/// A body on a line whose upper end is held at x = 0 and a given altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TowedCable {
    /// The line.
    pub line: Line,
    /// The body at its lower end.
    pub body: TowedBody,
    /// Altitude of the held top z_top, m.
    pub top_altitude_m: f64,
}

/// A point of the line in equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapePoint {
    /// Arc length of the unstretched line from the held top, m.
    pub from_top_m: f64,
    /// Horizontal distance from the top along the wind, m.
    pub x_m: f64,
    /// Altitude, m.
    pub z_m: f64,
    /// Tension, N.
    pub tension_n: f64,
    /// Angle of the line from the vertical, positive where it trails towards +x downwards, rad.
    pub angle_rad: f64,
}

/// A line in equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticShape {
    /// The points that were asked for, in the order they were asked for.
    pub points: Vec<ShapePoint>,
    /// The upper end: its tension is the force on what holds it.
    pub top: ShapePoint,
    /// The lower end, where the body is: `x_m` is its offset.
    pub body: ShapePoint,
    /// How far the body is below the top, m.
    pub depth_m: f64,
}

/// Why there is no shape.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TowedCableError {
    /// A number that makes no sense.
    #[error("`{field}` must be {wanted}, it is {value}")]
    BadInput {
        /// The field.
        field: &'static str,
        /// What it should be.
        wanted: &'static str,
        /// What it is.
        value: f64,
    },
    /// The line reaches an altitude where air and gravity are not known.
    #[error("nothing is known of the air at {altitude_m} m, where the line passes")]
    Unknown {
        /// The altitude, m.
        altitude_m: f64,
    },
    /// Nothing pulls the line taut.
    #[error("the line has no tension {from_body_m} m from the body, so it has no direction there")]
    Slack {
        /// Arc length from the body, m.
        from_body_m: f64,
    },
    /// No altitude of the body brings the top to where it is held.
    #[error("no altitude of the body between {lowest_m} m and {highest_m} m is in equilibrium")]
    NoEquilibrium {
        /// Lowest altitude tried, m.
        lowest_m: f64,
        /// Highest altitude tried, m.
        highest_m: f64,
    },
    /// Air or line change too abruptly to be followed.
    #[error("the line cannot be followed {from_body_m} m from the body: the steps grow too short")]
    TooAbrupt {
        /// Arc length from the body, m.
        from_body_m: f64,
    },
}

impl TowedCable {
    /// The shape in equilibrium, good to 1e-9 of the length, with points at `from_top_m` (arc lengths
    /// of the unstretched line from the held top, m, in any order).
    ///
    /// # Errors
    /// A number out of its range, air that is not known where the line passes, a line without tension,
    /// or no equilibrium.
    pub fn solve(
        &self,
        surroundings: &dyn Surroundings,
        from_top_m: &[f64],
    ) -> Result<StaticShape, TowedCableError> {
        self.check(from_top_m)?;
        let shooting = Shooting {
            cable: self,
            surroundings,
        };
        let body_altitude_m = shooting.body_altitude_m()?;
        let mut order: Vec<usize> = (0..from_top_m.len()).collect();
        // From the body upwards.
        order.sort_by(|a, b| from_top_m[*b].total_cmp(&from_top_m[*a]));
        let stops: Vec<f64> = order
            .iter()
            .map(|place| self.line.length_m - from_top_m[*place])
            .collect();
        let (start, passed, end) = shooting.fly(body_altitude_m, &stops)?;
        let point = |state: &State, from_body_m: f64| ShapePoint {
            from_top_m: self.line.length_m - from_body_m,
            x_m: state.x_m - end.x_m,
            z_m: body_altitude_m + state.above_body_m,
            tension_n: state.tension_n,
            angle_rad: state.angle_rad,
        };
        let mut points = vec![ShapePoint::default(); from_top_m.len()];
        for ((place, state), stop) in order.iter().zip(&passed).zip(&stops) {
            points[*place] = ShapePoint {
                from_top_m: from_top_m[*place],
                ..point(state, *stop)
            };
        }
        Ok(StaticShape {
            points,
            top: point(&end, self.line.length_m),
            body: point(&start, 0.0),
            depth_m: self.top_altitude_m - body_altitude_m,
        })
    }

    fn check(&self, from_top_m: &[f64]) -> Result<(), TowedCableError> {
        let (line, body) = (&self.line, &self.body);
        let positive = |value: f64| value > 0.0;
        let refuse = |field, wanted, value| {
            Err(TowedCableError::BadInput {
                field,
                wanted,
                value,
            })
        };
        if !(positive(line.length_m) && line.length_m.is_finite()) {
            return refuse("length_m", "finite and above zero", line.length_m);
        }
        if !positive(line.axial_stiffness_n) {
            return refuse("axial_stiffness_n", "above zero", line.axial_stiffness_n);
        }
        for (field, value) in [
            ("mass_per_length_kg_m", line.mass_per_length_kg_m),
            ("diameter_m", line.diameter_m),
            ("normal_drag", line.normal_drag),
            ("tangential_drag", line.tangential_drag),
            ("mass_kg", body.mass_kg),
            ("drag_area_m2", body.drag_area_m2),
            ("displaced_volume_m3", body.displaced_volume_m3),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return refuse(field, "finite and zero or more", value);
            }
        }
        if !self.top_altitude_m.is_finite() {
            return refuse("top_altitude_m", "finite", self.top_altitude_m);
        }
        let off_the_line = |place: &&f64| !(0.0..=line.length_m).contains(*place);
        match from_top_m.iter().find(off_the_line) {
            Some(place) => refuse("from_top_m", "between zero and the length", *place),
            None => Ok(()),
        }
    }
}
