//! Symmetric 3x3 matrices: six numbers, no branches.

use glam::{DMat3, DVec3};

/// A symmetric 3x3 matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric3 {
    /// Row 1, column 1.
    pub xx: f64,
    /// Row 1, column 2.
    pub xy: f64,
    /// Row 1, column 3.
    pub xz: f64,
    /// Row 2, column 2.
    pub yy: f64,
    /// Row 2, column 3.
    pub yz: f64,
    /// Row 3, column 3.
    pub zz: f64,
}

impl Symmetric3 {
    /// `scale` times the identity.
    #[inline(always)]
    #[must_use]
    pub fn identity(scale: f64) -> Self {
        Self {
            xx: scale,
            yy: scale,
            zz: scale,
            ..Self::default()
        }
    }

    /// The symmetric part of a matrix.
    #[inline(always)]
    #[must_use]
    pub fn part_of(m: DMat3) -> Self {
        Self {
            xx: m.x_axis.x,
            xy: 0.5 * (m.x_axis.y + m.y_axis.x),
            xz: 0.5 * (m.x_axis.z + m.z_axis.x),
            yy: m.y_axis.y,
            yz: 0.5 * (m.y_axis.z + m.z_axis.y),
            zz: m.z_axis.z,
        }
    }

    /// `along t t' + all I`.
    #[inline(always)]
    #[must_use]
    pub fn along(t: DVec3, along: f64, all: f64) -> Self {
        let s = t * along;
        Self {
            xx: s.x * t.x + all,
            xy: s.x * t.y,
            xz: s.x * t.z,
            yy: s.y * t.y + all,
            yz: s.y * t.z,
            zz: s.z * t.z + all,
        }
    }

    /// `self + other`.
    #[inline(always)]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        self.plus_scaled(other, 1.0)
    }

    /// `self + scale other`.
    #[inline(always)]
    #[must_use]
    pub fn plus_scaled(self, other: Self, scale: f64) -> Self {
        Self {
            xx: self.xx + scale * other.xx,
            xy: self.xy + scale * other.xy,
            xz: self.xz + scale * other.xz,
            yy: self.yy + scale * other.yy,
            yz: self.yz + scale * other.yz,
            zz: self.zz + scale * other.zz,
        }
    }

    /// `scale self`.
    #[inline(always)]
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        Self::default().plus_scaled(self, scale)
    }

    /// The determinant.
    #[inline(always)]
    #[must_use]
    pub fn determinant(&self) -> f64 {
        self.xx * (self.yy * self.zz - self.yz * self.yz)
            + self.xy * (self.xz * self.yz - self.xy * self.zz)
            + self.xz * (self.xy * self.yz - self.xz * self.yy)
    }

    /// `-[h] self [h]`, with `[h]` the cross-product matrix: `x'` times it times `y` is
    /// `(x x h).self (y x h)`.
    #[inline(always)]
    #[must_use]
    pub fn between_crosses(&self, h: DVec3) -> Self {
        // Rows of [h]': x x h for the unit vectors x.
        let (x, y, z) = (
            DVec3::new(0.0, -h.z, h.y),
            DVec3::new(h.z, 0.0, -h.x),
            DVec3::new(-h.y, h.x, 0.0),
        );
        let (sx, sy, sz) = (self.times(x), self.times(y), self.times(z));
        Self {
            xx: x.dot(sx),
            xy: x.dot(sy),
            xz: x.dot(sz),
            yy: y.dot(sy),
            yz: y.dot(sz),
            zz: z.dot(sz),
        }
    }

    /// The product with another symmetric matrix.
    #[inline(always)]
    #[must_use]
    pub fn by(&self, other: &Self) -> DMat3 {
        DMat3::from_cols(
            self.times(DVec3::new(other.xx, other.xy, other.xz)),
            self.times(DVec3::new(other.xy, other.yy, other.yz)),
            self.times(DVec3::new(other.xz, other.yz, other.zz)),
        )
    }

    /// The product `g f` where it is known to be symmetric.
    #[inline(always)]
    #[must_use]
    pub fn product(g: &DMat3, f: &Self) -> Self {
        let (a, b, c) = (g.x_axis, g.y_axis, g.z_axis);
        Self {
            xx: a.x * f.xx + b.x * f.xy + c.x * f.xz,
            xy: a.x * f.xy + b.x * f.yy + c.x * f.yz,
            xz: a.x * f.xz + b.x * f.yz + c.x * f.zz,
            yy: a.y * f.xy + b.y * f.yy + c.y * f.yz,
            yz: a.y * f.xz + b.y * f.yz + c.y * f.zz,
            zz: a.z * f.xz + b.z * f.yz + c.z * f.zz,
        }
    }

    /// The product with a vector.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, v: DVec3) -> DVec3 {
        DVec3::new(
            self.xx * v.x + self.xy * v.y + self.xz * v.z,
            self.xy * v.x + self.yy * v.y + self.yz * v.z,
            self.xz * v.x + self.yz * v.y + self.zz * v.z,
        )
    }

    /// The inverse of a positive definite matrix, with the leading minors that were met: the matrix
    /// is positive definite if all three are positive.
    #[inline(always)]
    #[must_use]
    pub fn inverse(&self) -> (Self, bool) {
        let cofactor_xx = self.yy * self.zz - self.yz * self.yz;
        let cofactor_xy = self.xz * self.yz - self.xy * self.zz;
        let cofactor_xz = self.xy * self.yz - self.xz * self.yy;
        let minor = self.xx * self.yy - self.xy * self.xy;
        let determinant = self.xx * cofactor_xx + self.xy * cofactor_xy + self.xz * cofactor_xz;
        let positive = self.xx > 0.0 && minor > 0.0 && determinant > 0.0;
        let scale = 1.0 / determinant;
        let inverse = Self {
            xx: scale * cofactor_xx,
            xy: scale * cofactor_xy,
            xz: scale * cofactor_xz,
            yy: scale * (self.xx * self.zz - self.xz * self.xz),
            yz: scale * (self.xy * self.xz - self.xx * self.yz),
            zz: scale * minor,
        };
        (inverse, positive)
    }
}

impl From<Symmetric3> for DMat3 {
    #[inline(always)]
    fn from(s: Symmetric3) -> Self {
        Self::from_cols(
            DVec3::new(s.xx, s.xy, s.xz),
            DVec3::new(s.xy, s.yy, s.yz),
            DVec3::new(s.xz, s.yz, s.zz),
        )
    }
}
