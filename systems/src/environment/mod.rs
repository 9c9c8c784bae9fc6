//! The environment: gravity, air and wind, and the air at every entity that needs it.

pub mod air_at;
pub mod atmosphere;
pub mod atmosphere_table;
pub mod exponential_cells;
pub mod gust;
pub mod gusts_at;
pub mod knots;
pub mod monotone_cubic;
pub mod sphere_drag;
pub mod standard_atmosphere_1976;
pub mod table_csv;
pub mod vira;
pub mod viscosity;
pub mod wind;
pub mod wind_profile;
pub mod zonal_wind;

use aerobot_components::environment::Gravity;
use bevy_ecs::resource::Resource;

use atmosphere::Atmosphere;
use wind::Wind;

/// Gravity, air and wind of a running world.
#[derive(Resource, Clone, Debug)]
pub struct EnvironmentModel {
    /// Gravity.
    pub gravity: Gravity,
    /// The air.
    pub atmosphere: Atmosphere,
    /// The wind.
    pub wind: Wind,
}
