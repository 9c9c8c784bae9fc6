//! Rotorcraft: what rotors give and take in a given air, the forces on the body, and the flight computer.

pub mod flight_computer;
pub mod momentum_theory;
pub mod rotor_forces;
