//! Where everything is: the origin of a file, how large what it shows is, and cameras.

use glam::{DMat3, DQuat, DVec3};
use serde_json::json;

use super::axes;
use super::document::{Document, Motion};
use crate::animation::Animation;
use crate::animation::appearance::Solid;

/// Vertical angle of view of cameras, rad.
const VIEW_RAD: f64 = 0.7;
/// From what is looked at to the camera, axes of scenes: upwind, to the right and above.
const TOWARDS_CAMERA: DVec3 = DVec3::new(-0.5, -0.85, 0.2);

/// What a file shows.
pub(super) struct Stage {
    /// Which frames of the animation: those whose times differ in single precision.
    pub(super) frames: Vec<usize>,
    /// Their times since the first, s.
    pub(super) times_s: Vec<[f32; 1]>,
    /// What positions are from, inertial frame, whole metres.
    pub(super) origin_m: DVec3,
    /// Half the diagonal of the box about everything in all frames, m.
    reach_m: f64,
    /// The same of single frames, their median, m.
    pub(super) size_m: f64,
}

impl Stage {
    pub(super) fn of(animation: &Animation) -> Self {
        let start_s = animation.times_s.first().copied().unwrap_or(0.0);
        let mut frames: Vec<usize> = Vec::with_capacity(animation.times_s.len());
        let mut times_s: Vec<[f32; 1]> = Vec::with_capacity(animation.times_s.len());
        for (frame, time_s) in animation.times_s.iter().enumerate() {
            let time_s = (time_s - start_s) as f32;
            if times_s.last().is_none_or(|[last]| time_s > *last) {
                frames.push(frame);
                times_s.push([time_s]);
            }
        }
        let half_diagonal_m = |[least, greatest]: [DVec3; 2]| 0.5 * (greatest - least).length();
        let sizes_m = frames.chunks(1);
        let sizes_m = sizes_m.map(|frame| half_diagonal_m(corners(animation, frame)));
        let mut sizes_m: Vec<f64> = sizes_m.collect();
        sizes_m.sort_by(f64::total_cmp);
        let [least, greatest] = corners(animation, &frames);
        Self {
            size_m: sizes_m[frames.len() / 2],
            frames,
            times_s,
            origin_m: (0.5 * (least + greatest)).round(),
            reach_m: half_diagonal_m([least, greatest]),
        }
    }

    /// A place in the file.
    pub(super) fn place(&self, position_m: DVec3) -> [f32; 3] {
        axes::single(axes::vector(position_m - self.origin_m).to_array())
    }

    /// Two cameras: one that shows the whole flight, and one that goes with what there is in each frame.
    pub(super) fn add_cameras(&self, animation: &Animation, document: &mut Document) -> Vec<usize> {
        let frames = self.frames.chunks(1);
        let middles = frames.map(|frame| {
            let [least, greatest] = corners(animation, frame);
            0.5 * (least + greatest)
        });
        let middles = middles.collect();
        vec![
            self.add_camera("following camera", middles, 1.2 * self.size_m, document),
            self.add_camera("camera", vec![self.origin_m], self.reach_m, document),
        ]
    }

    fn add_camera(
        &self,
        name: &str,
        looks_at_m: Vec<DVec3>,
        radius_m: f64,
        document: &mut Document,
    ) -> usize {
        let distance_m = radius_m.max(1.0) / libm::sin(0.5 * VIEW_RAD);
        let back = TOWARDS_CAMERA.normalize();
        let places = looks_at_m
            .iter()
            .map(|at_m| self.place(at_m + distance_m * back));
        let attitude = facing(axes::vector(back));
        let motion = Motion {
            translations: places.collect(),
            rotations: vec![axes::single(attitude.to_array())],
            ..Motion::default()
        };
        let camera = document.cameras.len();
        document.cameras.push(json!({
            "type": "perspective",
            "perspective": {
                "yfov": VIEW_RAD,
                "znear": 1e-3 * distance_m,
                "zfar": 10.0 * distance_m,
            },
        }));
        document.moving_node(json!({ "name": name, "camera": camera }), &motion)
    }
}

/// The attitude whose z axis is `back` and whose y axis is as upright as that allows: cameras look along -z.
fn facing(back: DVec3) -> DQuat {
    let right = DVec3::Y.cross(back).normalize();
    DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back))
}

/// Least and greatest coordinates of all bodies and points in these frames, m.
fn corners(animation: &Animation, frames: &[usize]) -> [DVec3; 2] {
    let mut corners = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut take = |point_m: DVec3, radius_m: f64| {
        corners[0] = corners[0].min(point_m - radius_m);
        corners[1] = corners[1].max(point_m + radius_m);
    };
    for frame in frames {
        for body in &animation.bodies {
            for part in &body.parts {
                let at_m = DVec3::from_array(part.at_m);
                let centre_m = body.positions_m[*frame] + body.attitudes[*frame] * at_m;
                take(centre_m, radius_m(&part.solid));
            }
        }
        for tether in &animation.tethers {
            for point_m in &tether.points_m[*frame] {
                take(*point_m, 0.0);
            }
        }
    }
    corners
}

/// Radius of the sphere about a solid, m.
fn radius_m(solid: &Solid) -> f64 {
    match *solid {
        Solid::Sphere { radius_m } => radius_m,
        Solid::Box { size_m } => 0.5 * DVec3::from_array(size_m).length(),
        Solid::Cylinder { radius_m, height_m } => libm::hypot(radius_m, 0.5 * height_m),
    }
}
