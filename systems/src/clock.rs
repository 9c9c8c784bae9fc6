//! Simulated time as the systems see it.

use bevy_ecs::resource::Resource;

/// The time of the current evaluation, and the start of the interval it belongs to.
///
/// What switches at an instant (a gust, a command) is decided at the start of the interval and holds
/// for all of it: the integrator never steps across such an instant, and a stage that stands exactly
/// on the end of an interval still belongs to it.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct Clock {
    /// Time of the state that is being evaluated, s.
    pub time_s: f64,
    /// Start of the interval of smooth motion that contains it, s.
    pub interval_start_s: f64,
    /// Whether everything is held at rest, as while static equilibrium is sought: anchors stand where
    /// their path starts.
    pub at_rest: bool,
}
