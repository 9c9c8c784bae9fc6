//! Where in a state the joint coordinates of a tree stand: bodies first, then links.

use super::link_mechanism::LinkMechanism;
use crate::denoc::stage_system::JointPlaces;

/// Where in the state the coordinates of a body begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyPlace {
    /// Of a base: displacement, then rotation.
    Base(usize),
    /// Of a carried body that turns: rotation.
    Turning(usize),
    /// A carried point has none.
    Point,
}

impl BodyPlace {
    /// Where its rotation begins.
    #[must_use]
    pub fn rotation(self) -> Option<usize> {
        match self {
            Self::Base(at) => Some(at + 3),
            Self::Turning(at) => Some(at),
            Self::Point => None,
        }
    }
}

/// The places of all.
#[derive(Clone, Debug, Default)]
pub struct JointLayout {
    /// Of each body and tip.
    pub bodies: Vec<BodyPlace>,
    /// Of the first link; three for each.
    pub first_link: usize,
    /// Number of coordinates.
    pub coordinates: usize,
}

impl JointLayout {
    /// For a tree.
    #[must_use]
    pub fn new(mechanism: &LinkMechanism) -> Self {
        let mut layout = Self::default();
        let turns = &mechanism.entities.turns;
        for (carried_by, turns) in mechanism.tree.carried_by.iter().zip(turns) {
            let (place, count) = match (carried_by, turns) {
                (None, _) => (BodyPlace::Base(layout.coordinates), 6),
                (Some(_), true) => (BodyPlace::Turning(layout.coordinates), 3),
                (Some(_), false) => (BodyPlace::Point, 0),
            };
            layout.bodies.push(place);
            layout.coordinates += count;
        }
        layout.first_link = layout.coordinates;
        layout.coordinates += 3 * mechanism.tree.links;
        layout
    }

    /// The same for the solver of implicit steps.
    #[must_use]
    pub fn places(&self) -> JointPlaces {
        let displacement = |place: &BodyPlace| match place {
            BodyPlace::Base(at) => Some(*at),
            BodyPlace::Turning(_) | BodyPlace::Point => None,
        };
        let bodies = self.bodies.iter();
        JointPlaces {
            bodies: bodies
                .map(|place| (displacement(place), place.rotation()))
                .collect(),
            first_link: self.first_link,
            coordinates: self.coordinates,
        }
    }
}
