//! One scene run in two ways, by default in both formulations: where its bodies go, how its tethers
//! pull, and what either costs.
//!
//! Each is a run like any other with a folder of its own. What is compared is kept while the runs are
//! written; nothing is read back.
//!
//! ```no_run
//! use std::path::Path;
//! use aerobot::comparison::{FORMULATIONS, Pair};
//! use aerobot::engine::plugin::Simulator;
//! use aerobot::engine::run_folder::Destination;
//!
//! let simulator = Simulator::new();
//! let scene = Path::new("scenes/paper/comparison_900m.ron");
//! let pair = Pair::load(&simulator, scene, &[], FORMULATIONS)?;
//! let destination = Destination { folder: "runs/comparison".into(), overwrite: false };
//! let comparison = pair.run_into(&destination, &mut |_name, _part| {})?;
//! for body in &comparison.bodies {
//!     println!("{}: {} m apart", body.name, body.largest_distance_m.value);
//! }
//! # Ok::<(), aerobot::comparison::CompareError>(())
//! ```

pub mod difference;
mod refusal;
pub mod tables;
pub mod tracks;

use std::fs;
use std::path::Path;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::summary::{Summary, Timing};
use aerobot_engine::run_folder::{Destination, PreparedRun, RunError};
use aerobot_engine::scene::{Scene, SceneError};
use aerobot_engine::simulation::Simulation;

use difference::{BodyDifference, TetherDifference, body_differences, tether_differences};
pub use refusal::CompareError;
use refusal::{both, check_overrides};
use tracks::Tracks;

/// A way to run a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Variant {
    /// Its name: of its folder, and in tables.
    pub name: &'static str,
    /// The field of the scene that makes the difference, as `PATH=RON`.
    pub change: &'static str,
}

/// The two formulations; a difference is the second less the first.
pub const FORMULATIONS: [Variant; 2] = [
    Variant {
        name: "lumped-mass",
        change: "run.formulation=LumpedMass",
    },
    Variant {
        name: "denoc",
        change: "run.formulation=Denoc",
    },
];

/// One scene, built in two ways.
pub struct Pair {
    runs: [Built; 2],
}

/// A scene in one of the ways.
struct Built {
    variant: Variant,
    scene: Scene,
    simulation: Simulation,
}

/// Two runs of one scene, side by side. Differences are the second less the first, at the times that
/// both have recorded.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Name of the scene.
    pub scene: String,
    /// The two runs.
    pub runs: [ComparedRun; 2],
    /// How far apart each body is that is free to move.
    pub bodies: Vec<BodyDifference>,
    /// How differently each tether pulls.
    pub tethers: Vec<TetherDifference>,
    /// What could not be compared and why, as sentences.
    pub missing: Vec<String>,
    /// Why the tables could not be written, if so.
    pub not_written: Option<String>,
}

/// One of the two runs.
#[derive(Clone, Debug)]
pub struct ComparedRun {
    /// Name of the variant.
    pub name: &'static str,
    /// Its summary, as in `summary.json` of its folder.
    pub summary: Summary,
    /// Its timing, as in `timing.json` of its folder.
    pub timing: Timing,
}

impl Comparison {
    /// The last time at which something was compared, s.
    #[must_use]
    pub fn compared_until_s(&self) -> Option<f64> {
        let bodies = self.bodies.iter().map(|body| body.last.0);
        let tethers = self
            .tethers
            .iter()
            .map(|tether| tether.final_difference_n.time_s);
        bodies.chain(tethers).reduce(f64::max)
    }

    /// Whether both runs came to their end and everything was written.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        let done = |run: &ComparedRun| run.summary.stopped.is_none();
        self.runs.iter().all(done) && self.not_written.is_none()
    }
}

impl Pair {
    /// Reads and builds the scene in `file` in two ways, with overrides of the form `PATH=RON` for both.
    ///
    /// # Errors
    /// The scene is refused in one of the ways or in both, or an override sets what they differ in.
    pub fn load(
        simulator: &Simulator,
        file: &Path,
        overrides: &[String],
        variants: [Variant; 2],
    ) -> Result<Self, CompareError> {
        check_overrides(overrides, &variants)?;
        let built = variants.map(|variant| Built::load(simulator, file, overrides, variant));
        Ok(Self {
            runs: both(built, &variants)?,
        })
    }

    /// Name of the scene.
    #[must_use]
    pub fn scene_name(&self) -> &str {
        let [first, _] = &self.runs;
        &first.scene.name
    }

    /// Runs both into folders of their names below `destination`, and writes the tables of their
    /// differences beside them. `progress` hears which is under way and what part of the whole is done.
    ///
    /// # Errors
    /// Why nothing was run; then nothing was written.
    pub fn run_into(
        self,
        destination: &Destination,
        progress: &mut dyn FnMut(&str, f64),
    ) -> Result<Comparison, CompareError> {
        destination.check()?;
        let folder = &destination.folder;
        let is_new = !folder.exists();
        let [first, second] = self.runs;
        let scene = first.scene.name.clone();
        let recorded = first.scene.run.record.clone();
        let prepared = tables::remove(folder)
            .and_then(|()| Ok([first.prepare(folder)?, second.prepare(folder)?]))
            .inspect_err(|_| {
                if is_new {
                    // Refused means that nothing was written.
                    let _ = fs::remove_dir_all(folder);
                }
            })?;
        let mut begun = 0.0;
        let runs = prepared.map(|run| {
            let finished = run.run(&mut |name, part| progress(name, 0.5 * (begun + part)));
            begun += 1.0;
            finished
        });
        let [(first, first_tracks), (second, second_tracks)] = runs;
        let tracks = [&first_tracks, &second_tracks];
        let (bodies, mut missing) = body_differences(tracks, &recorded);
        let (tethers, missing_tethers) = tether_differences(tracks, &recorded);
        missing.extend(missing_tethers);
        let mut comparison = Comparison {
            scene,
            runs: [first, second],
            bodies,
            tethers,
            missing,
            not_written: None,
        };
        let written = tables::write(&comparison, folder);
        comparison.not_written = written.err().map(|error| error.to_string());
        Ok(comparison)
    }
}

impl Built {
    fn load(
        simulator: &Simulator,
        file: &Path,
        overrides: &[String],
        variant: Variant,
    ) -> Result<Self, SceneError> {
        let mut overrides = overrides.to_vec();
        overrides.push(variant.change.to_owned());
        let scene = simulator.load(file, &overrides)?;
        let simulation = simulator.build(&scene)?;
        Ok(Self {
            variant,
            scene,
            simulation,
        })
    }

    fn prepare(self, folder: &Path) -> Result<Prepared, RunError> {
        let destination = Destination {
            folder: folder.join(self.variant.name),
            overwrite: true,
        };
        Ok(Prepared {
            name: self.variant.name,
            duration_s: self.scene.run.duration_s,
            tracks: Tracks::of(self.simulation.world()),
            run: PreparedRun::new(self.simulation, &self.scene, &destination)?,
        })
    }
}

/// A run whose folder is there.
struct Prepared {
    name: &'static str,
    duration_s: f64,
    tracks: Tracks,
    run: PreparedRun,
}

impl Prepared {
    fn run(mut self, progress: &mut dyn FnMut(&str, f64)) -> (ComparedRun, Tracks) {
        let (name, duration_s) = (self.name, self.duration_s);
        let finished = self.run.run(&mut self.tracks, &mut |time_s| {
            progress(name, time_s / duration_s);
        });
        let run = ComparedRun {
            name,
            summary: finished.summary,
            timing: finished.timing,
        };
        (run, self.tracks)
    }
}
