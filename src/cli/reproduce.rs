//! `aerobot reproduce`.

use std::fs;
use std::num::NonZero;
use std::path::Path;
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::run_folder::RunError;
use aerobot_engine::scene::source::nearest;

use super::progress::PartBar;
use super::report::{REPORT_FILE, write_page};
use super::{REFUSED, ReproduceArguments, STOPPED, complain, say};
use crate::reproduce::page::page;
use crate::reproduce::{Case, Finished, Report, ReproduceError, Settings, cases, run_cases};

pub(super) fn reproduce(simulator: &Simulator, arguments: &ReproduceArguments) -> ExitCode {
    if arguments.list {
        for case in cases() {
            say(format_args!("{:<12} {}", case.name(), case.about()));
        }
        return ExitCode::SUCCESS;
    }
    let chosen = match choose(arguments.case.as_deref()) {
        Ok(chosen) => chosen,
        Err(message) => {
            complain(message);
            return ExitCode::from(REFUSED);
        }
    };
    let folder = arguments
        .out
        .clone()
        .unwrap_or_else(|| Path::new("runs").join("reproduce"));
    let is_new = !folder.exists();
    if let Err(error) = open(&folder, arguments.force) {
        complain(error);
        return ExitCode::from(REFUSED);
    }
    let settings = Settings {
        nodes: arguments.nodes,
        duration_s: arguments.until,
    };
    let mut told = Told {
        folder: &folder,
        quiet: arguments.quiet,
        written: false,
        worst: ExitCode::SUCCESS,
        finished: Vec::new(),
    };
    match run(simulator, &chosen, &settings, &mut told) {
        Ok(()) => match told.write_page() {
            Ok(()) => told.worst,
            Err(message) => {
                complain(message);
                ExitCode::from(STOPPED)
            }
        },
        Err(Refusal(message)) => {
            complain(message);
            if is_new && !told.written {
                // Refused means that nothing was written.
                let _ = fs::remove_dir(&folder);
            }
            ExitCode::from(REFUSED)
        }
    }
}

/// The case of a name, or all.
fn choose(name: Option<&str>) -> Result<Vec<Box<dyn Case>>, String> {
    let Some(name) = name else {
        return Ok(cases());
    };
    let mut all = cases();
    if let Some(place) = all.iter().position(|case| case.name() == name) {
        return Ok(vec![all.swap_remove(place)]);
    }
    let help = nearest(name, all.iter().map(|case| case.name())).map_or_else(
        || "`aerobot reproduce --list` shows them".to_owned(),
        |near| format!("did you mean `{near}`?"),
    );
    Err(format!(
        "error: there is no case `{name}`\n  = help: {help}"
    ))
}

/// Makes sure before anything is computed that there is a folder to write into.
fn open(folder: &Path, force: bool) -> Result<(), RunError> {
    if folder.exists() && !force {
        return Err(RunError::Exists(folder.to_owned()));
    }
    fs::create_dir_all(folder).map_err(|error| RunError::Io(folder.to_owned(), error))
}

/// Why there is no answer.
struct Refusal(String);

impl From<ReproduceError> for Refusal {
    fn from(error: ReproduceError) -> Self {
        Self(error.to_string())
    }
}

/// Computes cases on all cores, prints their texts and writes their tables in the order of the paper.
fn run(
    simulator: &Simulator,
    chosen: &[Box<dyn Case>],
    settings: &Settings,
    told: &mut Told,
) -> Result<(), Refusal> {
    let bar = PartBar::new(told.quiet);
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
    let result = run_cases(
        chosen,
        simulator,
        settings,
        threads,
        &|what, part| bar.show(what, part),
        &mut |finished| bar.above(|| told.take(finished)),
    );
    bar.clear();
    result
}

/// What has been told of the cases that are finished.
struct Told<'a> {
    folder: &'a Path,
    quiet: bool,
    /// Whether there are tables.
    written: bool,
    worst: ExitCode,
    finished: Vec<Finished>,
}

impl Told<'_> {
    /// Writes the page of all cases beside their tables.
    fn write_page(&self) -> Result<(), String> {
        let file = self.folder.join(REPORT_FILE);
        write_page(&file, &page(&self.finished))?;
        if !self.quiet {
            say(format_args!("\nreport in `{}`", file.display()));
        }
        Ok(())
    }

    /// Prints the text of a case and writes its tables; what stopped and what does not hold is complained of.
    fn take(&mut self, finished: Finished) -> Result<(), Refusal> {
        let (name, report) = (finished.name, &finished.report);
        report
            .write(self.folder)
            .map_err(|error| Refusal(RunError::Io(self.folder.to_owned(), error).to_string()))?;
        self.written = true;
        if !self.quiet {
            say(report.text.trim_end());
            say(format_args!("\nverdict: {}", verdict(report)));
            let files: Vec<&str> = report.tables.iter().map(|table| table.file_name).collect();
            say(format_args!(
                "\n{name}: wrote {} into `{}`",
                files.join(", "),
                self.folder.display()
            ));
        }
        for stopped in &report.stopped {
            complain(format_args!("error: {stopped}"));
        }
        let failed = report.checks.iter().filter(|check| check.fails());
        for check in failed.clone() {
            complain(format_args!("error: {name}: does not hold: {check}"));
        }
        if !report.stopped.is_empty() || failed.count() > 0 {
            self.worst = ExitCode::from(STOPPED);
        }
        self.finished.push(finished);
        Ok(())
    }
}

/// The verdict of a case in one line.
fn verdict(report: &Report) -> String {
    let independent = report
        .checks
        .iter()
        .filter(|check| check.independent.is_some());
    let (all, failed) = (
        independent.clone().count(),
        independent.filter(|check| check.fails()).count(),
    );
    let sentence = &report.verdict.sentence;
    match (all, failed) {
        (0, _) => sentence.clone(),
        (_, 0) => format!("{all} checks against other answers hold. {sentence}"),
        _ => format!("{failed} of {all} checks against other answers DO NOT HOLD. {sentence}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::{Check, Verdict};

    /// The exit code, and whether the verdict says that something does not hold.
    fn of(checks: Vec<Check>) -> (String, bool) {
        let report = Report {
            verdict: Verdict::of(&checks, "So it is."),
            checks,
            ..Report::default()
        };
        let words = verdict(&report);
        let mut told = Told {
            folder: Path::new("."),
            quiet: true,
            written: false,
            worst: ExitCode::SUCCESS,
            finished: Vec::new(),
        };
        let finished = Finished {
            name: "case",
            report,
            wall_s: 0.0,
        };
        assert!(told.take(finished).is_ok());
        (format!("{:?}", told.worst), words.contains("DO NOT HOLD"))
    }

    /// A difference from the paper is no failure; one from an answer other than the paper's is.
    #[test]
    fn what_contradicts_an_independent_answer_is_a_failure() {
        let number = || Check::of("length", "m", 1.0);
        let [done, stopped] = [ExitCode::SUCCESS, ExitCode::from(STOPPED)];
        let [done, stopped] = [format!("{done:?}"), format!("{stopped:?}")];
        let differs = number().paper(2.0).as_in_paper("the same", false);
        assert_eq!(of(vec![differs]), (done.clone(), false));
        assert_eq!(of(vec![number().at_most(1.0, "by hand")]), (done, false));
        let wrong = number().at_most(0.5, "by hand");
        assert_eq!(of(vec![wrong]), (stopped, true));
    }
}
