//! The autopilot in the run: at its samples it looks at the accepted state, asks its guidance, and holds what
//! comes out until the next.

use aerobot_components::fixed_wing::FixedWing;
use aerobot_components::fixed_wing::controls::Controls;
use aerobot_components::fixed_wing::guidance::{GuidanceSpec, Pursuit, Reference};
use aerobot_components::sampling::Sampling;
use aerobot_components::state::{Air, AngularVelocity, Attitude, Position, Velocity};
use aerobot_systems::clock::Clock;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::fixed_wing::autopilot::{
    Autopilot, Command, LateralCommand, Memory, Sensed, VerticalCommand, course_rad,
};
use aerobot_systems::fixed_wing::chase::{Chase, ChaseState, Rules, Seen};
use aerobot_systems::fixed_wing::guidance::{
    MovingLine, MovingOrbit, MovingPoint, Station, follow_line, follow_orbit,
    proportional_navigation, pursue,
};
use aerobot_systems::fixed_wing::north_east_down::{attitude, roll_pitch_yaw, vector};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::system::{Query, Res, ResMut};
use glam::DVec3;

use super::start::DroneTrim;
use crate::world::{Discontinuity, EntityName, EventLog};

/// Marks what samples for the autopilot of a drone.
#[derive(Component, Clone, Copy, Debug)]
pub(super) struct AutopilotOf(pub(super) Entity);

/// An autopilot at work.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(super) struct Flying {
    pub(super) autopilot: Autopilot,
    pub(super) memory: Memory,
    pub(super) chase: Chase,
    /// The entity that its guidance names.
    pub(super) target: Option<Entity>,
    /// The last thing it was asked for.
    pub(super) last: Option<Command>,
    /// Pitch asked for in the end game, rad.
    pub(super) end_game_pitch_rad: Option<f64>,
}

/// Airspeeds that guidance asks for begin at so many times the least of level flight: near that the elevator has
/// nothing left to steer with.
pub(super) const LEAST_MARGIN: f64 = 1.15;
/// They end at this part of the greatest.
const MOST_MARGIN: f64 = 0.998;

type Drones<'w, 's> = Query<
    'w,
    's,
    (
        &'static FixedWing,
        &'static DroneTrim,
        &'static Position,
        &'static Velocity,
        &'static Attitude,
        &'static AngularVelocity,
        &'static Air,
        &'static mut Flying,
        &'static mut Controls,
        &'static EntityName,
    ),
>;

/// Samples every autopilot that is due.
pub(super) fn control(
    clock: Res<Clock>,
    environment: Res<EnvironmentModel>,
    mut discontinuity: ResMut<Discontinuity>,
    mut events: ResMut<EventLog>,
    mut samplers: Query<(&AutopilotOf, &mut Sampling)>,
    mut drones: Drones,
    targets: Query<(&Position, &Velocity)>,
) {
    for (of, mut sampling) in &mut samplers {
        if !sampling.is_due(clock.time_s) {
            continue;
        }
        sampling.done(clock.time_s);
        let Ok((drone, trim, position, velocity, turned, rate, air, mut flying, mut held, name)) =
            drones.get_mut(of.0)
        else {
            continue;
        };
        let here = MovingPoint {
            position_m: vector(position.0),
            velocity_m_s: vector(velocity.0),
        };
        let target = flying.target.and_then(|target| targets.get(target).ok());
        let target = target.map(|(position, velocity)| MovingPoint {
            position_m: vector(position.0),
            velocity_m_s: vector(velocity.0),
        });
        let wind_m_s = vector(drone.wind.velocity_m_s(air.velocity_m_s));
        let spec = drone.autopilot;
        let flying = &mut *flying;
        flying
            .memory
            .average_wind(wind_m_s, spec.wind_average_s, spec.period_s);
        let mut guide = Guide {
            drone,
            trim,
            here,
            target,
            time_s: clock.time_s,
            throttle: held.throttle,
            pitch_rad: roll_pitch_yaw(attitude(turned.0)).y,
            wind_m_s: flying.memory.steady_wind_m_s,
            flying,
        };
        let (command, event) = guide.command();
        if let Some(event) = event {
            events.add(clock.time_s, event, &name.0);
        }
        let Some(command) = command else {
            continue;
        };
        let sensed = Sensed {
            attitude: attitude(turned.0),
            rate_rad_s: vector(rate.0),
            velocity_m_s: here.velocity_m_s,
            wind_m_s,
            altitude_m: position.0.z,
            gravity_m_s2: environment.gravity.acceleration_m_s2(position.0.z),
        };
        let autopilot = flying.autopilot;
        *held = autopilot.sample(&mut flying.memory, &sensed, &command);
        flying.last = Some(command);
        discontinuity.0 = true;
    }
}

/// What a guidance knows; north-east-down.
struct Guide<'a> {
    drone: &'a FixedWing,
    trim: &'a DroneTrim,
    here: MovingPoint,
    target: Option<MovingPoint>,
    time_s: f64,
    throttle: f64,
    pitch_rad: f64,
    wind_m_s: DVec3,
    flying: &'a mut Flying,
}

impl Guide<'_> {
    /// What the autopilot is asked for, and what is worth telling.
    fn command(&mut self) -> (Option<Command>, Option<&'static str>) {
        let drone = self.drone;
        let command = match &drone.guidance {
            GuidanceSpec::None => None,
            GuidanceSpec::Hold {
                course_deg,
                altitude_m,
                airspeed_m_s,
            } => Some(Command {
                lateral: LateralCommand::Course(-course_deg.to_radians(), 0.0),
                vertical: VerticalCommand::Altitude(*altitude_m, 0.0),
                airspeed_m_s: *airspeed_m_s,
            }),
            GuidanceSpec::Line {
                through,
                along,
                airspeed_m_s,
                approach_m,
            } => self.reference(through).map(|through| {
                let line = MovingLine {
                    through,
                    along: vector(*along),
                    approach_m: *approach_m,
                };
                follow_line(&line, self.here.position_m, self.wind_m_s, *airspeed_m_s)
            }),
            GuidanceSpec::Orbit {
                about,
                radius_m,
                clockwise,
                airspeed_m_s,
            } => self.reference(about).map(|centre| {
                let orbit = MovingOrbit {
                    centre,
                    radius_m: *radius_m,
                    clockwise: *clockwise,
                };
                follow_orbit(&orbit, self.here.position_m, self.wind_m_s, *airspeed_m_s)
            }),
            GuidanceSpec::Pursue(pursuit) => return self.pursue(pursuit),
        };
        (command, None)
    }

    fn reference(&self, reference: &Reference) -> Option<MovingPoint> {
        match reference {
            Reference::Entity(_) => self.target,
            Reference::Point {
                position_m,
                velocity_m_s,
            } => Some(MovingPoint {
                position_m: vector(*position_m + self.time_s * *velocity_m_s),
                velocity_m_s: vector(*velocity_m_s),
            }),
        }
    }

    fn pursue(&mut self, pursuit: &Pursuit) -> (Option<Command>, Option<&'static str>) {
        let Some(target) = self.target else {
            return (None, None);
        };
        let (least, most) = self.trim.level_m_s;
        let inside = (least * LEAST_MARGIN, most * MOST_MARGIN);
        let station = Station {
            point: MovingPoint {
                position_m: target.position_m + vector(pursuit.offset_m),
                ..target
            },
            approach_m: pursuit.approach_m,
            closing_per_s: pursuit.closing_per_s,
            airspeeds_m_s: pursuit.airspeeds_m_s.unwrap_or(inside),
        };
        let seen = self.seen(&station, &target);
        let rules = Rules {
            station_m: pursuit.station_m,
            level_m_s: self.trim.level_m_s,
            patience_s: pursuit.patience_s,
            end_game_m: pursuit.end_game.map(|end_game| end_game.within_m),
        };
        let period_s = self.drone.autopilot.period_s;
        let event = self.flying.chase.advance(&seen, &rules, period_s);
        let command = match (self.flying.chase.state, pursuit.end_game) {
            (ChaseState::EndGame, Some(end_game)) => {
                self.end_game(&target, end_game.navigation_constant, end_game.airspeed_m_s)
            }
            (ChaseState::Passed, _) => self.straight_on(),
            _ => pursue(&station, self.here.position_m, self.wind_m_s),
        };
        (Some(command), event)
    }

    fn seen(&self, station: &Station, target: &MovingPoint) -> Seen {
        let from_station = self.here.position_m - station.point.position_m;
        let from_target = self.here.position_m - target.position_m;
        let against = self.here.velocity_m_s - target.velocity_m_s;
        let (station_m, range_m) = (from_station.length(), from_target.length());
        Seen {
            station_m,
            parting_m_s: from_station.dot(against) / station_m.max(1e-9),
            required_m_s: (target.velocity_m_s - self.wind_m_s).length(),
            range_m,
            closing_m_s: -from_target.dot(against) / range_m.max(1e-9),
            throttle: self.throttle,
            at_pitch_limit: self.flying.memory.at_pitch_limit,
        }
    }

    /// Proportional navigation as a roll and a pitch: tan(roll) = a/g across the path in the horizontal, and a
    /// pitch that turns at a/V as the path is to.
    fn end_game(&mut self, target: &MovingPoint, constant: f64, airspeed_m_s: f64) -> Command {
        let Some(wanted) = proportional_navigation(constant, &self.here, target) else {
            return self.straight_on();
        };
        let through_air = self.here.velocity_m_s - self.wind_m_s;
        let (sin, cos) = libm::sincos(course_rad(through_air));
        let to_the_right = wanted.dot(DVec3::new(-sin, cos, 0.0));
        let trim = &self.flying.autopilot.trim;
        let roll = trim.roll_rad + libm::atan(to_the_right / self.trim.gravity_m_s2);
        let turned = -wanted.z / through_air.length().max(1.0) * self.drone.autopilot.period_s;
        let pitch = self.flying.end_game_pitch_rad.unwrap_or(self.pitch_rad) + turned;
        self.flying.end_game_pitch_rad = Some(pitch);
        Command {
            lateral: LateralCommand::Roll(roll),
            vertical: VerticalCommand::Pitch(pitch),
            airspeed_m_s,
        }
    }

    /// The course and the altitude as they were when this was first asked for.
    fn straight_on(&self) -> Command {
        let through_air = self.here.velocity_m_s - self.wind_m_s;
        let last = self.flying.last;
        let lateral = match last.map(|command| command.lateral) {
            Some(LateralCommand::Course(course, _)) => LateralCommand::Course(course, 0.0),
            _ => LateralCommand::Course(course_rad(through_air), 0.0),
        };
        let vertical = match last.map(|command| command.vertical) {
            Some(VerticalCommand::Altitude(altitude, _)) => {
                VerticalCommand::Altitude(altitude, 0.0)
            }
            _ => VerticalCommand::Altitude(-self.here.position_m.z, 0.0),
        };
        Command {
            lateral,
            vertical,
            airspeed_m_s: self.flying.autopilot.trim.flight.airspeed_m_s,
        }
    }
}
