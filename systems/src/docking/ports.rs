//! Two ports as they are to each other.

use aerobot_components::docking::DockingPort;
use aerobot_components::state::{AngularVelocity, Attitude, Position, Velocity};
use bevy_ecs::query::QueryData;
use glam::DVec3;

/// A port on a moving body, inertial frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PortMotion {
    /// Place, m.
    pub position_m: DVec3,
    /// Velocity, m/s.
    pub velocity_m_s: DVec3,
    /// Outward, unit length.
    pub axis: DVec3,
}

/// What has a port.
#[derive(QueryData)]
pub struct PortCarrier {
    port: &'static DockingPort,
    position: &'static Position,
    velocity: &'static Velocity,
    attitude: &'static Attitude,
    rate: &'static AngularVelocity,
}

impl PortCarrierItem<'_, '_> {
    /// Where its port is.
    #[must_use]
    pub fn motion(&self) -> PortMotion {
        PortMotion::of(
            self.port,
            (self.position.0, self.velocity.0),
            self.attitude,
            self.rate,
        )
    }
}

impl PortMotion {
    /// Of a port on a body whose centre of mass has this position (m) and velocity (m/s).
    #[must_use]
    pub fn of(
        port: &DockingPort,
        (position_m, velocity_m_s): (DVec3, DVec3),
        attitude: &Attitude,
        rate: &AngularVelocity,
    ) -> Self {
        Self {
            position_m: position_m + attitude.0 * port.at_m,
            velocity_m_s: velocity_m_s + attitude.0 * rate.0.cross(port.at_m),
            axis: attitude.0 * (port.axis / port.axis.length_squared().sqrt()),
        }
    }
}

/// One port as another one has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PortsApart {
    /// From one to the other, m.
    pub distance_m: f64,
    /// At which that becomes less, m/s.
    pub closing_speed_m_s: f64,
    /// Of one against the other, m/s.
    pub speed_m_s: f64,
    /// In front of the target's port along its axis, m.
    pub ahead_m: f64,
    /// Beside that axis, m.
    pub lateral_error_m: f64,
    /// Between one axis and the opposite of the other, rad.
    pub misalignment_rad: f64,
}

impl PortsApart {
    /// Of a port at `own` to one at `target`.
    #[must_use]
    pub fn between(own: &PortMotion, target: &PortMotion) -> Self {
        let from_target = own.position_m - target.position_m;
        let velocity = own.velocity_m_s - target.velocity_m_s;
        let distance_m = from_target.length_squared().sqrt();
        let ahead_m = from_target.dot(target.axis);
        let beside = from_target - ahead_m * target.axis;
        let opposite = -target.axis;
        let closing_speed_m_s = if distance_m > 0.0 {
            -from_target.dot(velocity) / distance_m
        } else {
            0.0
        };
        Self {
            distance_m,
            closing_speed_m_s,
            speed_m_s: velocity.length_squared().sqrt(),
            ahead_m,
            lateral_error_m: beside.length_squared().sqrt(),
            misalignment_rad: libm::atan2(
                own.axis.cross(opposite).length_squared().sqrt(),
                own.axis.dot(opposite),
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A port 3 m in front and 4 m beside, approaching at 2 m/s along the axis, its own axis 0.2 rad off.
    #[test]
    fn ports_are_apart_as_drawn() {
        let target = PortMotion {
            position_m: DVec3::new(1.0, 2.0, 3.0),
            velocity_m_s: DVec3::new(0.0, 1.0, 0.0),
            axis: DVec3::NEG_X,
        };
        let own = PortMotion {
            position_m: DVec3::new(-2.0, 2.0, 7.0),
            velocity_m_s: DVec3::new(2.0, 1.0, 0.0),
            axis: DVec3::new(0.2_f64.cos(), 0.2_f64.sin(), 0.0),
        };
        let apart = PortsApart::between(&own, &target);
        assert_eq!((apart.distance_m, apart.ahead_m), (5.0, 3.0));
        assert_eq!((apart.lateral_error_m, apart.speed_m_s), (4.0, 2.0));
        assert!((apart.closing_speed_m_s - 2.0 * 3.0 / 5.0).abs() < 1e-15);
        assert!((apart.misalignment_rad - 0.2).abs() < 1e-15);
    }
}
