//! Which components a scene may write, and how each is read.

use std::any::{Any, TypeId};
use std::collections::BTreeMap;
use std::sync::Arc;

use aerobot_components::scene_component::{FieldReport, SceneComponent};
use bevy_ecs::world::EntityWorldMut;

use super::source::Diagnostic;
use super::source::Node;
use super::source::parse_fields;

/// A component as read from a scene, its type forgotten.
pub trait ParsedComponent: Any + Send + Sync {
    /// Reports what is wrong with its own fields.
    fn check(&self, report: &mut FieldReport);
    /// Inserts a copy into an entity.
    fn insert(&self, entity: &mut EntityWorldMut);
    /// The component itself, for a caller that knows its type.
    fn as_any(&self) -> &dyn Any;
    /// As [`ParsedComponent::as_any`], to be changed.
    fn as_any_mut(&mut self) -> &mut dyn Any;
    /// A copy.
    fn boxed_clone(&self) -> Box<dyn ParsedComponent>;
}

impl<C: SceneComponent> ParsedComponent for C {
    fn check(&self, report: &mut FieldReport) {
        SceneComponent::check(self, report);
    }

    fn insert(&self, entity: &mut EntityWorldMut) {
        entity.insert(self.clone());
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    fn boxed_clone(&self) -> Box<dyn ParsedComponent> {
        Box::new(self.clone())
    }
}

type Parser = fn(&str, &Node, &str) -> Result<Arc<dyn ParsedComponent>, Vec<Diagnostic>>;

/// One kind of component.
pub struct ComponentEntry {
    /// Name in the scene.
    pub name: &'static str,
    /// Names it cannot stand beside.
    pub excludes: &'static [&'static str],
    /// Groups of names of which it needs one each.
    pub requires: &'static [&'static [&'static str]],
    /// Its type.
    pub type_id: TypeId,
    /// Reads it from its node of the text.
    pub parse: Parser,
}

impl ComponentEntry {
    /// The entry of `C`.
    #[must_use]
    pub fn of<C: SceneComponent>() -> Self {
        Self {
            name: C::NAME,
            excludes: C::EXCLUDES,
            requires: C::REQUIRES,
            type_id: TypeId::of::<C>(),
            parse: |text, node, path| {
                parse_fields::<C>(text, node, path)
                    .map(|component| Arc::new(component) as Arc<dyn ParsedComponent>)
            },
        }
    }
}

/// All kinds of components, by name.
#[derive(Default)]
pub struct ComponentRegistry(BTreeMap<&'static str, ComponentEntry>);

impl ComponentRegistry {
    /// Adds an entry, or replaces the one of its name.
    pub fn insert(&mut self, entry: ComponentEntry) {
        self.0.insert(entry.name, entry);
    }

    /// The entry of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&ComponentEntry> {
        self.0.get(name)
    }

    /// All names, in order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.0.keys().copied()
    }
}
