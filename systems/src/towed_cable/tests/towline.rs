//! The towline of the paper against values of a separate program, and in winds beyond them.

use std::f64::consts::PI;

use crate::environment::atmosphere::Atmosphere;
use crate::environment::wind::{Wind, WindSource};
use crate::environment::wind_profile::WindProfile;

use super::super::{Conditions, Line, StaticShape, TowedBody, TowedCable};
use super::{GRAVITY_M_S2, assert_near};

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

/// Short and long lines with light and heavy bodies, in the reference atmosphere and the zonal wind
/// of Venus, whose top drifts a little faster or slower than its air.
#[test]
fn it_finds_a_shape_wherever_a_balloon_may_tow() {
    let air = Atmosphere::vira();
    let profile = WindSource::Profile(WindProfile::venus_zonal());
    let wind = Wind::new(vec![profile]);
    let mut worst = 0.0_f64;
    for length_m in [100.0, 1000.0, 5000.0, 15_000.0] {
        for top_altitude_m in [46_000.0, 54_000.0, 60_000.0] {
            for mass_kg in [0.1, 4.0, 100.0] {
                for drift_m_s in [-10.0, 0.0, 10.0] {
                    let speed = wind.velocity_m_s(top_altitude_m).unwrap().x + drift_m_s;
                    let surroundings = |z: f64| {
                        Some(Conditions {
                            density_kg_m3: air.density_kg_m3(z).ok()?,
                            wind_m_s: wind.velocity_m_s(z).ok()?.x - speed,
                            gravity_m_s2: GRAVITY_M_S2,
                        })
                    };
                    let cable = TowedCable {
                        line: Line {
                            length_m,
                            mass_per_length_kg_m: 1e-3,
                            diameter_m: 1e-3,
                            axial_stiffness_n: 5e4,
                            normal_drag: 1.2,
                            tangential_drag: 0.03,
                        },
                        body: TowedBody {
                            mass_kg,
                            drag_area_m2: 0.02,
                            displaced_volume_m3: 0.0,
                        },
                        top_altitude_m,
                    };
                    let shape = cable
                        .solve(&surroundings, &[])
                        .unwrap_or_else(|error| panic!("{cable:?}: {error}"));
                    worst = worst.max((shape.top.z_m - top_altitude_m).abs() / length_m);
                }
            }
        }
    }
    println!("the top comes out where it is held within {worst:e} of the length");
    assert!(worst < 1e-10, "{worst:e}");
}
