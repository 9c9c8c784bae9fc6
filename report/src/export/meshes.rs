//! Triangles of the unit solids that parts are scaled from: axes as those of bodies, outward normals,
//! corners counter-clockwise seen from outside.

use std::f64::consts::PI;

use glam::DVec3;

use crate::animation::appearance::Solid;

/// Sides of a cylinder, and meridians of a sphere.
const SIDES: u32 = 24;
/// Belts of a sphere from pole to pole.
const BELTS: u32 = 12;

/// A closed surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mesh {
    pub(super) positions: Vec<DVec3>,
    /// One for each position, of length one.
    pub(super) normals: Vec<DVec3>,
    /// Places of corners.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Which unit solid a part is scaled from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Shape {
    /// Radius 1.
    Sphere,
    /// Edges of 1.
    Box,
    /// Along z, radius 1, height 1.
    Cylinder,
}

/// The unit solid of a part, and its scale along x, y, z, m.
pub(super) fn shape_and_scale(solid: &Solid) -> (Shape, DVec3) {
    match *solid {
        Solid::Sphere { radius_m } => (Shape::Sphere, DVec3::splat(radius_m)),
        Solid::Box { size_m } => (Shape::Box, DVec3::from_array(size_m)),
        Solid::Cylinder { radius_m, height_m } => {
            (Shape::Cylinder, DVec3::new(radius_m, radius_m, height_m))
        }
    }
}

impl Shape {
    /// Its triangles.
    pub(super) fn mesh(self) -> Mesh {
        match self {
            Self::Sphere => sphere(),
            Self::Box => cube(),
            Self::Cylinder => cylinder(),
        }
    }
}

impl Mesh {
    fn corner(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.positions.len() as u32 - 1
    }
}

/// A direction in the plane of x and y, so many sides round from x.
fn round(side: u32) -> DVec3 {
    let angle = 2.0 * PI * f64::from(side % SIDES) / f64::from(SIDES);
    DVec3::new(libm::cos(angle), libm::sin(angle), 0.0)
}

fn sphere() -> Mesh {
    let mut mesh = Mesh::default();
    let top = mesh.corner(DVec3::Z, DVec3::Z);
    for belt in 1..BELTS {
        let angle = PI * f64::from(belt) / f64::from(BELTS);
        for side in 0..SIDES {
            let place = libm::sin(angle) * round(side) + libm::cos(angle) * DVec3::Z;
            mesh.corner(place, place.normalize());
        }
    }
    let bottom = mesh.corner(DVec3::NEG_Z, DVec3::NEG_Z);
    let at = |belt: u32, side: u32| 1 + (belt - 1) * SIDES + side % SIDES;
    for side in 0..SIDES {
        mesh.triangles.push([top, at(1, side), at(1, side + 1)]);
        for belt in 1..BELTS - 1 {
            let (a, b) = (at(belt, side), at(belt, side + 1));
            let (c, d) = (at(belt + 1, side), at(belt + 1, side + 1));
            mesh.triangles.extend([[a, c, d], [a, d, b]]);
        }
        let last = BELTS - 1;
        mesh.triangles
            .push([bottom, at(last, side + 1), at(last, side)]);
    }
    mesh
}

fn cube() -> Mesh {
    let mut mesh = Mesh::default();
    for (normal, across) in [
        (DVec3::X, DVec3::Y),
        (DVec3::Y, DVec3::Z),
        (DVec3::Z, DVec3::X),
    ] {
        for normal in [normal, -normal] {
            let along = normal.cross(across);
            let corner = |u: f64, v: f64| 0.5 * (normal + u * across + v * along);
            let a = mesh.corner(corner(-1.0, -1.0), normal);
            let b = mesh.corner(corner(1.0, -1.0), normal);
            let c = mesh.corner(corner(1.0, 1.0), normal);
            let d = mesh.corner(corner(-1.0, 1.0), normal);
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

fn cylinder() -> Mesh {
    let mut mesh = Mesh::default();
    let half = 0.5 * DVec3::Z;
    for side in 0..SIDES {
        let out = round(side);
        mesh.corner(out - half, out);
        mesh.corner(out + half, out);
    }
    for side in 0..SIDES {
        let (low, high) = (2 * side, 2 * side + 1);
        let next = (low + 2) % (2 * SIDES);
        mesh.triangles
            .extend([[low, next, next + 1], [low, next + 1, high]]);
    }
    for normal in [DVec3::NEG_Z, DVec3::Z] {
        let centre = mesh.corner(0.5 * normal, normal);
        for side in 0..SIDES {
            mesh.corner(round(side) + 0.5 * normal, normal);
        }
        for side in 0..SIDES {
            let (here, next) = (centre + 1 + side, centre + 1 + (side + 1) % SIDES);
            mesh.triangles.push(if normal.z > 0.0 {
                [centre, here, next]
            } else {
                [centre, next, here]
            });
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the divergence theorem, which needs closed surfaces of outward triangles.
    fn volume(mesh: &Mesh) -> f64 {
        let corners = |triangle: &[u32; 3]| triangle.map(|place| mesh.positions[place as usize]);
        let parts = mesh.triangles.iter().map(corners);
        parts.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    #[test]
    fn volumes_are_those_of_inscribed_solids_and_normals_point_outward() {
        let polygon = 0.5 * f64::from(SIDES) * libm::sin(2.0 * PI / f64::from(SIDES));
        assert!((volume(&cube()) - 1.0).abs() < 1e-14);
        assert!((volume(&cylinder()) - polygon).abs() < 1e-14);
        // Frusta of that polygon between circles of latitude, h / 3 (A + B + sqrt(A B)).
        let belts = (0..BELTS).map(|belt| {
            let angle = |belt: u32| PI * f64::from(belt) / f64::from(BELTS);
            let (upper, lower) = (angle(belt), angle(belt + 1));
            let (a, b) = (libm::sin(upper), libm::sin(lower));
            let height = libm::cos(upper) - libm::cos(lower);
            polygon * height / 3.0 * (a * a + b * b + a * b)
        });
        assert!((volume(&sphere()) - belts.sum::<f64>()).abs() < 1e-14);
        for mesh in [sphere(), cube(), cylinder()] {
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|place| mesh.positions[place as usize]);
                let outward = (b - a).cross(c - a).normalize();
                for place in triangle {
                    let normal = mesh.normals[*place as usize];
                    assert!((normal.length() - 1.0).abs() < 1e-15);
                    assert!(normal.dot(outward) > 0.8);
                }
            }
        }
    }
}
