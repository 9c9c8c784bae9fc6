//! What a winch does: its power and work, and the line that is out.
//!
//! With T = T_k + T_c of spring and damper, strain e = L/L0 - 1, rate r of paying out and line of mu kg/m, all
//! that the winch feeds to the mechanical energy is
//!
//! ```text
//! P = -r (T_k (1 + e/2) + T_c (1 + e)) + mu r/2 (phi_far - phi_near)
//! ```
//!
//! The last term is the weight of new line between the winch and the far point, so that P is -r times the
//! force at the winch in a slow pay-out. Dampers take c (dL/dt - r L/L0)^2 and the taking up of mass
//! mu |r|/4 (v_far - v_near)^2 besides. A rigid link keeps its unstretched length: its strain is none, T its force
//! of constraint, P = -r T + mu r/2 (phi_far - phi_near).

use aerobot_components::body::Anchor;
use aerobot_components::segment::{KelvinVoigt, RigidLink, SegmentGeometry, Tension};
use aerobot_components::state::{FirstOrderState, Position, Velocity};
use aerobot_components::tether::{Attachment, TetherParts};
use aerobot_components::winch::ReeledLine;
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_ecs::query::{Has, With, Without};
use bevy_ecs::system::{Query, Res, ResMut};

use super::channel_log::{BuiltInChannels, ChannelLog};
use crate::environment::EnvironmentModel;

/// Name of the channel of the power that a winch feeds to the mechanical energy.
pub const WINCH_POWER: &str = "winch_power_w";
/// Name of the channel of its work since the start.
pub const WINCH_WORK: &str = "winch_work_j";
/// Name of the channel of the unstretched length that is out.
pub const LINE_OUT: &str = "line_out_m";

/// The power at a reeled line.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct ReelPower {
    /// What the winch feeds to the mechanical energy, W.
    pub winch_w: f64,
    /// Change of the mechanical energy by the change of lengths and masses, which no force does, W.
    pub by_change_w: f64,
    /// What the damper passes from the winch, W.
    pub by_damper_w: f64,
}

/// Integrates the work of the winch of a line.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub struct WinchWork(pub Entity);

/// Finds the power of every winch, when tensions are known.
pub fn winch_power(
    environment: Res<EnvironmentModel>,
    mut lines: Query<(&ReeledLine, &mut ReelPower)>,
    segments: Query<(&KelvinVoigt, &SegmentGeometry, &Tension, Has<RigidLink>)>,
    points: Query<(&Position, &Velocity)>,
    (ends, anchors): (Query<&Attachment>, Query<(), With<Anchor>>),
    mut works: Query<(&WinchWork, &mut FirstOrderState), Without<ReeledLine>>,
) {
    for (line, mut power) in &mut lines {
        *power = ReelPower::default();
        let (Ok((spring, geometry, tension, is_rigid)), Ok(near), Ok(far)) = (
            segments.get(line.segment),
            points.get(line.near),
            points.get(line.far),
        ) else {
            continue;
        };
        let rate = line.rate_m_s;
        let mut stretch_m = geometry.length_m - spring.rest_length_m;
        if spring.slack {
            stretch_m = stretch_m.max(0.0);
        }
        let strain = stretch_m / spring.rest_length_m;
        let elastic_n = spring.stiffness_n_m * stretch_m;
        let by_spring = if is_rigid {
            0.0
        } else {
            -rate * elastic_n * (1.0 + 0.5 * strain)
        };
        // All that a rigid link passes on is a force like that of a damper: it has no potential.
        power.by_damper_w = if is_rigid {
            -rate * tension.0
        } else {
            -rate * (tension.0 - elastic_n) * (1.0 + strain)
        };
        let flow_kg_s = 0.5 * line.line_kg_m * rate;
        let gravity = environment.gravity;
        let height_j_kg = |at: (&Position, &Velocity)| gravity.potential_j_kg(at.0.0.z);
        // Masses on anchors do not count in the energy.
        let energy_j_kg = |point: Entity, at: (&Position, &Velocity)| {
            let end = ends.get(point);
            if end.is_ok_and(|end| anchors.contains(end.carrier)) {
                return 0.0;
            }
            height_j_kg(at) + 0.5 * at.1.0.length_squared()
        };
        let by_height = flow_kg_s * (height_j_kg(far) - height_j_kg(near));
        let by_mass = flow_kg_s * (energy_j_kg(line.far, far) - energy_j_kg(line.near, near));
        power.by_change_w = by_spring + by_mass;
        power.winch_w = by_spring + by_height + power.by_damper_w;
    }
    for (work, mut state) in &mut works {
        state.rate_per_s = lines.get(work.0).map_or(0.0, |(_, power)| power.winch_w);
    }
}

/// Records what the winches of tethers do that ask for it.
pub fn winch(
    mut log: ResMut<ChannelLog>,
    lines: Query<(Entity, &ReeledLine, &ReelPower)>,
    (works, lengths): (
        Query<(&WinchWork, &FirstOrderState)>,
        Query<&FirstOrderState>,
    ),
    tethers: Query<(&BuiltInChannels, &TetherParts)>,
    springs: Query<(), With<KelvinVoigt>>,
) {
    for (entity, line, power) in &lines {
        let Ok((channels, parts)) = tethers.get(line.tether) else {
            continue;
        };
        let work_j = works
            .iter()
            .find(|(work, _)| work.0 == entity)
            .map_or(0.0, |(_, state)| state.value);
        // Those beyond the winch have their nominal length; what is cut has none.
        let beyond = parts
            .segments
            .iter()
            .filter(|segment| **segment != line.segment && springs.contains(**segment));
        let reeled_m = lengths.get(entity).map_or(0.0, |state| state.value);
        let out_m = reeled_m + line.nominal_m * beyond.count() as f64;
        for (channel, value) in [
            (WINCH_POWER, power.winch_w),
            (WINCH_WORK, work_j),
            (LINE_OUT, out_m),
        ] {
            if channels.has(channel) {
                log.record(line.tether, channel, value);
            }
        }
    }
}
