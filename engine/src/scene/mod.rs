//! Scenes: from a RON file to a checked description of what is to be simulated.
//!
//! In two steps. [`source`] knows the text (positions, overrides, diagnostics); [`load`] reads the
//! typed scene from it and collects every violation before it fails. What comes out, a [`Scene`], is
//! valid.

pub mod checks;
pub(crate) mod copies;
pub mod groups;
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
use aerobot_components::scene_component::{SceneComponent, Violation};

use groups::Groups;
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
    /// The entities, in the order of the file; of one that stands for others, those.
    pub entities: Vec<SceneEntity>,
    /// Which entities of the file stand for which others.
    pub groups: Groups,
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

    /// Whether an entity of this name may belong to one that could not be read.
    pub(crate) fn may_be_unread(&self, name: &str) -> bool {
        self.entities.iter().any(|entity| {
            let below = name.strip_prefix(entity.name.as_str());
            !entity.complete && below.is_some_and(|below| below.starts_with('/'))
        })
    }

    /// A violation of a node as one of its tether, which is what the scene has.
    fn of_owner(&self, mut violation: Violation) -> Violation {
        if let Some(name) = violation.path.strip_prefix("entities.")
            && self.entity(name).is_none()
            && let Some((owner, _)) = name.rsplit_once('/')
            && self.entity(owner).is_some()
        {
            violation.path = format!("entities.{owner}");
        }
        violation
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
        let owned = error
            .0
            .into_iter()
            .map(|violation| self.of_owner(violation));
        let violations = self.groups.relocate(owned.collect());
        SceneError::render(&self.source, &load::locate(&self.source, violations))
    }
}

/// What a setup finds wrong: violations as paths and messages.
#[derive(Debug)]
pub struct SetupError(pub Vec<Violation>);

impl SetupError {
    /// One violation at a path, with a remedy (may be empty).
    #[must_use]
    pub fn new(path: impl Into<String>, message: impl Into<String>, help: &str) -> Self {
        Self(vec![Violation {
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
