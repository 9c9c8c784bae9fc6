//! What is joined to what: tethers with their nodes, bodies, and who holds which end.

use bevy_ecs::component::Component;

/// Place of a free body among those of the topology.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyIndex(pub usize);

/// Where an end of a tether is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// On an anchor.
    Held,
    /// On the free body of this index.
    OnBody(usize),
}

/// A tether: its points are consecutive from `from` to `to`, and so are its nodes in the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// Index of its first point, the attachment at `from`; segments have that of their first point.
    pub first_point: usize,
    /// Number of its nodes.
    pub nodes: usize,
    /// Place of the first node's coordinates in the state.
    pub first_state: usize,
    /// Who carries the `from` end.
    pub from: End,
    /// Who carries the `to` end.
    pub to: End,
}

impl Line {
    /// Index of the last point, the attachment at `to`.
    #[must_use]
    pub fn last_point(&self) -> usize {
        self.first_point + self.nodes + 1
    }

    /// Points of its nodes.
    #[must_use]
    pub fn node_points(&self) -> std::ops::Range<usize> {
        self.first_point + 1..self.last_point()
    }

    /// Its segments, by the index of their first point.
    #[must_use]
    pub fn segments(&self) -> std::ops::Range<usize> {
        self.first_point..self.last_point()
    }
}

/// A free body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySite {
    /// Place of its coordinates in the state.
    pub first_state: usize,
    /// Whether it turns; a point does not.
    pub turns: bool,
    /// Length, m, by which an error of its attitude in rad counts as one of position.
    pub arm_m: f64,
}

impl BodySite {
    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        if self.turns { 6 } else { 3 }
    }
}

/// All of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Topology {
    /// The tethers.
    pub lines: Vec<Line>,
    /// The free bodies.
    pub bodies: Vec<BodySite>,
    /// Number of points of all tethers.
    pub points: usize,
    /// Number of coordinates of the state.
    pub coordinates: usize,
}
