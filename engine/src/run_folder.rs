//! A run into a folder: the scene as run, the rows as they come, the summary and the timing.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};
use serde::Serialize;

use crate::plugin::Simulator;
use crate::recording::frame::{Frame, NullSink, ResultSink};
use crate::recording::summary::{Summary, Timing};
use crate::recording::table_format::{TableFormat, TableSink};
use crate::scene::source::{apply, parse_override};
use crate::scene::{Scene, SceneError};
use crate::simulation::Simulation;

/// The files that a run writes, in one format or the other, besides the tables of its scene, and its report.
const FILES: [&str; 10] = [
    "scene.ron",
    "states.csv",
    "tethers.csv",
    "channels.csv",
    "states.parquet",
    "tethers.parquet",
    "channels.parquet",
    "summary.json",
    "timing.json",
    "report.html",
];

/// Where a run goes.
#[derive(Clone, Debug)]
pub struct Destination {
    /// The folder.
    pub folder: PathBuf,
    /// Whether a folder that exists is written into.
    pub overwrite: bool,
}

/// Why nothing was run.
#[derive(Debug)]
pub enum RunError {
    /// The scene is refused.
    Scene(SceneError),
    /// The folder exists.
    Exists(PathBuf),
    /// The file system refused something before the run.
    Io(PathBuf, io::Error),
}

impl fmt::Display for RunError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(formatter),
            Self::Exists(folder) => write!(
                formatter,
                "error: the output folder `{}` exists\n  = help: name another with `--out`, or \
                 overwrite its results with `--force`",
                folder.display()
            ),
            Self::Io(path, error) => {
                write!(
                    formatter,
                    "error: cannot write `{}`: {error}",
                    path.display()
                )
            }
        }
    }
}

impl std::error::Error for RunError {}

/// What a run into a folder gives back.
#[derive(Clone, Debug)]
pub struct FinishedRun {
    /// The summary, as in `summary.json`.
    pub summary: Summary,
    /// The timing, as in `timing.json`.
    pub timing: Timing,
}

impl Destination {
    /// Makes sure that nothing is written over that was not to be.
    ///
    /// # Errors
    /// The folder exists, and is not to be written into.
    pub fn check(&self) -> Result<(), RunError> {
        if self.folder.exists() && !self.overwrite {
            return Err(RunError::Exists(self.folder.clone()));
        }
        Ok(())
    }
}

/// Runs a scene into a folder; `progress` hears of every accepted step's time in s.
///
/// # Errors
/// Why nothing was run; then nothing was written. A run that stops before its end is not an error
/// here: its summary says so, and what was recorded is kept.
pub fn run_into(
    simulator: &Simulator,
    scene: &Scene,
    destination: &Destination,
    progress: &mut dyn FnMut(f64),
) -> Result<FinishedRun, RunError> {
    run_into_as(simulator, scene, destination, TableFormat::Csv, progress)
}

/// As [`run_into`], with tables in this format.
///
/// # Errors
/// As [`run_into`].
pub fn run_into_as(
    simulator: &Simulator,
    scene: &Scene,
    destination: &Destination,
    format: TableFormat,
    progress: &mut dyn FnMut(f64),
) -> Result<FinishedRun, RunError> {
    destination.check()?;
    let simulation = simulator.build(scene).map_err(RunError::Scene)?;
    let prepared = PreparedRun::in_format(simulation, scene, destination, format)?;
    Ok(prepared.run(&mut NullSink, progress))
}

/// A simulation whose folder is there: the scene as run stands in it, and the tables are open.
///
/// For programs that prepare several runs before they begin the first; others call [`run_into`].
pub struct PreparedRun {
    simulation: Simulation,
    sink: TableSink,
    folder: PathBuf,
}

impl PreparedRun {
    /// Prepares the folder for a simulation that was built from `scene`, with tables as CSV.
    ///
    /// # Errors
    /// What the file system refused, or that the folder exists; then nothing was written.
    pub fn new(
        simulation: Simulation,
        scene: &Scene,
        destination: &Destination,
    ) -> Result<Self, RunError> {
        Self::in_format(simulation, scene, destination, TableFormat::Csv)
    }

    /// As [`PreparedRun::new`], with tables in this format.
    ///
    /// # Errors
    /// As [`PreparedRun::new`].
    pub fn in_format(
        simulation: Simulation,
        scene: &Scene,
        destination: &Destination,
        format: TableFormat,
    ) -> Result<Self, RunError> {
        destination.check()?;
        let folder = &destination.folder;
        let as_run = scene_as_run(scene).map_err(RunError::Scene)?;
        let is_new = !folder.exists();
        let prepared = prepare_folder(folder, &as_run).and_then(|()| {
            TableSink::create(folder, format).map_err(|error| RunError::Io(folder.clone(), error))
        });
        match prepared {
            Ok(sink) => Ok(Self {
                simulation,
                sink,
                folder: folder.clone(),
            }),
            Err(error) => {
                // Refused means that nothing was written.
                if is_new {
                    let _ = fs::remove_dir_all(folder);
                }
                Err(error)
            }
        }
    }

    /// Runs it. `observer` takes every frame after it has been written; `progress` hears of every
    /// accepted step's time in s.
    pub fn run(
        mut self,
        observer: &mut dyn ResultSink,
        progress: &mut dyn FnMut(f64),
    ) -> FinishedRun {
        let (wall, cpu) = (Instant::now(), thread_cpu_time());
        let mut sink = ObservedSink {
            sink: &mut self.sink,
            observer,
        };
        let mut summary = self.simulation.run(&mut sink, progress);
        let flushed = self.sink.finish();
        if let (Err(error), None) = (&flushed, &summary.stopped) {
            summary.stop(format!("the results cannot be written: {error}"));
        }
        let cpu_s = (thread_cpu_time() - cpu).as_secs_f64();
        let timing = Timing {
            wall_s: wall.elapsed().as_secs_f64(),
            cpu_s,
            simulated_s_per_cpu_s: if cpu_s > 0.0 {
                summary.simulated_s / cpu_s
            } else {
                0.0
            },
        };
        let written = write_json(&self.folder.join("summary.json"), &summary)
            .and_then(|()| write_json(&self.folder.join("timing.json"), &timing));
        if let (Err(error), None) = (&written, &summary.stopped) {
            summary.stop(format!("the summary cannot be written: {error}"));
        }
        FinishedRun { summary, timing }
    }
}

/// Writes frames, and shows them to an observer.
struct ObservedSink<'a> {
    sink: &'a mut TableSink,
    observer: &'a mut dyn ResultSink,
}

impl ResultSink for ObservedSink<'_> {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        self.sink.take(frame)?;
        self.observer.take(frame)
    }
}

/// CPU time of the calling thread.
#[must_use]
pub fn thread_cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(
        time.tv_sec.unsigned_abs(),
        u32::try_from(time.tv_nsec).unwrap_or(0),
    )
}

/// The text of a scene as it is run, and the tables that stand beside it.
pub(crate) struct SceneAsRun {
    /// The scene, with the names of its tables as they stand beside it.
    pub(crate) text: String,
    /// Names and contents of its tables.
    pub(crate) tables: Vec<(String, String)>,
}

/// Every override and the seed are in the text, and tables are named as they stand in the folder.
pub(crate) fn scene_as_run(scene: &Scene) -> Result<SceneAsRun, SceneError> {
    let mut arguments = vec![format!("run.seed={}", scene.run.seed)];
    let mut tables: Vec<(String, String)> = Vec::new();
    for (path, file) in scene.tables.paths(&scene.environment) {
        let plain = Path::new(&file).file_name().map_or_else(
            || "table.csv".to_owned(),
            |name| name.to_string_lossy().into_owned(),
        );
        let content = scene.tables.files.get(&file).cloned().unwrap_or_default();
        let taken = |name: &str| {
            FILES.contains(&name)
                || tables
                    .iter()
                    .any(|(other, text)| other == name && *text != content)
        };
        let mut name = plain.clone();
        let mut number = 2;
        while taken(&name) {
            name = format!("{number}-{plain}");
            number += 1;
        }
        arguments.push(format!("{path}={name:?}"));
        tables.push((name, content));
    }
    let overrides = arguments
        .iter()
        .map(|argument| parse_override(argument).map_err(SceneError::plain))
        .collect::<Result<Vec<_>, _>>()?;
    let edited = apply(scene.source.text(), &overrides)
        .map_err(|diagnostic| SceneError::plain(diagnostic.message))?;
    Ok(SceneAsRun {
        text: edited.text().to_owned(),
        tables,
    })
}

fn prepare_folder(folder: &Path, scene: &SceneAsRun) -> Result<(), RunError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |error| RunError::Io(path, error)
    };
    fs::create_dir_all(folder).map_err(at(folder))?;
    for path in FILES.map(|file| folder.join(file)) {
        if path.is_dir() {
            return Err(at(&path)(io::ErrorKind::IsADirectory.into()));
        }
    }
    for file in FILES {
        let path = folder.join(file);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(at(&path)(error)),
            _ => {}
        }
    }
    let path = folder.join("scene.ron");
    fs::write(&path, &scene.text).map_err(at(&path))?;
    for (name, text) in &scene.tables {
        let path = folder.join(name);
        fs::write(&path, text).map_err(at(&path))?;
    }
    Ok(())
}

fn write_json(path: &Path, value: &impl Serialize) -> io::Result<()> {
    let mut text = serde_json::to_string_pretty(value)?;
    text.push('\n');
    // Whole or not at all.
    let part = path.with_extension("json.part");
    fs::write(&part, text)
        .and_then(|()| fs::rename(&part, path))
        .inspect_err(|_| {
            let _ = fs::remove_file(&part);
        })
}
