//! Inertia of a body: named shapes and the full tensor.
//!
//! Solid sphere 2/5 m r^2; thin sphere 2/3 m r^2; solid cylinder m/2 r^2 about its axis z and
//! m/12 (3 r^2 + h^2) across; hollow cylinder m/2 (r_e^2 + r_i^2) and m/12 (3 (r_e^2 + r_i^2) + h^2);
//! box m/12 (b^2 + c^2) and so on; slender rod along z m l^2/12 across, nothing about itself
//! (Goldstein, Poole and Safko 2002, ch. 5).

use glam::{DMat3, DVec3};
use serde::Deserialize;

use crate::scene_component::FieldReport;

/// How the mass of a body is spread.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq)]
#[serde(rename = "inertia", deny_unknown_fields)]
pub enum InertiaShape {
    /// A point: it has no attitude, and tethers attach at its centre.
    #[default]
    Point,
    /// A solid sphere of the radius that the entity's `Sphere` has.
    SolidSphere,
    /// A thin spherical shell of the radius that the entity's `Sphere` has.
    ThinSphere,
    /// A solid cylinder about the body's z axis.
    SolidCylinder {
        /// Radius, m.
        radius_m: f64,
        /// Height along z, m.
        height_m: f64,
    },
    /// A hollow cylinder about the body's z axis.
    HollowCylinder {
        /// Outer radius, m.
        outer_radius_m: f64,
        /// Inner radius, m.
        inner_radius_m: f64,
        /// Height along z, m.
        height_m: f64,
    },
    /// A solid box with edges along the body's x, y and z, m.
    Box(f64, f64, f64),
    /// A slender rod along the body's z axis.
    Rod {
        /// Length, m.
        length_m: f64,
    },
    /// The full symmetric tensor in the body frame, kg m^2.
    Tensor {
        /// Moment about x, kg m^2.
        xx_kg_m2: f64,
        /// Moment about y, kg m^2.
        yy_kg_m2: f64,
        /// Moment about z, kg m^2.
        zz_kg_m2: f64,
        /// Element xy of the tensor (minus the product of inertia), kg m^2.
        #[serde(default)]
        xy_kg_m2: f64,
        /// Element xz of the tensor, kg m^2.
        #[serde(default)]
        xz_kg_m2: f64,
        /// Element yz of the tensor, kg m^2.
        #[serde(default)]
        yz_kg_m2: f64,
    },
}

impl InertiaShape {
    /// The tensor in kg m^2 for a mass in kg and the radius in m of the entity's sphere;
    /// `None` for a point.
    #[must_use]
    pub fn tensor(&self, mass_kg: f64, sphere_radius_m: f64) -> Option<DMat3> {
        let m = mass_kg;
        let diagonal = match *self {
            Self::Point => return None,
            Self::SolidSphere => DVec3::splat(0.4 * m * sphere_radius_m * sphere_radius_m),
            Self::ThinSphere => DVec3::splat(2.0 / 3.0 * m * sphere_radius_m * sphere_radius_m),
            Self::SolidCylinder { radius_m, height_m } => cylinder(m, radius_m, 0.0, height_m),
            Self::HollowCylinder {
                outer_radius_m,
                inner_radius_m,
                height_m,
            } => cylinder(m, outer_radius_m, inner_radius_m, height_m),
            Self::Box(a, b, c) => {
                m / 12.0 * DVec3::new(b * b + c * c, a * a + c * c, a * a + b * b)
            }
            Self::Rod { length_m } => {
                let across = m * length_m * length_m / 12.0;
                // A rod has no inertia about itself; the trace of it keeps the tensor invertible.
                DVec3::new(across, across, 1e-6 * across)
            }
            Self::Tensor {
                xx_kg_m2,
                yy_kg_m2,
                zz_kg_m2,
                xy_kg_m2,
                xz_kg_m2,
                yz_kg_m2,
            } => {
                return Some(DMat3::from_cols(
                    DVec3::new(xx_kg_m2, xy_kg_m2, xz_kg_m2),
                    DVec3::new(xy_kg_m2, yy_kg_m2, yz_kg_m2),
                    DVec3::new(xz_kg_m2, yz_kg_m2, zz_kg_m2),
                ));
            }
        };
        Some(DMat3::from_diagonal(diagonal))
    }

    /// Whether the radius is taken from the entity's `Sphere`.
    #[must_use]
    pub fn needs_sphere(&self) -> bool {
        matches!(self, Self::SolidSphere | Self::ThinSphere)
    }

    /// Half the height of the shape along the body's z axis, m, where the shape has one.
    #[must_use]
    pub fn half_height_m(&self) -> Option<f64> {
        match *self {
            Self::SolidCylinder { height_m, .. } | Self::HollowCylinder { height_m, .. } => {
                Some(0.5 * height_m)
            }
            Self::Box(_, _, c) => Some(0.5 * c),
            Self::Rod { length_m } => Some(0.5 * length_m),
            _ => None,
        }
    }

    /// Reports dimensions that are not positive and tensors that no mass distribution has.
    pub fn check(&self, report: &mut FieldReport) {
        match *self {
            Self::SolidCylinder { radius_m, height_m } => {
                report.positive("radius_m", radius_m);
                report.positive("height_m", height_m);
            }
            Self::HollowCylinder {
                outer_radius_m,
                inner_radius_m,
                height_m,
            } => {
                report.positive("outer_radius_m", outer_radius_m);
                report.non_negative("inner_radius_m", inner_radius_m);
                report.positive("height_m", height_m);
                if inner_radius_m >= outer_radius_m {
                    report.add(
                        "inner_radius_m",
                        format!(
                            "`inner_radius_m` ({inner_radius_m}) must be below `outer_radius_m` \
                             ({outer_radius_m})"
                        ),
                        "",
                    );
                }
            }
            Self::Box(a, b, c) => {
                for (index, edge) in ["0", "1", "2"].into_iter().zip([a, b, c]) {
                    if !(edge.is_finite() && edge > 0.0) {
                        report.add(
                            index,
                            format!("an edge must be above zero, it is {edge}"),
                            "",
                        );
                    }
                }
            }
            Self::Rod { length_m } => report.positive("length_m", length_m),
            Self::Tensor { .. } => self.check_tensor(report),
            Self::Point | Self::SolidSphere | Self::ThinSphere => {}
        }
    }

    /// A tensor of inertia is positive definite and its principal moments obey the triangle
    /// inequality: both hold if and only if tr(J)/2 I - J (the second moments of the mass) is
    /// positive semi-definite and J itself is positive definite.
    fn check_tensor(&self, report: &mut FieldReport) {
        let Some(tensor) = self.tensor(1.0, 1.0) else {
            return;
        };
        if !tensor.is_finite() {
            report.add("", "the tensor must consist of finite numbers", "");
            return;
        }
        let trace = tensor.x_axis.x + tensor.y_axis.y + tensor.z_axis.z;
        let second_moments = DMat3::from_diagonal(DVec3::splat(0.5 * trace)) - tensor;
        if !is_positive_definite(tensor, 0.0)
            || !is_positive_definite(second_moments, 1e-12 * trace.abs())
        {
            report.add(
                "",
                "no body has this tensor of inertia",
                "it must be positive definite, and no principal moment may exceed the sum of the \
                 other two",
            );
        }
    }
}

fn cylinder(mass: f64, outer: f64, inner: f64, height: f64) -> DVec3 {
    let squares = outer * outer + inner * inner;
    let across = mass / 12.0 * (3.0 * squares + height * height);
    DVec3::new(across, across, 0.5 * mass * squares)
}

/// Leading minors of a symmetric matrix, shifted up by `slack` on its diagonal.
fn is_positive_definite(matrix: DMat3, slack: f64) -> bool {
    let shifted = matrix + DMat3::from_diagonal(DVec3::splat(slack));
    let first = shifted.x_axis.x;
    let second = first * shifted.y_axis.y - shifted.x_axis.y * shifted.x_axis.y;
    first > 0.0 && second > 0.0 && shifted.determinant() > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hollow_cylinder_of_the_yaw_study() {
        let shape = InertiaShape::HollowCylinder {
            outer_radius_m: 2.1,
            inner_radius_m: 1.3,
            height_m: 0.2,
        };
        let tensor = shape.tensor(20.0, 0.0).unwrap();
        assert!((tensor.z_axis.z - 61.0).abs() < 1e-12);
        assert!((tensor.x_axis.x - 30.566_666_666_666_67).abs() < 1e-12);
    }

    #[test]
    fn shapes_agree_where_they_meet() {
        let solid = InertiaShape::SolidCylinder {
            radius_m: 0.7,
            height_m: 1.3,
        };
        let hollow = InertiaShape::HollowCylinder {
            outer_radius_m: 0.7,
            inner_radius_m: 0.0,
            height_m: 1.3,
        };
        assert_eq!(solid.tensor(3.0, 0.0), hollow.tensor(3.0, 0.0));
        let cube = InertiaShape::Box(2.0, 2.0, 2.0).tensor(6.0, 0.0).unwrap();
        assert!((cube.x_axis.x - 4.0).abs() < 1e-15 && (cube.z_axis.z - 4.0).abs() < 1e-15);
    }

    #[test]
    fn impossible_tensors_are_reported() {
        let tensor = |xx, yy, zz| InertiaShape::Tensor {
            xx_kg_m2: xx,
            yy_kg_m2: yy,
            zz_kg_m2: zz,
            xy_kg_m2: 0.0,
            xz_kg_m2: 0.0,
            yz_kg_m2: 0.0,
        };
        for (shape, problems) in [
            (tensor(1.0, 2.0, 2.5), 0),
            (tensor(1.0, 1.0, 2.5), 1),
            (tensor(-1.0, 1.0, 1.0), 1),
        ] {
            let mut report = FieldReport::new("");
            shape.check(&mut report);
            assert_eq!(report.into_violations().len(), problems, "{shape:?}");
        }
    }
}
