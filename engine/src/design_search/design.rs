//! Designs: values of the variables, and what they set in the scene.
//!
//! The search sees a box whose sides are 0 to 1; a place in it is a design.

use super::specification::{Law, Scale, SearchSpec, VariableSpec};

/// Values of the variables of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The place in the box, from 0 to 1 along each variable.
    pub place: Vec<f64>,
    /// The values, each in the unit of its variable.
    pub values: Vec<f64>,
    /// Path and value, as text of the scene language, of each field that follows from them.
    pub fields: Vec<(String, String)>,
}

impl Design {
    /// The design at a place of the box; beyond its sides are its sides.
    #[must_use]
    pub fn at(search: &SearchSpec, place: &[f64]) -> Self {
        let variables = search.variables.0.iter();
        let place: Vec<f64> = place.iter().map(|part| part.clamp(0.0, 1.0)).collect();
        let values: Vec<f64> = variables
            .clone()
            .zip(&place)
            .map(|((_, variable), part)| variable.value(*part))
            .collect();
        let mut fields = Vec::new();
        for ((name, variable), value) in variables.zip(&values) {
            let text = |value: f64| {
                if variable.integer && value.fract() == 0.0 {
                    format!("{value}")
                } else {
                    format!("{value:?}")
                }
            };
            if variable.sets.0.is_empty() {
                fields.push((name.clone(), text(*value)));
            }
            for (path, law) in &variable.sets.0 {
                fields.push((path.clone(), text(law.value(*value))));
            }
        }
        Self {
            place,
            values,
            fields,
        }
    }

    /// As overrides `PATH=RON` of the scene.
    #[must_use]
    pub fn overrides(&self) -> Vec<String> {
        let fields = self.fields.iter();
        fields
            .map(|(path, value)| format!("{path}={value}"))
            .collect()
    }

    /// The values, exactly, as text that tells designs apart.
    #[must_use]
    pub fn key(&self) -> String {
        let values: Vec<String> = self
            .values
            .iter()
            .map(|value| format!("{value:?}"))
            .collect();
        values.join(",")
    }

    /// How far it is from another, along the variable where that is most.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let parts = self.place.iter().zip(&other.place);
        parts.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

impl VariableSpec {
    /// The value at a part of the way between the bounds.
    #[must_use]
    pub fn value(&self, part: f64) -> f64 {
        let Self { from, to, .. } = *self;
        if part <= 0.0 {
            return from;
        }
        if part >= 1.0 {
            return to;
        }
        if let Some(start) = self.start
            && self.part(start) == part
        {
            return start;
        }
        let value = match self.scale {
            Scale::Linear => from * (1.0 - part) + to * part,
            Scale::Log => libm::exp(libm::log(from) * (1.0 - part) + libm::log(to) * part),
        };
        let value = if self.integer { value.round() } else { value };
        value.clamp(from, to)
    }

    /// The part of the way between the bounds at which a value is.
    #[must_use]
    pub fn part(&self, value: f64) -> f64 {
        let Self { from, to, .. } = *self;
        let part = match self.scale {
            Scale::Linear => (value - from) / (to - from),
            Scale::Log => (libm::log(value) - libm::log(from)) / (libm::log(to) - libm::log(from)),
        };
        part.clamp(0.0, 1.0)
    }
}

impl Law {
    /// The value of the field, in its unit.
    #[must_use]
    pub fn value(&self, variable: f64) -> f64 {
        let power = if self.power == 1.0 {
            variable
        } else {
            libm::pow(variable, self.power)
        };
        self.factor * power
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variable(text: &str) -> VariableSpec {
        ron::from_str(text).unwrap()
    }

    #[test]
    fn parts_and_values_belong_together() {
        let linear = variable("(from: -2, to: 6)");
        assert_eq!(
            [0.0, 0.25, 1.0].map(|part| linear.value(part)),
            [-2.0, 0.0, 6.0]
        );
        assert_eq!(linear.part(4.0), 0.75);
        let log = variable("(from: 0.01, to: 100, scale: Log)");
        assert!((log.value(0.5) - 1.0).abs() < 1e-15);
        assert!((log.part(10.0) - 0.75).abs() < 1e-15);
        let whole = variable("(from: 3, to: 7, integer: true)");
        assert_eq!(whole.value(0.4), 5.0);
        let started = variable("(from: 0.1, to: 0.7, start: Some(0.3))");
        assert_eq!(started.value(started.part(0.3)), 0.3);
    }

    #[test]
    fn laws_are_powers() {
        let law: Law = ron::from_str("(factor: 3, power: 2)").unwrap();
        assert_eq!(law.value(5.0), 75.0);
        assert_eq!(ron::from_str::<Law>("()").unwrap().value(0.1), 0.1);
    }
}
