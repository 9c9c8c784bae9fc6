//! What makes a component writable in a scene: its name there and the checks on its own fields.

use bevy_ecs::component::Component;
use glam::DVec3;
use serde::de::DeserializeOwned;

/// A component that a scene may write under an entity, as `NAME: (field: value, ..)`.
///
/// The type is inserted as it stands; whatever is derived from it (a mass, a spring) is added when
/// the simulation is built.
pub trait SceneComponent: Component + DeserializeOwned + Clone {
    /// The name in the scene: the Rust name of the type.
    const NAME: &'static str;

    /// Components that cannot stand beside this one on an entity.
    const EXCLUDES: &'static [&'static str] = &[];

    /// Components this one needs beside it, each entry a list of alternatives.
    const REQUIRES: &'static [&'static [&'static str]] = &[];

    /// Reports what is wrong with the component's own fields.
    fn check(&self, _report: &mut FieldReport) {}
}

/// One thing that is wrong in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// Where: a path such as `entities.tether.Tether.length_m`.
    pub path: String,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub help: Option<String>,
}

/// Collects violations; field names are relative to the path it was made with.
#[derive(Debug, Default)]
pub struct FieldReport {
    base: String,
    violations: Vec<Violation>,
}

impl FieldReport {
    /// A report whose fields stand under the path `base` (empty for the root of the scene).
    #[must_use]
    pub fn new(base: impl Into<String>) -> Self {
        Self {
            base: base.into(),
            violations: Vec::new(),
        }
    }

    /// Everything reported so far.
    #[must_use]
    pub fn into_violations(self) -> Vec<Violation> {
        self.violations
    }

    /// A report on what stands under `field`, whose violations join this one's.
    pub fn within(&mut self, field: &str, check: impl FnOnce(&mut Self)) {
        let inner = self.path(field);
        let outer = std::mem::replace(&mut self.base, inner);
        check(self);
        self.base = outer;
    }

    /// Reports `message` on `field` (empty for the whole), with a remedy in `help`.
    pub fn add(&mut self, field: &str, message: impl Into<String>, help: impl Into<String>) {
        let help = help.into();
        self.violations.push(Violation {
            path: self.path(field),
            message: message.into(),
            help: (!help.is_empty()).then_some(help),
        });
    }

    /// `value` must be finite and above zero.
    pub fn positive(&mut self, field: &str, value: f64) {
        if !(value.is_finite() && value > 0.0) {
            self.add(
                field,
                format!("`{}` must be above zero, it is {value}", last(field)),
                "",
            );
        }
    }

    /// `value` must be finite and not below zero.
    pub fn non_negative(&mut self, field: &str, value: f64) {
        if !(value.is_finite() && value >= 0.0) {
            self.add(
                field,
                format!("`{}` must not be negative, it is {value}", last(field)),
                "",
            );
        }
    }

    /// `value` must be a finite number.
    pub fn finite(&mut self, field: &str, value: f64) {
        if !value.is_finite() {
            self.add(
                field,
                format!("`{}` must be a finite number, it is {value}", last(field)),
                "",
            );
        }
    }

    /// Every component of `value` must be a finite number.
    pub fn finite_vector(&mut self, field: &str, value: DVec3) {
        if !value.is_finite() {
            self.add(
                field,
                format!(
                    "`{}` must be three finite numbers, it is {value}",
                    last(field)
                ),
                "",
            );
        }
    }

    fn path(&self, field: &str) -> String {
        match (self.base.is_empty(), field.is_empty()) {
            (true, _) => field.to_owned(),
            (_, true) => self.base.clone(),
            _ => format!("{}.{field}", self.base),
        }
    }
}

fn last(field: &str) -> &str {
    field.rsplit('.').next().unwrap_or(field)
}
