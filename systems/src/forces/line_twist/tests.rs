use std::f64::consts::{PI, TAU};

use glam::DQuat;

use super::*;
use crate::dynamics::rotation_chart::exponential;
use crate::nonlinear_solver::test_support::Random;

/// Everything that the twist depends on: attitudes of the two bodies and the points.
#[derive(Clone)]
struct Line {
    attitudes: [DQuat; 2],
    points_m: Vec<DVec3>,
}

/// Axes and directions across them in the frames of the bodies.
const AXES: [DVec3; 2] = [DVec3::NEG_Z, DVec3::X];
const ACROSS: [DVec3; 2] = [DVec3::Y, DVec3::Z];

impl Line {
    fn crooked(random: &mut Random) -> Self {
        let mut vector = || DVec3::new(random.signed(), random.signed(), random.signed());
        let mut place = vector();
        let mut points_m = vec![place];
        for _ in 0..5 {
            place += DVec3::new(0.3, 0.0, -1.0) + 0.7 * vector();
            points_m.push(place);
        }
        Self {
            attitudes: [exponential(0.4 * vector()), exponential(0.4 * vector())],
            points_m,
        }
    }

    fn held(&self, end: usize, rate_rad_s: DVec3) -> HeldEnd {
        HeldEnd {
            axis: self.attitudes[end] * AXES[end],
            across: self.attitudes[end] * ACROSS[end],
            rate_rad_s,
        }
    }

    fn twist(&self, motion: &Motion, gradient: &mut Vec<DVec3>) -> LineTwist {
        line_twist(
            &self.held(0, motion.rates[0]),
            &self.held(1, motion.rates[1]),
            &self.points_m,
            &motion.velocities,
            gradient,
        )
    }

    fn angle(&self) -> f64 {
        self.twist(&Motion::none(self.points_m.len()), &mut Vec::new())
            .angle_rad
    }

    /// Where a motion has taken it after a time in s.
    fn moved(&self, motion: &Motion, time_s: f64) -> Self {
        let points = self.points_m.iter().zip(&motion.velocities);
        Self {
            attitudes: [0, 1]
                .map(|end| exponential(time_s * motion.rates[end]) * self.attitudes[end]),
            points_m: points
                .map(|(point, velocity)| *point + time_s * *velocity)
                .collect(),
        }
    }
}

#[derive(Clone)]
struct Motion {
    rates: [DVec3; 2],
    velocities: Vec<DVec3>,
}

impl Motion {
    fn none(points: usize) -> Self {
        Self {
            rates: [DVec3::ZERO; 2],
            velocities: vec![DVec3::ZERO; points],
        }
    }

    fn random(points: usize, random: &mut Random) -> Self {
        let mut vector = || DVec3::new(random.signed(), random.signed(), random.signed());
        Self {
            rates: [vector(), vector()],
            velocities: (0..points).map(|_| vector()).collect(),
        }
    }
}

/// The rate, by which all torques and forces follow as well, is that of the angle: central differences.
#[test]
fn the_rate_is_that_of_the_angle() {
    let mut random = Random::new(7);
    for case in 0..20 {
        let line = Line::crooked(&mut random);
        let motion = Motion::random(line.points_m.len(), &mut random);
        let rate = line.twist(&motion, &mut Vec::new()).rate_rad_s;
        let h = 1e-5;
        let ahead = line.moved(&motion, h).angle();
        let change = with_turns(ahead, 0.0) - with_turns(line.moved(&motion, -h).angle(), ahead);
        let difference = change / (2.0 * h);
        assert!(
            (rate - difference).abs() < 1e-7 * (1.0 + rate.abs()),
            "case {case}: {rate} {difference}"
        );
    }
}

/// What the line does as one piece neither twists it nor would leave a torque.
#[test]
fn a_rigid_motion_does_not_twist() {
    let mut random = Random::new(8);
    let line = Line::crooked(&mut random);
    let (rate, velocity) = (DVec3::new(0.3, -1.2, 0.7), DVec3::new(4.0, 1.0, -2.0));
    let motion = Motion {
        rates: [rate; 2],
        velocities: line
            .points_m
            .iter()
            .map(|point| velocity + rate.cross(*point))
            .collect(),
    };
    let found = line.twist(&motion, &mut Vec::new()).rate_rad_s;
    assert!(found.abs() < 1e-13, "{found}");
}

/// A body that turns about a straight line twists it by its turn, at whatever angle it holds the line.
#[test]
fn a_turn_about_a_straight_line_is_its_twist() {
    let points_m = vec![
        DVec3::ZERO,
        DVec3::new(0.6, 0.0, -0.8),
        DVec3::new(1.8, 0.0, -2.4),
    ];
    let straight = Line {
        attitudes: [DQuat::IDENTITY; 2],
        points_m,
    };
    let along = DVec3::new(0.6, 0.0, -0.8);
    let start = straight.angle();
    for turn_rad in [0.3, 1.2, -2.5, 3.0] {
        let mut turned = straight.clone();
        turned.attitudes[1] = exponential(turn_rad * along);
        let twist = with_turns(turned.angle() - start, turn_rad);
        assert!((twist - turn_rad).abs() < 1e-13, "{twist} {turn_rad}");
        let mut both = turned;
        both.attitudes[0] = exponential(turn_rad * along);
        assert!(with_turns(both.angle() - start, 0.0).abs() < 1e-13);
    }
}

/// One turn of a helix of pitch angle beta: its tangents go once around a circle of the sphere, and what is
/// carried comes back turned by the area that they enclose, 2 pi (1 - sin beta) (Fuller 1978). The chords
/// of the polyline lie on such a circle too, and great circles join them: the area of a regular polygon on
/// the sphere.
#[test]
fn a_turn_of_a_helix_carries_by_the_area_of_its_tangents() {
    let (radius_m, pitch_m) = (2.0, 9.0);
    let mut errors = Vec::new();
    for segments in [24, 48] {
        let step = TAU / f64::from(segments);
        // One segment more, so that the first and the last point the same way.
        let points_m: Vec<DVec3> = (0..=segments + 1)
            .map(|k| {
                let angle = step * f64::from(k);
                let (sine, cosine) = libm::sincos(angle);
                DVec3::new(radius_m * cosine, radius_m * sine, pitch_m * angle / TAU)
            })
            .collect();
        let axis = (points_m[1] - points_m[0]).normalize();
        let across = axis.any_orthonormal_vector();
        let end = HeldEnd {
            axis,
            across,
            rate_rad_s: DVec3::ZERO,
        };
        let still = vec![DVec3::ZERO; points_m.len()];
        let found = line_twist(&end, &end, &points_m, &still, &mut Vec::new()).angle_rad;
        // Polygon: with the polar angle theta of its corners, the triangles at the pole have the sides
        // theta, theta and the angle `step` between them, and the other angles alpha.
        let cosine = axis.z;
        let alpha = libm::atan(1.0 / (cosine * libm::tan(0.5 * step)));
        let area = f64::from(segments) * (step + 2.0 * alpha - PI);
        let exact = with_turns(found.abs(), area);
        assert!((exact - area).abs() < 1e-11, "{segments}: {exact} {area}");
        let sin_beta = pitch_m / (pitch_m * pitch_m + (TAU * radius_m).powi(2)).sqrt();
        errors.push((area - TAU * (1.0 - sin_beta)).abs());
    }
    let order = (errors[0] / errors[1]).log2();
    assert!((order - 2.0).abs() < 0.05, "{errors:?}");
}

/// Segments of no length change nothing, and opposite directions make no number that is none.
#[test]
fn degenerate_lines_are_survived() {
    let mut random = Random::new(9);
    let line = Line::crooked(&mut random);
    let mut doubled = line.clone();
    doubled.points_m.insert(2, line.points_m[2]);
    assert!((line.angle() - doubled.angle()).abs() < 1e-15);
    let end = HeldEnd {
        axis: DVec3::Z,
        across: DVec3::X,
        rate_rad_s: DVec3::ZERO,
    };
    let folded = [DVec3::ZERO, DVec3::Z, DVec3::ZERO];
    let mut gradient = Vec::new();
    let twist = line_twist(&end, &end, &folded, &[DVec3::ZERO; 3], &mut gradient);
    assert!(twist.angle_rad.is_finite() && gradient.iter().all(|g| g.is_finite()));
}
