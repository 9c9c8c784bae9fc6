//! Writes a page of which one knows how it looks: `yawed_page PAGE`. A long bar lies along y, since it is
//! yawed by a right angle, from 1 m behind its place to 7 m before it, and rises; a line that is cut half
//! way through the run joins it to a ball.

use std::error::Error;
use std::f64::consts::FRAC_PI_2;
use std::fs;

use aerobot_report::animation::appearance::{Part, Role, Solid};
use aerobot_report::animation::{Animation, BodyMotion, TetherMotion};
use aerobot_report::page::view::{SCRIPT, STYLE, view};
use glam::{DQuat, DVec3};

const LINE: DVec3 = DVec3::new(0.0, 0.0, 20.0);

fn main() -> Result<(), Box<dyn Error>> {
    let page = std::env::args().nth(1).ok_or("usage: yawed_page PAGE")?;
    let times_s: Vec<f64> = (0..=100).map(|index| 0.1 * f64::from(index)).collect();
    let rise = times_s
        .iter()
        .map(|time_s| DVec3::new(0.0, 0.0, 56_000.0 + time_s));
    let places_m: Vec<DVec3> = rise.collect();
    let bar = Solid::Box {
        size_m: [8.0, 1.0, 1.0],
    };
    let ball = Solid::Sphere { radius_m: 1.0 };
    let yaw = DQuat::from_rotation_z(FRAC_PI_2);
    let body = |name: &str, solid, at_m, role, attitude, offset_m: DVec3| BodyMotion {
        name: name.into(),
        parts: vec![Part {
            solid,
            at_m,
            role,
            to_scale: true,
        }],
        positions_m: places_m.iter().map(|place| *place + offset_m).collect(),
        attitudes: vec![attitude; times_s.len()],
        wind_m_s: vec![DVec3::new(5.0, 0.0, 0.0); times_s.len()],
    };
    let tension = |time_s: &f64| vec![(*time_s < 5.0).then_some(100.0 + 10.0 * time_s)];
    let animation = Animation {
        bodies: vec![
            body("bar", bar, [3.0, 0.0, 0.0], Role::Body, yaw, DVec3::ZERO),
            body(
                "ball </script>",
                ball,
                [0.0; 3],
                Role::Balloon,
                DQuat::IDENTITY,
                LINE,
            ),
        ],
        tethers: vec![TetherMotion {
            name: "line".into(),
            diameter_m: 0.002,
            points_m: places_m
                .iter()
                .map(|place| vec![*place, *place + LINE])
                .collect(),
            tensions_n: times_s.iter().map(tension).collect(),
        }],
        events: vec![(5.0, "line/1: cut".into())],
        times_s,
    };
    let view = view(&[("known", &animation)]);
    fs::write(
        page,
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>known</title>\n<style>body {{ margin: 16px; }}\n{STYLE}</style>\n</head>\n<body>\n{view}<script>\n{SCRIPT}</script>\n</body>\n</html>\n"
        ),
    )?;
    Ok(())
}
