//! The static cable against closed forms and against values of a separate program.

use std::f64::consts::PI;

use super::{Conditions, Line, StaticShape, TowedBody, TowedCable, TowedCableError};

const GRAVITY_M_S2: f64 = 8.87;

fn uniform(density_kg_m3: f64, wind_m_s: f64) -> impl Fn(f64) -> Option<Conditions> {
    move |_| {
        Some(Conditions {
            density_kg_m3,
            wind_m_s,
            gravity_m_s2: GRAVITY_M_S2,
        })
    }
}

/// Nothing but a weight on a weightless line without drag or stretch.
fn plain() -> TowedCable {
    TowedCable {
        line: Line {
            length_m: 1000.0,
            mass_per_length_kg_m: 0.0,
            diameter_m: 0.002,
            axial_stiffness_n: f64::INFINITY,
            normal_drag: 0.0,
            tangential_drag: 0.0,
        },
        body: TowedBody {
            mass_kg: 4.0,
            drag_area_m2: 0.0,
            displaced_volume_m3: 0.0,
        },
        top_altitude_m: 52_000.0,
    }
}

#[track_caller]
fn assert_near(actual: f64, expected: f64, tolerance: f64) {
    let error = (actual - expected).abs();
    assert!(
        error <= tolerance,
        "{actual}, expected {expected}: {error:e}"
    );
}

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

/// Young's modulus of Zylon, Pa.
const ZYLON_PA: f64 = 180e9;

/// The towline of the paper (sec. 5.1), 2.3 kg of Zylon of 1560 kg/m^3, in an exponential atmosphere
/// and in a shear that blows with `speed_m_s` at the depth of the straight line.
fn towline(speed_m_s: f64, modulus_pa: f64, from_top_m: &[f64]) -> StaticShape {
    let section_m2 = 2.3 / (1560.0 * 9700.0);
    let cable = TowedCable {
        line: Line {
            length_m: 9700.0,
            mass_per_length_kg_m: 2.3 / 9700.0,
            diameter_m: (4.0 * section_m2 / PI).sqrt(),
            axial_stiffness_n: modulus_pa * section_m2,
            normal_drag: 1.0,
            tangential_drag: 0.03,
        },
        body: TowedBody {
            mass_kg: 4.0,
            drag_area_m2: 0.47 * PI * 0.05 * 0.05,
            displaced_volume_m3: 0.0,
        },
        top_altitude_m: 52_000.0,
    };
    let air = move |z: f64| {
        Some(Conditions {
            density_kg_m3: 1.594 * (-(z - 50_000.0) / 7000.0).exp(),
            wind_m_s: speed_m_s * (52_000.0 - z) / 9700.0,
            gravity_m_s2: GRAVITY_M_S2,
        })
    };
    cable.solve(&air, from_top_m).unwrap()
}

/// A separate program printed these to a millimetre and to 1e-4 N.
#[test]
fn the_towline_of_the_paper_ends_where_a_separate_program_ends_it() {
    for (speed, modulus, x, z, tension) in [
        (5.0, ZYLON_PA, 4906.649, 43_714.633, 53.4911),
        (10.0, ZYLON_PA, 6939.230, 45_413.413, 51.9502),
        (5.0, f64::INFINITY, 4886.936, 43_720.870, 53.5010),
        (10.0, f64::INFINITY, 6920.934, 45_416.559, 51.9527),
    ] {
        let shape = towline(speed, modulus, &[]);
        println!("{speed} m/s, E {modulus} Pa: {:?}", (shape.body, shape.top));
        assert_near(shape.body.x_m, x, 5.1e-4);
        assert_near(shape.body.z_m, z, 5.1e-4);
        assert_near(shape.top.tension_n, tension, 5.1e-5);
        assert_near(shape.top.z_m, 52_000.0, 1e-8);
        assert_near(shape.top.x_m, 0.0, 0.0);
    }
}

/// Rows of the same program along the line: arc length from the top, x, z, T, degrees.
#[test]
fn the_towline_of_the_paper_has_the_shape_that_a_separate_program_gives_it() {
    for (speed, rows) in [(5.0, V5), (10.0, V10)] {
        let places = rows.map(|row| row[0]);
        let shape = towline(speed, ZYLON_PA, &places);
        let mut worst = [0.0_f64; 3];
        for (row, point) in rows.iter().zip(&shape.points) {
            let off = (point.x_m - row[1]).hypot(point.z_m - row[2]);
            worst[0] = worst[0].max(off);
            worst[1] = worst[1].max((point.tension_n - row[3]).abs());
            worst[2] = worst[2].max((point.angle_rad.to_degrees() - row[4]).abs());
        }
        println!("{speed} m/s: {worst:?} m, N, deg");
        assert!(
            worst[0] < 1e-6 && worst[1] < 1e-8 && worst[2] < 1e-8,
            "{worst:?}"
        );
    }
}

const V5: [[f64; 5]; 8] = [
    [
        9700.0,
        4906.649035333216,
        43714.63296227797,
        35.480244473312126,
        0.21269648163805766,
    ],
    [
        9603.0,
        4904.237688455542,
        43811.72207739659,
        35.684283293893664,
        2.6123209421863596,
    ],
    [
        8730.0,
        4730.521226897615,
        44665.473753776525,
        37.52275134953423,
        18.855970066440573,
    ],
    [
        7275.0,
        4091.2620898213536,
        45971.769181012074,
        40.476631378424734,
        31.155933825572642,
    ],
    [
        4850.0,
        2721.135776935834,
        47976.4244615173,
        44.9533486065403,
        35.762712771339395,
    ],
    [
        2425.0,
        1318.7825754898245,
        49959.83373171046,
        49.19966008829899,
        34.28900661940753,
    ],
    [
        970.0,
        515.1362055879417,
        51175.90950539403,
        51.7607138119568,
        32.5945842870831,
    ],
    [0.0, 0.0, 52000.0, 53.49106453415222, 31.430267449191426],
];

const V10: [[f64; 5]; 8] = [
    [
        9700.0,
        6939.229932475505,
        45413.41315642061,
        35.480961501698225,
        0.42180910369196895,
    ],
    [
        9603.0,
        6934.463372775457,
        45510.394611919946,
        35.68548926801806,
        5.1558393509844125,
    ],
    [
        8730.0,
        6619.983490695838,
        46316.62610651231,
        37.65805672175585,
        33.37849343920918,
    ],
    [
        7275.0,
        5633.9579733739165,
        47383.80311415507,
        40.85369465409809,
        48.61880907723648,
    ],
    [
        4850.0,
        3729.7710873296187,
        48890.68849152332,
        45.051637058158235,
        52.749925953085416,
    ],
    [
        2425.0,
        1819.1493926931735,
        50390.50357703607,
        48.53246115586403,
        50.464049890382135,
    ],
    [
        970.0,
        713.9258266482193,
        51340.702808733615,
        50.564001751140495,
        48.107068898463766,
    ],
    [0.0, 0.0, 52000.0, 51.95023912051113, 46.45323366171891],
];

#[test]
fn it_works_where_the_line_lies_nearly_flat() {
    for speed in [0.0, 1.0, 2.0, 20.0, 40.0, 80.0] {
        let shape = towline(speed, ZYLON_PA, &[0.0, 4850.0, 9700.0]);
        println!("{speed} m/s: {:?} {:?}", shape.body, shape.top);
        assert_near(shape.top.z_m, 52_000.0, 1e-8);
        let reach = shape.body.x_m.hypot(shape.depth_m);
        assert!((7000.0..9730.0).contains(&reach), "{reach}");
    }
}

#[test]
fn wrong_numbers_are_refused_by_name() {
    let air = uniform(1.3, 5.0);
    let refused = |change: &dyn Fn(&mut TowedCable), places: &[f64]| {
        let mut cable = plain();
        change(&mut cable);
        cable.solve(&air, places).unwrap_err().to_string()
    };
    assert_eq!(
        refused(&|cable| cable.line.length_m = -1.0, &[]),
        "`length_m` must be finite and above zero, it is -1"
    );
    assert_eq!(
        refused(&|cable| cable.line.axial_stiffness_n = f64::NAN, &[]),
        "`axial_stiffness_n` must be above zero, it is NaN"
    );
    assert_eq!(
        refused(&|cable| cable.body.mass_kg = f64::INFINITY, &[]),
        "`mass_kg` must be finite and zero or more, it is inf"
    );
    assert_eq!(
        refused(&|_| (), &[1000.1]),
        "`from_top_m` must be between zero and the length, it is 1000.1"
    );
}

#[test]
fn what_has_no_shape_says_why() {
    let mut cable = plain();
    cable.body.mass_kg = 0.0;
    let slack = TowedCableError::Slack { from_body_m: 0.0 };
    assert_eq!(cable.solve(&uniform(1.3, 5.0), &[]), Err(slack));
    // A balloon that lifts a quarter of the line.
    cable.body.displaced_volume_m3 = 1.0;
    cable.line.mass_per_length_kg_m = 4.0 * 1.3 / 1000.0;
    let Err(TowedCableError::Slack { from_body_m }) = cable.solve(&uniform(1.3, 0.0), &[]) else {
        panic!("a line that nothing holds up");
    };
    assert_near(from_body_m, 250.0, 1e-2);
}

/// A body that is blown up where it hangs and falls back where it is not.
#[test]
fn an_edge_of_the_wind_may_leave_no_rest() {
    let mut cable = plain();
    cable.body.drag_area_m2 = 1.0;
    let edge = |z: f64| {
        Some(Conditions {
            density_kg_m3: 1.3,
            wind_m_s: if z < 51_900.0 { 30.0 } else { 0.0 },
            gravity_m_s2: GRAVITY_M_S2,
        })
    };
    let refused = cable.solve(&edge, &[]).unwrap_err();
    assert!(
        matches!(refused, TowedCableError::NoEquilibrium { .. }),
        "{refused}"
    );
}

/// Guesses beyond the known air narrow the search; a line that must leave it is an error.
#[test]
fn air_is_known_only_so_far() {
    let known = |lowest_m: f64| {
        move |z: f64| {
            let air = Conditions {
                density_kg_m3: 1.3,
                wind_m_s: 10.0,
                gravity_m_s2: GRAVITY_M_S2,
            };
            (lowest_m..=52_010.0).contains(&z).then_some(air)
        }
    };
    let mut cable = plain();
    cable.line.normal_drag = 1.0;
    let free = cable.solve(&uniform(1.3, 10.0), &[]).unwrap();
    let bounded = cable.solve(&known(51_050.0), &[]).unwrap();
    assert_near(bounded.depth_m, free.depth_m, 1e-7);
    let refused = cable.solve(&known(51_500.0), &[]).unwrap_err();
    assert!(
        matches!(refused, TowedCableError::Unknown { altitude_m } if (altitude_m - 51_500.0).abs() < 1e-6),
        "{refused}"
    );
}
