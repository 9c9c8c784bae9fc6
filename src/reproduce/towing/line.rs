//! The shape of the towline, of a continuous cable and of a simulation, in the same terms.

use aerobot_components::aerodynamics::{ConstantDragArea, DisplacedVolume};
use aerobot_components::body::Body;
use aerobot_components::segment::Tension;
use aerobot_components::state::{Acceleration, Force, Mass, Position};
use aerobot_components::tether::{Tether, TetherParts};
use aerobot_engine::scene::{Scene, SceneError};
use aerobot_engine::simulation::Simulation;
use aerobot_engine::world::SceneEntities;
use aerobot_systems::environment::EnvironmentModel;
use aerobot_systems::towed_cable::{Conditions, Line, ShapePoint, TowedBody, TowedCable};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::world::World;
use glam::DVec3;

use super::{PROBE, ReproduceError, TOWLINE};

/// A towline in the vertical plane of the wind.
#[derive(Clone, Debug, PartialEq)]
pub struct LineShape {
    /// Top, nodes, probe.
    pub points: Vec<LinePoint>,
    /// Tension of each segment from the top, N; of a continuous line at the middle of where it is.
    pub segment_tensions_n: Vec<f64>,
    /// Force of the line on what holds its top, N.
    pub top_tension_n: f64,
    /// Angle of that force from the vertical, positive where the line trails towards +x, rad.
    pub top_angle_rad: f64,
}

/// A point of a towline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinePoint {
    /// Arc length of the unstretched line from the top, m.
    pub from_top_m: f64,
    /// Place along the wind, m.
    pub x_m: f64,
    /// Altitude, m.
    pub z_m: f64,
}

impl LineShape {
    /// The lower end.
    #[must_use]
    pub fn probe(&self) -> LinePoint {
        self.points.last().copied().unwrap_or(LinePoint {
            from_top_m: 0.0,
            x_m: 0.0,
            z_m: 0.0,
        })
    }

    /// How far the probe is below the top, m.
    #[must_use]
    pub fn depth_m(&self) -> f64 {
        self.points.first().map_or(0.0, |top| top.z_m) - self.probe().z_m
    }

    /// Largest distance between the points of this line and those of another with as many, m.
    #[must_use]
    pub fn largest_distance_m(&self, other: &Self) -> f64 {
        self.points
            .iter()
            .zip(&other.points)
            .map(|(a, b)| libm::hypot(a.x_m - b.x_m, a.z_m - b.z_m))
            .fold(0.0, f64::max)
    }
}

/// Arc length of point `index` of a tether from its top, in halves of segments, m.
fn from_top_m(tether: &Tether, halves: u32) -> f64 {
    tether.length_m * f64::from(halves) / f64::from(2 * tether.segments())
}

/// The continuous cable of the scene, in the air that the simulation has, where the discrete line has
/// its points and the middles of its segments.
pub(super) fn continuous(
    scene: &Scene,
    simulation: &Simulation,
    tether: &Tether,
) -> Result<LineShape, ReproduceError> {
    let world = simulation.world();
    let model = world.resource::<EnvironmentModel>();
    let cable = TowedCable {
        line: line(tether),
        body: body(scene, world)?,
        top_altitude_m: position_of(world, first_point(world)?)?.z,
    };
    let surroundings = |altitude_m: f64| {
        Some(Conditions {
            density_kg_m3: model.atmosphere.density_kg_m3(altitude_m).ok()?,
            wind_m_s: model.wind.velocity_m_s(altitude_m).ok()?.x,
            gravity_m_s2: model.gravity.acceleration_m_s2(altitude_m),
        })
    };
    let places: Vec<f64> = (0..=2 * tether.segments())
        .map(|halves| from_top_m(tether, halves))
        .collect();
    let shape = cable.solve(&surroundings, &places)?;
    let (points, middles) = shape.points.iter().enumerate().fold(
        (Vec::new(), Vec::new()),
        |(mut points, mut middles), (halves, point)| {
            if halves % 2 == 0 {
                points.push(LinePoint::from(point));
            } else {
                middles.push(point.tension_n);
            }
            (points, middles)
        },
    );
    Ok(LineShape {
        points,
        segment_tensions_n: middles,
        top_tension_n: shape.top.tension_n,
        top_angle_rad: shape.top.angle_rad,
    })
}

impl From<&ShapePoint> for LinePoint {
    fn from(point: &ShapePoint) -> Self {
        Self {
            from_top_m: point.from_top_m,
            x_m: point.x_m,
            z_m: point.z_m,
        }
    }
}

fn line(tether: &Tether) -> Line {
    let drag = tether.drag.map(|drag| (drag.normal, drag.tangential));
    let (normal_drag, tangential_drag) = drag.unwrap_or((0.0, 0.0));
    Line {
        length_m: tether.length_m,
        mass_per_length_kg_m: tether.mass_kg() / tether.length_m,
        diameter_m: tether.diameter_m,
        axial_stiffness_n: tether.axial_stiffness_n,
        normal_drag,
        tangential_drag,
    }
}

fn body(scene: &Scene, world: &World) -> Result<TowedBody, SceneError> {
    let id = entity(world, PROBE)?;
    let body = scene.entity(PROBE).and_then(|probe| probe.get::<Body>());
    Ok(TowedBody {
        mass_kg: body.ok_or_else(|| missing("a `Body`", PROBE))?.mass_kg,
        drag_area_m2: world.get::<ConstantDragArea>(id).map_or(0.0, |area| area.0),
        displaced_volume_m3: world
            .get::<DisplacedVolume>(id)
            .map_or(0.0, |volume| volume.0),
    })
}

/// The towline of a simulation as it stands, after an evaluation.
pub(super) fn discrete(simulation: &Simulation, tether: &Tether) -> Result<LineShape, SceneError> {
    let world = simulation.world();
    let parts = parts(world)?;
    let mut points = Vec::with_capacity(parts.points.len());
    for (halves, point) in (0..).step_by(2).zip(&parts.points) {
        let position = position_of(world, *point)?;
        points.push(LinePoint {
            from_top_m: from_top_m(tether, halves),
            x_m: position.x,
            z_m: position.z,
        });
    }
    let segment_tensions_n = parts
        .segments
        .iter()
        .map(|segment| component::<Tension>(world, *segment).map(|tension| tension.0))
        .collect::<Result<_, _>>()?;
    // On the holder: half a segment's weight and drag hang on the attachment beside its segment.
    let top = first_point(world)?;
    let force = component::<Force>(world, top)?.0;
    let mass = component::<Mass>(world, top)?.0;
    let acceleration = world.get::<Acceleration>(top).map_or(DVec3::ZERO, |a| a.0);
    let pull = force - mass * acceleration;
    Ok(LineShape {
        points,
        segment_tensions_n,
        top_tension_n: pull.length(),
        top_angle_rad: libm::atan2(pull.x, -pull.z),
    })
}

/// What is said if the scene lacks what the case is about.
pub(super) fn missing(what: &str, of: &str) -> SceneError {
    SceneError::plain(format_args!("the towing case needs {what} of `{of}`"))
}

fn entity(world: &World, name: &str) -> Result<Entity, SceneError> {
    let found = world.resource::<SceneEntities>().get(name);
    found.ok_or_else(|| missing("the entity", name))
}

fn parts(world: &World) -> Result<&TetherParts, SceneError> {
    component(world, entity(world, TOWLINE)?)
}

fn first_point(world: &World) -> Result<Entity, SceneError> {
    let points = &parts(world)?.points;
    points
        .first()
        .copied()
        .ok_or_else(|| missing("the points", TOWLINE))
}

fn position_of(world: &World, point: Entity) -> Result<DVec3, SceneError> {
    component::<Position>(world, point).map(|position| position.0)
}

fn component<C: Component>(world: &World, entity: Entity) -> Result<&C, SceneError> {
    let found = world.get::<C>(entity);
    found.ok_or_else(|| missing(std::any::type_name::<C>(), TOWLINE))
}
