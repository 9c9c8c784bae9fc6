//! From forces to accelerations: accumulators, tether points and segments, and the equations of
//! motion of lumped masses and rigid bodies.

pub mod accumulators;
pub mod anchors;
pub mod attachments;
pub mod first_order;
pub mod joint_layout;
pub mod joint_vector;
pub mod link_mechanism;
pub mod links;
pub mod point_mass;
pub mod rigid_body;
pub mod rotation_chart;
pub mod segments;
pub mod state_space;
pub mod state_vector;
pub mod tree_components;
pub mod winch;
