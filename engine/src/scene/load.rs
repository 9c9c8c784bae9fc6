//! Reads a scene: text, overrides, typed parts, checks. Every violation is collected before it fails.

use std::ops::Range;
use std::path::Path;

use aerobot_components::environment::{AtmosphereSpec, Environment};
use aerobot_components::run::RunSpec;
use aerobot_components::scene_component::{FieldReport, Violation};
use serde::de::DeserializeOwned;

use super::checks::check_scene;
use super::source::FieldPath;
use super::source::nearest;
use super::source::non_finite;
use super::source::parse_fields;
use super::source::scan;
use super::source::{Diagnostic, Source};
use super::source::{Field, Kind, Node, duplicates};
use super::source::{Override, parse_override};
use super::tables::Tables;
use super::{Scene, SceneEntity, SceneError};
use crate::plugin::Simulator;

const ROOT_FIELDS: [&str; 5] = ["name", "about", "environment", "entities", "run"];

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
        read_tree(&plain).map_err(|diagnostic| SceneError::render(&plain, &[diagnostic]))?;
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
        let run: Option<RunSpec> = reader.required(&fields, root, "run");
        let entities = reader.entities(self, &fields, root);
        let mut diagnostics = reader.diagnostics;
        let in_text = text_diagnostics(&source, root);

        let mut report = FieldReport::new("");
        if let Some(name) = &name {
            check_name(name, &mut report);
        }
        if let Some(run) = &run {
            report.within("run", |report| run.check(report));
        }
        let mut tables = Tables::default();
        if let Some(environment) = &environment {
            report.within("environment", |report| environment.check(report));
            tables = Tables::read(environment, folder, &mut report);
        }
        let complete = diagnostics.is_empty() && in_text.is_empty();
        let scene = Scene {
            name: name.unwrap_or_default(),
            about: about.unwrap_or_default(),
            environment: environment.unwrap_or_else(placeholder_environment),
            entities,
            run: run.unwrap_or_else(placeholder_run),
            tables,
            source,
        };
        check_scene(self, &scene, complete, &mut report);
        diagnostics.extend(locate(&scene.source, report.into_violations()));
        diagnostics.retain(|diagnostic| !echoes(diagnostic, &in_text));
        diagnostics.extend(in_text);
        if diagnostics.is_empty() {
            Ok(scene)
        } else {
            Err(SceneError::render(&scene.source, &diagnostics))
        }
    }
}

/// Stands in for a `run` that could not be read, so that the rest can still be checked.
fn placeholder_run() -> RunSpec {
    RunSpec {
        formulation: Default::default(),
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
fn echoes(diagnostic: &Diagnostic, in_text: &[Diagnostic]) -> bool {
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

fn read_tree(source: &Source) -> Result<Node, Diagnostic> {
    scan(source.text()).map_err(|error| Diagnostic::new(error.message).at(error.span))
}

/// What is wrong with the text whatever its fields mean: duplicates and numbers that are not finite.
fn text_diagnostics(source: &Source, root: &Node) -> Vec<Diagnostic> {
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
pub(super) fn locate(source: &Source, violations: Vec<Violation>) -> Vec<Diagnostic> {
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

/// Reads typed parts out of the tree and keeps what goes wrong.
struct Reader<'a> {
    text: &'a str,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn root_fields<'n>(&mut self, root: &'n Node) -> Vec<&'n Field> {
        let Kind::Struct { fields, .. } = &root.kind else {
            self.diagnostics.push(
                Diagnostic::new("a scene is a struct: `(name: .., entities: {..}, run: (..))`")
                    .at(root.opening()),
            );
            return Vec::new();
        };
        for field in fields {
            if !ROOT_FIELDS.contains(&field.name.as_str()) {
                self.unexpected(field, "the scene", &ROOT_FIELDS, &field.name);
            }
        }
        fields.iter().collect()
    }

    fn unexpected(&mut self, field: &Field, owner: &str, expected: &[&str], path: &str) {
        let list = expected
            .iter()
            .map(|name| format!("`{name}`"))
            .collect::<Vec<_>>()
            .join(", ");
        let mut diagnostic = Diagnostic::new(format!(
            "unexpected field `{}` in {owner}, expected one of {list}",
            field.name
        ))
        .at(field.name_span.clone())
        .with_path(path);
        if let Some(name) = nearest(&field.name, expected.iter().copied()) {
            diagnostic = diagnostic.with_help(format!("did you mean `{name}`?"));
        }
        self.diagnostics.push(diagnostic);
    }

    fn optional<T: DeserializeOwned>(
        &mut self,
        fields: &[&Field],
        name: &str,
        default: impl FnOnce() -> T,
    ) -> Option<T> {
        match fields.iter().find(|field| field.name == name) {
            Some(field) => self.parse(field),
            None => Some(default()),
        }
    }

    fn required<T: DeserializeOwned>(
        &mut self,
        fields: &[&Field],
        root: &Node,
        name: &str,
    ) -> Option<T> {
        match fields.iter().find(|field| field.name == name) {
            Some(field) => self.parse(field),
            None => {
                self.missing(root, name);
                None
            }
        }
    }

    /// Nothing is missing from what is no scene, nor what stands there under a wrong name.
    fn missing(&mut self, root: &Node, name: &str) {
        let misnamed = |found: &&str| {
            !ROOT_FIELDS.contains(found) && nearest(found, ROOT_FIELDS) == Some(name)
        };
        let is_scene = matches!(root.kind, Kind::Struct { .. });
        if !is_scene || root.names().iter().any(misnamed) {
            return;
        }
        self.diagnostics.push(
            Diagnostic::new(format!("the scene needs the field `{name}`")).at(root.opening()),
        );
    }

    fn parse<T: DeserializeOwned>(&mut self, field: &Field) -> Option<T> {
        match parse_fields(self.text, &field.value, &field.name) {
            Ok(value) => Some(value),
            Err(found) => {
                self.keep(field, found);
                None
            }
        }
    }

    /// Keeps what was found in a field; what is of the whole of it is shown at its name.
    fn keep(&mut self, field: &Field, found: Vec<Diagnostic>) {
        let node = &field.value;
        let opening = node.name().is_none().then(|| node.opening());
        self.diagnostics.extend(found.into_iter().map(|diagnostic| {
            if diagnostic.span.is_some() && diagnostic.span == opening {
                diagnostic.at(field.name_span.clone())
            } else {
                diagnostic
            }
        }));
    }

    fn entities(
        &mut self,
        simulator: &Simulator,
        fields: &[&Field],
        root: &Node,
    ) -> Vec<SceneEntity> {
        let Some(field) = fields.iter().find(|field| field.name == "entities") else {
            self.missing(root, "entities");
            return Vec::new();
        };
        let Kind::Map { entries, .. } = &field.value.kind else {
            self.diagnostics.push(
                Diagnostic::new("`entities` is a map: `{ \"name\": (Component: (..), ..), .. }`")
                    .at(field.value.opening())
                    .with_path("entities"),
            );
            return Vec::new();
        };
        let mut entities = Vec::new();
        for entry in entries {
            let allowed = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
            if entry.name.is_empty() || !entry.name.chars().all(allowed) {
                self.diagnostics.push(
                    Diagnostic::new(format!("`{}` cannot name an entity", entry.name))
                        .at(entry.key.span.clone())
                        .with_path("entities")
                        .with_help("use letters, digits, `-` and `_`"),
                );
                continue;
            }
            if entry.name == "system" {
                self.diagnostics.push(
                    Diagnostic::new(
                        "`system` cannot name an entity: it stands for the whole scene",
                    )
                    .at(entry.key.span.clone())
                    .with_path("entities.system")
                    .with_help("give it another name"),
                );
                continue;
            }
            let known = self.diagnostics.len();
            let components = self.components(simulator, &entry.name, &entry.value);
            entities.push(SceneEntity {
                name: entry.name.clone(),
                components,
                complete: self.diagnostics.len() == known,
            });
        }
        entities
    }

    fn components(
        &mut self,
        simulator: &Simulator,
        entity: &str,
        node: &Node,
    ) -> Vec<(&'static str, Box<dyn super::registry::ParsedComponent>)> {
        let Kind::Struct { fields, .. } = &node.kind else {
            self.diagnostics.push(
                Diagnostic::new("an entity is its components: `(Body: (..), Drag: ..)`")
                    .at(node.opening())
                    .with_path(format!("entities.{entity}")),
            );
            return Vec::new();
        };
        let mut components = Vec::new();
        for field in fields {
            let path = format!("entities.{entity}.{}", field.name);
            let Some(entry) = simulator.components.get(&field.name) else {
                self.unknown_component(simulator, field, &path);
                continue;
            };
            match (entry.parse)(self.text, &field.value, &path) {
                Ok(component) => components.push((entry.name, component)),
                Err(found) => self.keep(field, found),
            }
        }
        components
    }

    fn unknown_component(&mut self, simulator: &Simulator, field: &Field, path: &str) {
        let mut diagnostic = Diagnostic::new(format!("there is no component `{}`", field.name))
            .at(field.name_span.clone())
            .with_path(path);
        diagnostic = match nearest(&field.name, simulator.components.names()) {
            Some(name) => diagnostic.with_help(format!("did you mean `{name}`?")),
            None => {
                let names = simulator
                    .components
                    .names()
                    .collect::<Vec<_>>()
                    .join("`, `");
                diagnostic.with_help(format!("there are `{names}`"))
            }
        };
        self.diagnostics.push(diagnostic);
    }
}
