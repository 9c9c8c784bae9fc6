//! Campaigns: many runs of one scene with inputs that vary, and what they have in common.

pub mod comma_separated;
pub mod distributions;
pub mod latin_hypercube;
pub mod normal;
pub mod ordered;
pub mod random_stream;
pub mod sobol;
pub mod statistics;
