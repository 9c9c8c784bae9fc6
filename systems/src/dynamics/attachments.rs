//! Attachments of tethers to bodies: where they are, and what they pass on.
//!
//! Position p + R r, velocity v + R (omega x r), acceleration a + R (alpha x r + omega x (omega x r));
//! r offset in the body frame (m), R body to inertial, omega and alpha in the body frame. A force F
//! at the attachment is a force F and a torque (R r) x F on the body.

use aerobot_components::state::{
    Acceleration, AngularAcceleration, AngularVelocity, Attitude, Force, Position, Torque, Velocity,
};
use aerobot_components::tether::Attachment;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::query::Without;
use bevy_ecs::system::Query;

/// Puts every attachment where its carrier has it.
pub fn place_attachments(
    carriers: Query<(&Position, &Velocity, &Attitude, &AngularVelocity), Without<Attachment>>,
    mut attachments: Query<(&Attachment, &mut Position, &mut Velocity)>,
) {
    for (attachment, mut position, mut velocity) in &mut attachments {
        let Ok((carrier_position, carrier_velocity, attitude, rate)) =
            carriers.get(attachment.carrier)
        else {
            continue;
        };
        let arm = attachment.offset_m;
        position.bypass_change_detection().0 = carrier_position.0 + attitude.0 * arm;
        velocity.bypass_change_detection().0 = carrier_velocity.0 + attitude.0 * rate.0.cross(arm);
    }
}

/// Passes the force on every attachment to its carrier.
pub fn load_carriers(
    attachments: Query<(&Attachment, &Force)>,
    mut carriers: Query<(&Attitude, &mut Force, &mut Torque), Without<Attachment>>,
) {
    for (attachment, load) in &attachments {
        let Ok((attitude, mut force, mut torque)) = carriers.get_mut(attachment.carrier) else {
            continue;
        };
        force.0 += load.0;
        torque.0 += (attitude.0 * attachment.offset_m).cross(load.0);
    }
}

/// Finds the acceleration of every attachment from that of its carrier.
pub fn accelerate_attachments(
    carriers: Query<
        (
            &Acceleration,
            &AngularAcceleration,
            &Attitude,
            &AngularVelocity,
        ),
        Without<Attachment>,
    >,
    mut attachments: Query<(&Attachment, &mut Acceleration)>,
) {
    for (attachment, mut acceleration) in &mut attachments {
        let Ok((linear, angular, attitude, rate)) = carriers.get(attachment.carrier) else {
            continue;
        };
        let arm = attachment.offset_m;
        let turning = angular.0.cross(arm) + rate.0.cross(rate.0.cross(arm));
        acceleration.0 = linear.0 + attitude.0 * turning;
    }
}
