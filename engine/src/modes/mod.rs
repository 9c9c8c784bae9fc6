//! Small motions about the steady state of a scene: frequencies, damping, and who moves how.

mod body_coordinates;
mod closed_loop;
mod displaced_forces;
mod joint_coordinates;
mod linear_motion;
mod linear_springs;
mod naming;
mod neutral;
mod participation;
mod search;
mod sites;

pub use closed_loop::ClosedLoop;

use crate::scene::{Scene, SceneError};
use crate::simulation::Simulation;
use crate::trim::Trim;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModesRequest {
    /// How many modes, the slowest first.
    pub count: usize,
    /// How they are found.
    pub solver: ModeSolver,
}

impl Default for ModesRequest {
    fn default() -> Self {
        Self {
            count: 12,
            solver: ModeSolver::Automatic,
        }
    }
}

/// How modes are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModeSolver {
    /// `Complete` for few coordinates, `Slowest` for many.
    #[default]
    Automatic,
    /// Full matrices, all eigenvalues; a force may depend on the place of anything.
    Complete,
    /// Matrices of blocks between neighbours on tethers (full ones for rigid links), and the slowest
    /// eigenvalues alone. A force that couples what no tether joins is not seen, and first-order states
    /// of components are held; rigid links have neither limitation.
    Slowest,
}

/// The slowest modes of a scene about its steady state.
#[derive(Clone, Debug, PartialEq)]
pub struct Modes {
    /// The steady state.
    pub trim: Trim,
    /// Number of coordinates.
    pub coordinates: usize,
    /// Number of first-order states of components that take part.
    pub first_order_states: usize,
    /// The modes, slowest first.
    pub modes: Vec<Mode>,
    /// What nothing restores, in words; no modes stand for it.
    pub neutral: Vec<String>,
    /// The loops that controllers close.
    pub closed_loops: Vec<ClosedLoop>,
    /// What was decided on the way, as sentences.
    pub notes: Vec<String>,
}

/// A motion `e^(lambda t)` about the steady state.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// What it is, in words.
    pub name: String,
    /// Real part of lambda, 1/s: negative if it dies out.
    pub growth_per_s: f64,
    /// Imaginary part of lambda, rad/s; zero if it does not oscillate.
    pub angular_frequency_rad_s: f64,
    /// Shares of the kinetic energy, largest first; they add up to one.
    pub shares: Vec<Share>,
}

/// The part that a motion of an entity has in the kinetic energy of a mode, averaged over a cycle, added
/// mass included.
#[derive(Clone, Debug, PartialEq)]
pub struct Share {
    /// Name of the body or tether.
    pub entity: String,
    /// How it moves.
    pub motion: Motion,
    /// Its part of the whole.
    pub part: f64,
}

/// How something moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// A body along x, inertial frame.
    X,
    /// A body along y.
    Y,
    /// A body along z: heave.
    Z,
    /// A body about its own x axis.
    Roll,
    /// A body about its own y axis.
    Pitch,
    /// A body about its own z axis.
    Yaw,
    /// Points of a tether across it.
    Transverse,
    /// Points of a tether along it.
    Axial,
}

impl Motion {
    /// One word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Roll => "roll",
            Self::Pitch => "pitch",
            Self::Yaw => "yaw",
            Self::Transverse => "transverse",
            Self::Axial => "axial",
        }
    }
}

impl Mode {
    /// |lambda|, 1/s.
    #[must_use]
    pub fn rate_per_s(&self) -> f64 {
        let (growth, turn) = (self.growth_per_s, self.angular_frequency_rad_s);
        (growth * growth + turn * turn).sqrt()
    }

    /// Whether it oscillates.
    #[must_use]
    pub fn oscillates(&self) -> bool {
        self.angular_frequency_rad_s > 0.0
    }

    /// Frequency of its oscillation, damping as it is, Hz; zero if it does not oscillate.
    #[must_use]
    pub fn frequency_hz(&self) -> f64 {
        self.angular_frequency_rad_s / std::f64::consts::TAU
    }

    /// Period of its oscillation, s; none if it does not oscillate.
    #[must_use]
    pub fn period_s(&self) -> Option<f64> {
        self.oscillates().then(|| 1.0 / self.frequency_hz())
    }

    /// Damping over critical damping, `-Re lambda / |lambda|`; negative if it grows.
    #[must_use]
    pub fn damping_ratio(&self) -> f64 {
        let rate = self.rate_per_s();
        if rate > 0.0 {
            -self.growth_per_s / rate
        } else {
            0.0
        }
    }

    /// Time over which its amplitude changes by a factor e, s; infinite if it keeps it.
    #[must_use]
    pub fn time_constant_s(&self) -> f64 {
        1.0 / self.growth_per_s.abs()
    }

    /// Whether it grows, by more than round-off.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        self.growth_per_s > SMALLEST_GROWTH * self.rate_per_s()
    }

    /// The share of one motion of one entity.
    #[must_use]
    pub fn share(&self, entity: &str, motion: Motion) -> f64 {
        let of = self.shares.iter();
        of.filter(|share| share.entity == entity && share.motion == motion)
            .map(|share| share.part)
            .sum()
    }
}

/// Growth over |lambda| that differences leave where nothing damps.
const SMALLEST_GROWTH: f64 = 1e-7;

impl Simulation {
    /// Brings the simulation to its steady state, as [`Simulation::trim`] does, and finds the slowest
    /// motions about it, forces linearised, in the formulation of the scene.
    ///
    /// What is taut stays taut, what is slack carries nothing; commands and gusts that are sampled keep
    /// their values.
    ///
    /// # Errors
    /// As [`Simulation::trim`]; or why motions about the steady state cannot be found.
    pub fn modes(&mut self, scene: &Scene, request: &ModesRequest) -> Result<Modes, SceneError> {
        let trim = self.trim(scene)?;
        search::search(&mut self.world, scene, trim, request).map_err(|error| scene.refuse(error))
    }
}
