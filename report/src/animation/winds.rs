//! The wind at bodies, drawn again from the scene and its seed.

use aerobot_engine::builtin::environment::environment_model;
use glam::DVec3;

use super::BodyMotion;
use crate::record::Record;

/// Fills in the velocity of the air at every body in every frame: zero where the scene has none.
pub(super) fn blow(record: &Record, times_s: &[f64], bodies: &mut [BodyMotion]) {
    let Ok(model) = environment_model(&record.scene) else {
        // It was built before it was run.
        return;
    };
    let mut wind = model.wind;
    for (frame, time_s) in times_s.iter().enumerate() {
        wind.begin_interval(*time_s);
        wind.advance_gusts(*time_s);
        for body in bodies.iter_mut() {
            let altitude_m = body.positions_m[frame].z;
            let velocity_m_s = wind.velocity_m_s(altitude_m).unwrap_or(DVec3::ZERO);
            body.wind_m_s.push(velocity_m_s);
        }
    }
}
