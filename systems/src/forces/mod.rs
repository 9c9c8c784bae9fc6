//! Forces, one law a file. Every system here adds to [`Force`](aerobot_components::state::Force),
//! [`Torque`](aerobot_components::state::Torque) or
//! [`SegmentLoad`](aerobot_components::segment::SegmentLoad) and knows nothing of the formulation.

pub mod body_drag;
pub mod buoyancy;
pub mod lifting_surface;
pub mod line_twist;
pub mod reeled_spring;
pub mod sail;
pub mod segment_drag;
pub mod spring;
pub mod torsion;
pub mod weight;
