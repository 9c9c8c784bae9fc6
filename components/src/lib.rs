//! What things are: balloons, bodies, tethers, segments and the run they take part in, as plain
//! data in SI. Constructors and checks live here, behaviour does not.
//!
//! Frames: the inertial frame has x along the zonal wind (downwind), y horizontal to its left and z
//! up; z is the altitude above the mean radius of Venus (6051.8 km). A body frame has its origin at
//! the body's centre of mass. Quaternions rotate body to inertial, scalar last.

pub mod actuator;
pub mod aerodynamics;
pub mod body;
pub mod control;
pub mod copies;
pub mod derivatives;
pub mod docking;
pub mod environment;
pub mod events;
pub mod fixed_wing;
pub mod gust;
pub mod inertia;
pub mod rotorcraft;
pub mod run;
pub mod sail;
pub mod sampling;
pub mod scene_component;
pub mod segment;
pub mod state;
pub mod tether;
pub mod tether_ring;
pub mod torsion;
pub mod winch;
