//! Reads the typed parts of a scene out of its tree, one by one, and keeps what goes wrong with each.

use std::sync::Arc;

use aerobot_components::copies::Copies;
use glam::DVec3;
use serde::de::DeserializeOwned;

use super::groups::Groups;
use super::registry::ParsedComponent;
use super::source::{Diagnostic, Field, Kind, Node, nearest, parse_fields, scan};
use super::{SceneEntity, copies};
use crate::plugin::Simulator;

const ROOT_FIELDS: [&str; 6] = ["name", "about", "environment", "entities", "events", "run"];

/// An entity as it is written, and its copies if it has `Copies`.
pub(super) struct Written {
    pub(super) entity: SceneEntity,
    copies: Option<Vec<SceneEntity>>,
}

impl Written {
    /// What it stands for: its copies, or itself.
    pub(super) fn into_copies(self, groups: &mut Groups) -> Vec<SceneEntity> {
        match self.copies {
            Some(found) => {
                groups.add(&self.entity.name, copies::COPIES, None, &found);
                found
            }
            // Without its copies nothing more can be said of it.
            None if self.entity.has::<Copies>() => vec![SceneEntity {
                complete: false,
                ..self.entity
            }],
            None => vec![self.entity],
        }
    }
}

/// Reads typed parts out of the tree and keeps what goes wrong.
pub(super) struct Reader<'a> {
    pub(super) text: &'a str,
    pub(super) diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    pub(super) fn root_fields<'n>(&mut self, root: &'n Node) -> Vec<&'n Field> {
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

    pub(super) fn optional<T: DeserializeOwned>(
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

    pub(super) fn required<T: DeserializeOwned>(
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

    pub(super) fn entities(
        &mut self,
        simulator: &Simulator,
        fields: &[&Field],
        root: &Node,
    ) -> Vec<Written> {
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
            let is_plain = |part: &str| !part.is_empty() && part.chars().all(allowed);
            if !entry.name.split('/').all(is_plain) {
                self.diagnostics.push(
                    Diagnostic::new(format!("`{}` cannot name an entity", entry.name))
                        .at(entry.key.span.clone())
                        .with_path("entities")
                        .with_help(
                            "use letters, digits, `-` and `_`, and `/` between parts of a name",
                        ),
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
            let entity = SceneEntity {
                name: entry.name.clone(),
                components,
                complete: self.diagnostics.len() == known,
            };
            let copies = self.copies(simulator, &entity, &entry.value);
            entities.push(Written { entity, copies });
        }
        entities
    }

    fn components(
        &mut self,
        simulator: &Simulator,
        entity: &str,
        node: &Node,
    ) -> Vec<(&'static str, Arc<dyn ParsedComponent>)> {
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

    /// The copies of an entity, if it is to be copied.
    fn copies(
        &mut self,
        simulator: &Simulator,
        entity: &SceneEntity,
        node: &Node,
    ) -> Option<Vec<SceneEntity>> {
        let count = copies::count(entity).filter(|_| entity.complete)?;
        let known = self.diagnostics.len();
        let mut found = Vec::new();
        for number in 1..=count {
            let name = format!("{}/{number}", entity.name);
            let components = self.copy(simulator, entity, node, number);
            // What is wrong with one is wrong with all.
            let complete = self.diagnostics.len() == known;
            found.push(SceneEntity {
                name,
                components,
                complete,
            });
            if !complete {
                return None;
            }
        }
        Some(found)
    }

    /// The components of copy `number` of an entity.
    fn copy(
        &mut self,
        simulator: &Simulator,
        entity: &SceneEntity,
        node: &Node,
        number: u32,
    ) -> Vec<(&'static str, Arc<dyn ParsedComponent>)> {
        let Kind::Struct { fields, .. } = &node.kind else {
            return Vec::new();
        };
        let step_m = entity.get::<Copies>().map_or(DVec3::ZERO, |c| c.step_m);
        let mut components = Vec::new();
        for (name, component) in &entity.components {
            let Some(field) = fields.iter().find(|field| field.name == *name) else {
                continue;
            };
            if *name == copies::COPIES {
                continue;
            }
            let mut component = component.boxed_clone();
            if let Some(text) = copies::numbered_text(self.text, &field.value, number)
                && let Some(entry) = simulator.components.get(name)
                && let Ok(value) = scan(&text)
            {
                let path = format!("entities.{}.{name}", entity.name);
                match (entry.parse)(&text, &value, &path) {
                    Ok(own) => component = own.boxed_clone(),
                    Err(found) => {
                        let placed = found.into_iter().map(|d| d.at(field.name_span.clone()));
                        self.diagnostics.extend(placed);
                        return components;
                    }
                }
            }
            copies::shift(&mut *component, f64::from(number - 1) * step_m);
            components.push((*name, Arc::from(component)));
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
