//! Stationary random processes: draws, the Ornstein-Uhlenbeck process, marginals and what carries a
//! normal process to them, and how far the averages of a record may be from what they estimate.

pub mod complex_ornstein_uhlenbeck;
pub mod hermite_series;
pub mod linear_prediction;
pub mod marginal;
pub mod normal_distribution;
pub mod normal_draws;
pub mod sampling_error;
