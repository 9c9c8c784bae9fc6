//! Segments between tether points: geometry before the forces, loads to the points after them.
//!
//! Segments read the points through flat arrays that are filled once per evaluation: two look-ups
//! of entities per segment would cost as much as all of its arithmetic.

use std::ops::Range;

use aerobot_components::segment::{Segment, SegmentGeometry, SegmentLoad};
use aerobot_components::state::{Force, Position, Velocity};
use aerobot_components::tether::TetherPoint;
use bevy_ecs::change_detection::DetectChangesMut;
use bevy_ecs::resource::Resource;
use bevy_ecs::system::{Query, ResMut};
use glam::DVec3;

/// States and loads of all tether points by index, valid within one evaluation.
#[derive(Resource, Debug, Default)]
pub struct PointArrays {
    position_m: Vec<DVec3>,
    velocity_m_s: Vec<DVec3>,
    load_n: Vec<DVec3>,
}

impl PointArrays {
    /// Arrays for `count` points.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self {
            position_m: vec![DVec3::ZERO; count],
            velocity_m_s: vec![DVec3::ZERO; count],
            load_n: vec![DVec3::ZERO; count],
        }
    }

    /// Positions (m) and velocities (m/s) of a range of points, inertial frame.
    #[must_use]
    pub fn motion_of(&self, points: Range<usize>) -> (&[DVec3], &[DVec3]) {
        (&self.position_m[points.clone()], &self.velocity_m_s[points])
    }

    /// Loads (N, inertial frame) of the two ends of the segment that begins at `from_point`: what a law
    /// adds here while forces are found reaches the points with the loads of
    /// the segments.
    pub fn loads_of_segment_n(&mut self, from_point: usize) -> &mut [DVec3] {
        &mut self.load_n[from_point..from_point + 2]
    }

    /// Loads by point, N: zero between the systems that use them.
    pub(super) fn loads_n(&mut self) -> &mut [DVec3] {
        &mut self.load_n
    }
}

/// Finds direction, length, rate, midpoint and mean velocity of every segment, and clears its load.
pub fn segment_geometry(
    mut arrays: ResMut<PointArrays>,
    points: Query<(&TetherPoint, &Position, &Velocity)>,
    mut segments: Query<(&Segment, &mut SegmentGeometry, &mut SegmentLoad)>,
) {
    let arrays = &mut *arrays;
    for (point, position, velocity) in &points {
        arrays.position_m[point.index] = position.0;
        arrays.velocity_m_s[point.index] = velocity.0;
    }
    for (segment, mut geometry, mut load) in &mut segments {
        *load.bypass_change_detection() = SegmentLoad::default();
        let index = segment.from_point;
        let ends = &arrays.position_m[index..index + 2];
        let speeds = &arrays.velocity_m_s[index..index + 2];
        *geometry.bypass_change_detection() =
            geometry_between(ends[0], ends[1], speeds[0], speeds[1]);
    }
}

/// Geometry of a segment between two points with positions in m and velocities in m/s.
#[inline]
#[must_use]
pub fn geometry_between(
    from_m: DVec3,
    to_m: DVec3,
    from_velocity_m_s: DVec3,
    to_velocity_m_s: DVec3,
) -> SegmentGeometry {
    let span = to_m - from_m;
    let length_m = span.length_squared().sqrt();
    let direction = if length_m > 0.0 {
        span / length_m
    } else {
        DVec3::ZERO
    };
    SegmentGeometry {
        direction,
        length_m,
        length_rate_m_s: (to_velocity_m_s - from_velocity_m_s).dot(direction),
        midpoint_m: 0.5 * (from_m + to_m),
        velocity_m_s: 0.5 * (from_velocity_m_s + to_velocity_m_s),
    }
}

/// Adds the loads of all segments to the forces on the points at their ends.
pub fn load_points(
    mut arrays: ResMut<PointArrays>,
    segments: Query<(&Segment, &SegmentLoad)>,
    mut points: Query<(&TetherPoint, &mut Force)>,
) {
    let loads = &mut arrays.load_n;
    for (segment, load) in &segments {
        let ends = &mut loads[segment.from_point..segment.from_point + 2];
        ends[0] += load.from_n;
        ends[1] += load.to_n;
    }
    for (point, mut force) in &mut points {
        // Taken, so that the next evaluation finds zeros.
        force.bypass_change_detection().0 += std::mem::take(&mut loads[point.index]);
    }
}
