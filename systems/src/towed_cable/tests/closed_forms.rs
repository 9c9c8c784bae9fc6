//! Shapes that can be written down.

use std::f64::consts::PI;

use super::super::{Conditions, Line, TowedCable};
use super::{GRAVITY_M_S2, assert_near, plain, uniform};

/// Elongation g L (m + m' L / 2) / EA, tension linear along the line.
#[test]
fn without_wind_it_hangs_straight_and_stretches() {
    let mut cable = plain();
    cable.line.mass_per_length_kg_m = 0.005;
    cable.line.axial_stiffness_n = 2e5;
    cable.line.normal_drag = 1.0;
    cable.body.mass_kg = 20.0;
    let shape = cable.solve(&uniform(1.3, 0.0), &[250.0]).unwrap();
    assert_near(shape.depth_m, 1_000.997_875, 1e-8);
    assert_near(shape.top.tension_n, 221.75, 1e-10);
    assert_near(shape.body.x_m, 0.0, 0.0);
    assert_near(
        shape.points[0].tension_n,
        GRAVITY_M_S2 * (20.0 + 0.005 * 750.0),
        1e-10,
    );
    assert_near(shape.points[0].angle_rad, 0.0, 0.0);
}

/// q = 1/2 rho C_n d u^2 across a weightless line keeps the tension W and gives tan phi = q s / W:
/// z = W/q asinh(q s / W), x = W/q (sqrt(1 + (q s / W)^2) - 1).
#[test]
fn drag_across_a_weightless_line_bends_it_to_a_catenary_on_its_side() {
    let mut cable = plain();
    cable.line.normal_drag = 1.1;
    for wind in [3.0, 20.0, -20.0, 80.0] {
        let weight = 4.0 * GRAVITY_M_S2;
        let q = 0.5 * 1.3 * 1.1 * 0.002 * wind * wind;
        let shape = cable.solve(&uniform(1.3, wind), &[600.0]).unwrap();
        let slope = q * 1000.0 / weight;
        let x = weight / q * ((1.0 + slope * slope).sqrt() - 1.0) * f64::signum(wind);
        assert_near(shape.depth_m, weight / q * slope.asinh(), 1e-8);
        assert_near(shape.body.x_m, x, 1e-8);
        assert_near(shape.top.tension_n, weight, 1e-9);
        assert_near(shape.points[0].angle_rad.abs(), (0.4 * slope).atan(), 1e-11);
    }
}

/// The elastic catenary under the drag H of the body (Irvine 1981, sec. 2.4): with w = m' g,
/// x = H/w (asinh((W + w L)/H) - asinh(W/H)) + H L / EA,
/// z = H/w (sqrt(1 + ((W + w L)/H)^2) - sqrt(1 + (W/H)^2)) + (W L + w L^2 / 2) / EA.
#[test]
fn a_body_with_drag_hangs_a_line_without_in_an_elastic_catenary() {
    for stiffness in [f64::INFINITY, 3e3] {
        let mut cable = plain();
        cable.line.mass_per_length_kg_m = 0.01;
        cable.line.axial_stiffness_n = stiffness;
        cable.body.drag_area_m2 = 0.7;
        let (w, length) = (0.01 * GRAVITY_M_S2, 1000.0);
        let weight = 4.0 * GRAVITY_M_S2;
        let pull = 0.5 * 1.3 * 0.7 * 12.0 * 12.0;
        let (low, high) = (weight / pull, (weight + w * length) / pull);
        let x = pull / w * (high.asinh() - low.asinh()) + pull * length / stiffness;
        let z = pull / w * (1.0_f64.hypot(high) - 1.0_f64.hypot(low))
            + (weight * length + 0.5 * w * length * length) / stiffness;
        let shape = cable.solve(&uniform(1.3, 12.0), &[]).unwrap();
        assert_near(shape.body.x_m, x, 1e-8);
        assert_near(shape.depth_m, z, 1e-8);
        assert_near(shape.top.tension_n, pull.hypot(weight + w * length), 1e-9);
    }
}

/// Far up a long line phi tends to where q cos^2 phi = m' g sin phi, and the drag along the line adds
/// up in the tension.
#[test]
fn a_long_line_in_a_storm_lies_at_its_critical_angle() {
    let mut cable = plain();
    cable.line.length_m = 20_000.0;
    cable.line.mass_per_length_kg_m = 3e-3;
    cable.line.normal_drag = 1.0;
    let shape = cable.solve(&uniform(1.3, 40.0), &[]).unwrap();
    let (q, w) = (0.5 * 1.3 * 0.002 * 1600.0, 3e-3 * GRAVITY_M_S2);
    let sin = (-w + (w * w + 4.0 * q * q).sqrt()) / (2.0 * q);
    assert_near(shape.top.angle_rad, sin.asin(), 1e-9);
    assert!(shape.top.angle_rad > 1.4);
    let cable = TowedCable {
        line: Line {
            tangential_drag: 0.03,
            ..cable.line
        },
        ..cable
    };
    let rubbed = cable.solve(&uniform(1.3, 40.0), &[]).unwrap();
    let rub_n_m = PI * 0.03 * q * sin * sin;
    let added = (rubbed.top.tension_n - shape.top.tension_n) / (rub_n_m * 20_000.0);
    assert!((added - 1.0).abs() < 0.03, "{added}");
}

/// g0 (R / (R + z))^2 on an inextensible line: the weight is the difference of potential.
#[test]
fn gravity_may_fall_with_altitude() {
    let mut cable = plain();
    cable.line.mass_per_length_kg_m = 0.01;
    let radius = 6_051_800.0;
    let gravity = |z: f64| GRAVITY_M_S2 * (radius / (radius + z)).powi(2);
    let surroundings = |z: f64| {
        Some(Conditions {
            density_kg_m3: 0.0,
            wind_m_s: 0.0,
            gravity_m_s2: gravity(z),
        })
    };
    let shape = cable.solve(&surroundings, &[]).unwrap();
    let potential = |z: f64| GRAVITY_M_S2 * radius * z / (radius + z);
    let line = 0.01 * (potential(52_000.0) - potential(51_000.0));
    assert_near(shape.top.tension_n, 4.0 * gravity(51_000.0) + line, 1e-9);
}

/// The wind blows towards -x above 51 300 m and towards +x below: the line leans one way and then
/// the other, and what the air does to the line is what the two ends pull on it.
#[test]
fn a_wind_that_turns_round_bends_the_line_to_an_s() {
    let mut cable = plain();
    cable.line.mass_per_length_kg_m = 0.005;
    cable.line.normal_drag = 1.0;
    cable.line.tangential_drag = 0.03;
    cable.body.drag_area_m2 = 2.0;
    let sheared = |sign: f64| {
        move |z: f64| {
            Some(Conditions {
                density_kg_m3: 1.3,
                wind_m_s: sign * 0.01 * (51_300.0 - z),
                gravity_m_s2: GRAVITY_M_S2,
            })
        }
    };
    let places: Vec<f64> = (0..=1000).map(f64::from).collect();
    let shape = cable.solve(&sheared(1.0), &places).unwrap();
    let turns = shape
        .points
        .windows(2)
        .filter(|pair| pair[0].angle_rad * pair[1].angle_rad <= 0.0);
    assert_eq!(turns.count(), 1);
    assert!(shape.body.angle_rad > 0.1 && shape.top.angle_rad < -0.01);
    let mirrored = cable.solve(&sheared(-1.0), &places).unwrap();
    assert_near(mirrored.body.x_m, -shape.body.x_m, 1e-8);
    assert_near(mirrored.body.z_m, shape.body.z_m, 1e-8);
    // Simpson's rule over the drag, horizontal and vertical.
    let u = 0.01 * (51_300.0 - shape.body.z_m);
    let (mut across_n, mut up_n) = (0.5 * 1.3 * 2.0 * u * u.abs(), 0.0);
    for (place, point) in shape.points.iter().enumerate() {
        let weight = match place {
            0 | 1000 => 1.0,
            odd if odd % 2 == 1 => 4.0,
            _ => 2.0,
        } / 3.0;
        let u = 0.01 * (51_300.0 - point.z_m);
        let q = 0.5 * 1.3 * 0.002 * u * u.abs();
        let (sin, cos) = point.angle_rad.sin_cos();
        let (normal, along) = (q * cos * cos.abs(), PI * 0.03 * q * sin * sin.abs());
        across_n += weight * (normal * cos + along * sin);
        up_n += weight * (normal * sin - along * cos);
    }
    let (sin, cos) = shape.top.angle_rad.sin_cos();
    assert_near(shape.top.tension_n * sin, across_n, 1e-7);
    assert_near(shape.top.tension_n * cos, 9.0 * GRAVITY_M_S2 - up_n, 1e-7);
}

/// Lift above the weight stands the line upright above its top, as a kite balloon's.
#[test]
fn a_body_lighter_than_air_is_towed_upwards() {
    let mut cable = plain();
    cable.line.mass_per_length_kg_m = 1e-3;
    cable.body.displaced_volume_m3 = 8.0;
    let still = cable.solve(&uniform(1.3, 0.0), &[]).unwrap();
    assert_near(still.depth_m, -1000.0, 1e-8);
    let lift = (1.3 * 8.0 - 4.0) * GRAVITY_M_S2;
    assert_near(still.top.tension_n, lift - GRAVITY_M_S2, 1e-9);
    cable.body.drag_area_m2 = 1.0;
    let blown = cable.solve(&uniform(1.3, 6.0), &[]).unwrap();
    assert!(blown.depth_m < -500.0 && blown.body.x_m > 300.0);
}
