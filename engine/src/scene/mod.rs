//! Scenes: from a RON file to a checked description of what is to be simulated.
//!
//! In two steps. [`source`] knows the text (positions, overrides, diagnostics); [`load`] reads the
//! typed scene from it and collects every violation before it fails. What comes out, a [`Scene`], is
//! valid.

pub mod checks;
pub mod load;
mod reader;
pub mod registry;
pub mod source;
pub mod tables;

use std::fmt;
use std::sync::Arc;

use aerobot_components::environment::Environment;
use aerobot_components::events::EventSpec;
use aerobot_components::run::RunSpec;
use aerobot_components::scene_component::SceneComponent;

use registry::ParsedComponent;
use source::{Diagnostic, Source};
use tables::Tables;

/// A scene: named entities with their components, their environment, and how it is run.
#[derive(Clone)]
pub struct Scene {
    /// Name of the scene; also of its default output folder.
    pub name: String,
    /// What it shows.
    pub about: String,
    /// Gravity, air and wind.
    pub environment: Environment,
    /// The entities, in the order of the file.
    pub entities: Vec<SceneEntity>,
    /// What happens during the run, in the order of the file.
    pub events: Vec<EventSpec>,
    /// How it is run.
    pub run: RunSpec,
    /// The tables that it reads from files beside it.
    pub tables: Tables,
    /// The text it was read from.
    pub source: Source,
}

/// One named entity of a scene.
#[derive(Clone)]
pub struct SceneEntity {
    /// Its name.
    pub name: String,
    /// Its components with their names, in the order of the file.
    pub components: Vec<(&'static str, Arc<dyn ParsedComponent>)>,
    /// Whether all of it could be read. A check is also run on a scene that is refused in any case;
    /// of an entity that is not complete it cannot know what is missing.
    pub complete: bool,
}

impl SceneEntity {
    /// Its component of type `C`, if it has one.
    #[must_use]
    pub fn get<C: SceneComponent>(&self) -> Option<&C> {
        self.components
            .iter()
            .find_map(|(_, component)| component.as_any().downcast_ref())
    }

    /// Whether it has a component of type `C`.
    #[must_use]
    pub fn has<C: SceneComponent>(&self) -> bool {
        self.get::<C>().is_some()
    }

    /// The path of a component of it: `entities.NAME.COMPONENT`.
    #[must_use]
    pub fn path<C: SceneComponent>(&self) -> String {
        format!("entities.{}.{}", self.name, C::NAME)
    }
}

impl Scene {
    /// The entity of a name.
    #[must_use]
    pub fn entity(&self, name: &str) -> Option<&SceneEntity> {
        self.entities.iter().find(|entity| entity.name == name)
    }

    /// Every entity that has a component of type `C`, with it, in the order of the file.
    pub fn with<C: SceneComponent>(&self) -> impl Iterator<Item = (&SceneEntity, &C)> {
        self.entities
            .iter()
            .filter_map(|entity| Some((entity, entity.get::<C>()?)))
    }

    /// Turns what a setup found into the message that a user reads.
    #[must_use]
    pub fn refuse(&self, error: SetupError) -> SceneError {
        SceneError::render(&self.source, &load::locate(&self.source, error.0))
    }
}

/// What a setup finds wrong: violations as paths and messages.
#[derive(Debug)]
pub struct SetupError(pub Vec<aerobot_components::scene_component::Violation>);

impl SetupError {
    /// One violation at a path, with a remedy (may be empty).
    #[must_use]
    pub fn new(path: impl Into<String>, message: impl Into<String>, help: &str) -> Self {
        Self(vec![aerobot_components::scene_component::Violation {
            path: path.into(),
            message: message.into(),
            help: (!help.is_empty()).then(|| help.to_owned()),
        }])
    }
}

/// Why a scene is refused: the rendered messages, ready to be printed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// The messages.
    pub text: String,
}

impl SceneError {
    /// From a message without a place.
    #[must_use]
    pub fn plain(message: impl fmt::Display) -> Self {
        Self {
            text: format!("error: {message}"),
        }
    }

    fn render(source: &Source, diagnostics: &[Diagnostic]) -> Self {
        Self {
            text: source.render(diagnostics).trim_end().to_owned(),
        }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.text)
    }
}

impl std::error::Error for SceneError {}
