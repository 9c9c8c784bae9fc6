//! The second formulation: trees of rigid bodies and rigid links in joint coordinates, solved recursively
//! in linear time by the decoupled natural orthogonal complement (DeNOC).
//!
//! A link i is joined at its proximal end P to what carries it, at its distal end Q to what it carries.
//! With t_i its twist (velocity of P and angular velocity), u_i its joint rate, p the link before it
//! (the rate of a spherical joint is the angular velocity of what turns in it: B passes on velocities of
//! joints alone):
//!
//! ```text
//! t_i = B_(i,p) t_p + N_i u_i            t = N_l N_d u
//! N' (M t' + M' t) = N' w                H u' + C u = tau,    H = N' M N
//! ```
//!
//! N_l, lower block triangular of the B, and N_d, block diagonal of the N_i, are the two factors of the
//! natural orthogonal complement of the joints' constraints (Saha 1997, ASME J. Appl. Mech. 64, 986;
//! Saha 1999, IEEE Trans. Robot. Autom. 15, 309; paper, sec. 3.2). Neither they nor H are ever formed: with
//! the articulated inertia A_i of a link and all that it carries, H = U D U' block by block,
//!
//! ```text
//! D_i = N_i' A_i N_i,   passed on to p:   B' (A_i - A_i N_i D_i^-1 N_i' A_i) B
//! ```
//!
//! and one sweep inward and one outward solve for u'. After a spherical joint a torque-free end is left:
//! what is passed on acts on the acceleration of the joint alone, a symmetric 3x3 block. Only that block
//! exists here ([`articulated_link`], [`articulated_body`]); the rotational blocks are zero and are never
//! computed: left as differences, their round-off can grow from link to link.
//!
//! The same recursion with other blocks solves the linear systems of an implicit step
//! ([`stage_system`]). Joint coordinates have no singularities ([`joint_coordinates`]).
//!
//! Links are thin and do not twist: uniform rods, or massless with point masses at the joints; with an
//! elastic link the joint also lets the link stretch, and the tether's Kelvin-Voigt law acts along it.
//! A uniform rod between points moving with v_P and v_Q has the kinetic energy
//! m/6 (v_P^2 + v_P.v_Q + v_Q^2): half of its mass at each end, less m/6 between them. So forces, weights
//! and masses at the ends are those of the lumped formulation, and one number a link is added.

pub mod articulated_body;
pub mod articulated_link;
pub mod closed_dynamics;
pub mod forward_dynamics;
pub mod impulse;
pub mod inverse_dynamics;
pub mod joint_coordinates;
pub mod kinematics;
pub mod loops;
pub mod reduced_tree;
pub mod self_stress;
pub mod stage_system;
pub mod tree;
