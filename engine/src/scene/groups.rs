//! Entities that stand for others: a ring of tethers, copies of an entity. What is wrong with one of
//! those is said of the place where it is written.

use std::sync::Arc;

use std::collections::BTreeMap;

use aerobot_components::run::{ChannelSelection, InstrumentSelection, RecordSpec};
use aerobot_components::scene_component::{SceneComponent, Violation};

use super::SceneEntity;
use super::registry::ParsedComponent;
use super::source::{FieldPath, Segment};

type Members = dyn Fn(&SceneEntity) -> Option<Vec<Box<dyn ParsedComponent>>> + Send + Sync;

/// How entities with one component stand for entities with another each.
pub(crate) struct Expansion {
    /// Name of the component that stands in the scene.
    pub(crate) written: &'static str,
    /// Name of the component that each member has.
    pub(crate) member: &'static str,
    members: Box<Members>,
}

impl Expansion {
    /// An entity with a `C` stands for entities with one component each of what `members` gives.
    pub(crate) fn new<C: SceneComponent, M: SceneComponent>(
        members: impl Fn(&C) -> Vec<M> + Send + Sync + 'static,
    ) -> Self {
        Self {
            written: C::NAME,
            member: M::NAME,
            members: Box::new(move |entity| {
                let members = members(entity.get::<C>()?).into_iter();
                Some(members.map(|member| Box::new(member) as _).collect())
            }),
        }
    }

    /// The entities for which `entity` stands, if it has the component.
    fn apply(&self, entity: &SceneEntity) -> Option<Vec<SceneEntity>> {
        let members = (self.members)(entity)?;
        let numbered = members.into_iter().enumerate().map(|(index, member)| {
            let mut member = Some(member);
            let components = entity.components.iter().filter_map(|(name, component)| {
                if *name == self.written {
                    member.take().map(|member| (self.member, Arc::from(member)))
                } else {
                    Some((*name, component.clone()))
                }
            });
            SceneEntity {
                name: format!("{}/{}", entity.name, index + 1),
                components: components.collect(),
                complete: entity.complete,
            }
        });
        Some(numbered.collect())
    }
}

/// What an entity of the text stands for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Name of the entity that is written.
    pub name: String,
    /// Name of the component that makes it a group.
    pub component: &'static str,
    /// Names of the entities for which it stands, in order.
    pub members: Vec<String>,
    /// Name of the component that members have in place of that one; none for copies.
    member_component: Option<&'static str>,
}

/// The groups of a scene.
#[derive(Clone, Debug, Default)]
pub struct Groups {
    groups: Vec<Group>,
    of_members: BTreeMap<String, usize>,
}

impl Groups {
    /// All of them, in the order of the scene; a group of groups before its members.
    pub fn iter(&self) -> impl Iterator<Item = &Group> {
        self.groups.iter()
    }

    /// The group of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&Group> {
        self.groups.iter().find(|group| group.name == name)
    }

    /// The group to which the entity `member` belongs, and its place there from 0.
    #[must_use]
    pub fn of(&self, member: &str) -> Option<(&Group, usize)> {
        let group = self.groups.get(*self.of_members.get(member)?)?;
        let place = group.members.iter().position(|other| other == member)?;
        Some((group, place))
    }

    /// Help for someone who names a group where one entity is meant.
    #[must_use]
    pub(crate) fn help(&self, name: &str) -> Option<String> {
        let group = self.get(name)?;
        let (first, last) = (group.members.first()?, group.members.last()?);
        Some(format!(
            "`{name}` stands for `{first}` to `{last}`: name one of them"
        ))
    }

    /// Notes that `name` stands for `members`.
    pub(super) fn add(
        &mut self,
        name: &str,
        component: &'static str,
        member_component: Option<&'static str>,
        members: &[SceneEntity],
    ) {
        let members: Vec<String> = members.iter().map(|entity| entity.name.clone()).collect();
        for member in &members {
            self.of_members.insert(member.clone(), self.groups.len());
        }
        self.groups.push(Group {
            name: name.to_owned(),
            component,
            members,
            member_component,
        });
    }

    /// Puts the members of every entity that stands for others in its place.
    pub(super) fn expand(
        &mut self,
        expansions: &[Expansion],
        entities: Vec<SceneEntity>,
    ) -> Vec<SceneEntity> {
        let mut expanded = Vec::with_capacity(entities.len());
        for entity in entities {
            let members = expansions
                .iter()
                .find_map(|expansion| Some((expansion, expansion.apply(&entity)?)));
            match members {
                // Of none there is nothing to build; its own check has said so.
                Some((_, members)) if members.is_empty() => expanded.push(SceneEntity {
                    complete: false,
                    ..entity
                }),
                Some((expansion, members)) => {
                    let (written, member) = (expansion.written, expansion.member);
                    self.add(&entity.name, written, Some(member), &members);
                    expanded.extend(members);
                }
                None => expanded.push(entity),
            }
        }
        expanded
    }

    /// Whatever is recorded of a group is recorded of its members.
    pub(super) fn expand_record(&self, record: &mut RecordSpec) {
        for group in &self.groups {
            if let ChannelSelection::Only(channels) = &mut record.channels
                && let Some(wanted) = channels.remove(&group.name)
            {
                for member in &group.members {
                    let own = channels.entry(member.clone()).or_default();
                    own.extend(wanted.iter().cloned());
                }
            }
            if let InstrumentSelection::Only(names) = &mut record.instruments
                && let Some(place) = names.iter().position(|name| *name == group.name)
            {
                let mut members = group.members.iter().cloned();
                names.splice(place..=place, members.next());
                names.extend(members);
            }
        }
    }

    /// Violations at the places where their entities are written; what is wrong with several members of a
    /// group in the same way is said once, of the group.
    pub(super) fn relocate(&self, violations: Vec<Violation>) -> Vec<Violation> {
        let mut found: Vec<(Violation, Violation, usize)> = Vec::new();
        for violation in violations {
            let common = self.of_group(&violation);
            let same = found.iter_mut().find(|(_, other, _)| *other == common);
            match same {
                Some((_, _, count)) => *count += 1,
                None => {
                    let path = common.path.clone();
                    found.push((Violation { path, ..violation }, common, 1));
                }
            }
        }
        let said = |(own, common, count)| if count > 1 { common } else { own };
        found.into_iter().map(said).collect()
    }

    /// The violation as one of everything that is written there.
    fn of_group(&self, violation: &Violation) -> Violation {
        let mut common = violation.clone();
        let Ok(mut path) = violation.path.parse::<FieldPath>() else {
            return common;
        };
        let plain: Vec<String> = path.segments.iter().map(Segment::plain).collect();
        let at = match plain.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["entities", ..] => 1,
            ["run", "record", "channels", ..] => 3,
            _ => return common,
        };
        let Some(mut name) = plain.get(at).cloned() else {
            return common;
        };
        while let Some((group, _)) = self.of(&name) {
            let segments = &mut path.segments;
            if let (Some(member), Some(component)) =
                (group.member_component, segments.get_mut(at + 1))
                && component.plain() == member
            {
                *component = Segment::Name(group.component.to_owned());
            }
            let (one, all) = (format!("`{name}`"), format!("`{}`", group.name));
            common.message = common.message.replace(&one, &all);
            common.help = common.help.map(|help| help.replace(&one, &all));
            name.clone_from(&group.name);
        }
        path.segments[at] = Segment::Name(name);
        common.path = path.to_string();
        common
    }
}
