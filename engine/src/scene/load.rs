//! Reads a scene: text, overrides, typed parts, checks. Every violation is collected before it fails.

use std::ops::Range;
use std::path::Path;

use aerobot_components::environment::{AtmosphereSpec, Environment};
use aerobot_components::events::EventSpec;
use aerobot_components::run::RunSpec;
use aerobot_components::scene_component::{FieldReport, Violation};

use super::checks::{check_scene, check_written};
use super::groups::Groups;
use super::reader::Reader;
use super::source::{
    Diagnostic, FieldPath, Kind, Node, Override, Scalar, Source, duplicates, non_finite,
    parse_override, scan,
};
use super::tables::Tables;
use super::{Scene, SceneError};
use crate::plugin::Simulator;

impl Simulator {
    /// Reads the scene in `file`, with overrides of the form `PATH=RON` applied to it in order.
    ///
    /// # Errors
    /// Everything that is wrong with it, rendered.
    pub fn load(&self, file: &Path, overrides: &[String]) -> Result<Scene, SceneError> {
        let text = std::fs::read_to_string(file).map_err(|error| {
            SceneError::plain(format_args!("cannot read `{}`: {error}", file.display()))
        })?;
        let folder = file.parent().unwrap_or_else(|| Path::new("."));
        self.load_text(&file.display().to_string(), text, folder, overrides)
    }

    /// Reads a scene from text; `file_name` stands in messages, tables are looked for in `folder`.
    ///
    /// # Errors
    /// Everything that is wrong with it, rendered.
    pub fn load_text(
        &self,
        file_name: &str,
        text: String,
        folder: &Path,
        overrides: &[String],
    ) -> Result<Scene, SceneError> {
        let mut parsed: Vec<Override> = Vec::new();
        for argument in overrides {
            parsed.push(parse_override(argument).map_err(SceneError::plain)?);
        }
        // A scene that does not scan is shown as it is, before any override is blamed.
        let plain = Source::new(file_name, text);
        let root =
            read_tree(&plain).map_err(|diagnostic| SceneError::render(&plain, &[diagnostic]))?;
        // The last one given is the one that counts.
        let path: FieldPath = INTEGRATOR.parse().map_err(SceneError::plain)?;
        let given = parsed.iter().rev().find(|change| change.path == path);
        let word = match given {
            Some(change) => Some(change.value_text.clone()),
            None => bare_word(&plain, &root, &path),
        };
        if let Some(word) = word.filter(|word| INTEGRATORS.contains(&word.as_str())) {
            let whole = parse_override(&format!("{INTEGRATOR}={word}()"));
            parsed.push(whole.map_err(SceneError::plain)?);
        }
        let source = match plain.with_overrides(&parsed) {
            Ok(source) => source,
            Err(diagnostic) => return Err(SceneError::render(&plain, &[diagnostic])),
        };
        let root =
            read_tree(&source).map_err(|diagnostic| SceneError::render(&source, &[diagnostic]))?;
        self.resolve(source, &root, folder)
    }

    fn resolve(&self, source: Source, root: &Node, folder: &Path) -> Result<Scene, SceneError> {
        let mut reader = Reader {
            text: source.text(),
            diagnostics: Vec::new(),
        };
        let fields = reader.root_fields(root);
        let name: Option<String> = reader.required(&fields, root, "name");
        let about: Option<String> = reader.optional(&fields, "about", String::new);
        let environment: Option<Environment> =
            reader.optional(&fields, "environment", Environment::default);
        let events: Option<Vec<EventSpec>> = reader.optional(&fields, "events", Vec::new);
        let run: Option<RunSpec> = reader.required(&fields, root, "run");
        let written = reader.entities(self, &fields, root);
        let mut diagnostics = reader.diagnostics;
        let in_text = text_diagnostics(&source, root);

        let mut report = FieldReport::new("");
        if let Some(name) = &name {
            check_name(name, &mut report);
        }
        if let Some(run) = &run {
            report.within("run", |report| run.check(report));
        }
        for (index, event) in events.iter().flatten().enumerate() {
            report.within(&format!("events.{index}"), |report| event.check(report));
        }
        let mut tables = Tables::default();
        if let Some(environment) = &environment {
            report.within("environment", |report| environment.check(report));
            tables = Tables::read(environment, folder, &mut report);
        }
        let complete = diagnostics.is_empty() && in_text.is_empty();
        check_written(self, &written, complete, &mut report);
        let mut groups = Groups::default();
        let mut entities = Vec::new();
        for written in written {
            entities.extend(written.into_copies(&mut groups));
        }
        let entities = groups.expand(&self.expansions, entities);
        let mut run = run.unwrap_or_else(placeholder_run);
        groups.expand_record(&mut run.record);
        let scene = Scene {
            name: name.unwrap_or_default(),
            about: about.unwrap_or_default(),
            environment: environment.unwrap_or_else(placeholder_environment),
            entities,
            groups,
            events: events.unwrap_or_default(),
            run,
            tables,
            source,
        };
        check_scene(self, &scene, &mut report);
        let violations = scene.groups.relocate(report.into_violations());
        diagnostics.extend(locate(&scene.source, violations));
        diagnostics.retain(|diagnostic| !echoes(diagnostic, &in_text));
        diagnostics.extend(in_text);
        if diagnostics.is_empty() {
            Ok(scene)
        } else {
            Err(SceneError::render(&scene.source, &diagnostics))
        }
    }
}

/// Where a scene names its integrator.
const INTEGRATOR: &str = "run.integrator";
/// Integrators of which every value has a default: `Auto` alone is `Auto()`.
const INTEGRATORS: [&str; 4] = ["Auto", "Implicit", "Adaptive", "Fixed"];

/// The integrator of a scene, if it is given as a word alone.
fn bare_word(source: &Source, root: &Node, path: &FieldPath) -> Option<String> {
    let node = root.get(path)?;
    (node.kind == Kind::Scalar(Scalar::Word))
        .then(|| source.text().get(node.span.clone()).map(str::to_owned))?
}

/// Stands in for a `run` that could not be read, so that the rest can still be checked.
fn placeholder_run() -> RunSpec {
    RunSpec {
        formulation: Default::default(),
        links: Default::default(),
        elastic_links: false,
        base: None,
        duration_s: 1.0,
        output_every_s: 1.0,
        integrator: Default::default(),
        seed: 0,
        record: Default::default(),
    }
}

/// Stands in for an `environment` that could not be read: nothing is outside of it.
fn placeholder_environment() -> Environment {
    Environment {
        atmosphere: AtmosphereSpec::Vacuum,
        ..Environment::default()
    }
}

/// Whether a diagnostic is of a value in which the text itself is at fault, which is said already.
pub(crate) fn echoes(diagnostic: &Diagnostic, in_text: &[Diagnostic]) -> bool {
    let Some(span) = &diagnostic.span else {
        return false;
    };
    in_text
        .iter()
        .filter_map(|fault| fault.span.as_ref())
        .any(|fault| span.start <= fault.start && fault.end <= span.end)
}

fn check_name(name: &str, report: &mut FieldReport) {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(plain) {
        report.add(
            "name",
            format!("`{name}` cannot name a scene"),
            "the name also names the output folder: use letters, digits, `-`, `_` and `.`",
        );
    }
}

pub(crate) fn read_tree(source: &Source) -> Result<Node, Diagnostic> {
    scan(source.text()).map_err(|error| Diagnostic::new(error.message).at(error.span))
}

/// What is wrong with the text whatever its fields mean: duplicates and numbers that are not finite.
pub(crate) fn text_diagnostics(source: &Source, root: &Node) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for duplicate in duplicates(root) {
        let line = source
            .line_column(duplicate.first.start)
            .map_or(0, |(line, _)| line);
        found.push(
            Diagnostic::new(format!("`{}` is given twice", duplicate.name))
                .at(duplicate.second)
                .with_path(duplicate.path.to_string())
                .with_help(format!(
                    "it stands first in line {line}; keep one of the two"
                )),
        );
    }
    for span in non_finite(root, source.text()) {
        let value = &source.text()[span.clone()];
        let path = root.innermost(span.start).map(|(_, path)| path);
        found.push(
            Diagnostic::new(format!("`{value}` is not a finite number"))
                .at(span)
                .with_path(path.unwrap_or_default().to_string())
                .with_help("every quantity of a scene is a finite number"),
        );
    }
    found
}

/// Gives violations their place in the text: the field itself, or the nearest thing around it.
pub(crate) fn locate(source: &Source, violations: Vec<Violation>) -> Vec<Diagnostic> {
    let root = scan(source.text()).ok();
    violations
        .into_iter()
        .map(|violation| {
            let mut diagnostic =
                Diagnostic::new(violation.message).with_path(violation.path.clone());
            if let Some(help) = violation.help {
                diagnostic = diagnostic.with_help(help);
            }
            let path = violation.path.parse::<FieldPath>();
            if let (Some(root), Ok(path)) = (&root, path) {
                diagnostic = diagnostic.at(place(root, &path));
            }
            diagnostic
        })
        .collect()
}

/// Where a value is shown: itself, or what names it if it has many lines.
fn place(root: &Node, path: &FieldPath) -> Range<usize> {
    let (node, reached) = root.reach(path);
    match &node.kind {
        Kind::Struct { .. } | Kind::Map { .. } => node
            .name()
            .or_else(|| root.name_span(&path.head(reached)))
            .unwrap_or_else(|| node.opening()),
        _ if reached == path.segments.len() => node.span.clone(),
        _ => node.opening(),
    }
}
