use super::*;

#[test]
fn a_scaled_wind_is_the_wind_times_the_factor() {
    let mut wind = Wind::new(vec![
        WindSource::Uniform {
            velocity_m_s: DVec3::new(1.0, 2.0, 3.0),
        },
        WindSource::Shear {
            altitude_m: 1e3,
            gradient_per_s: 1e-3,
            direction: DVec3::Y,
        },
        WindSource::Step {
            velocity_m_s: DVec3::Z,
            from_s: 0.0,
            until_s: 1.0,
        },
        WindSource::Profile(WindProfile::venus_zonal()),
    ]);
    wind.begin_interval(0.5);
    let whole = wind.velocity_m_s(54_321.0).unwrap();
    let part = wind.scaled(0.3).velocity_m_s(54_321.0).unwrap();
    assert!((part - 0.3 * whole).length() < 1e-14 * whole.length());
}

fn step(x: f64, from_s: f64, until_s: f64) -> WindSource {
    WindSource::Step {
        velocity_m_s: DVec3::new(x, 0.0, 0.0),
        from_s,
        until_s,
    }
}

fn shear() -> WindSource {
    WindSource::Shear {
        altitude_m: 56_000.0,
        gradient_per_s: 0.002,
        direction: DVec3::Y,
    }
}

fn x_from(wind: &mut Wind, start_s: f64) -> f64 {
    wind.begin_interval(start_s);
    wind.velocity_m_s(0.0).unwrap().x
}

#[test]
fn a_step_blows_from_its_first_time_until_just_before_its_last() {
    let mut wind = Wind::new(vec![step(5.0, 10.0, 20.0)]);
    for (start_s, expected) in [
        (0.0, 0.0),
        (10.0_f64.next_down(), 0.0),
        (10.0, 5.0),
        (20.0_f64.next_down(), 5.0),
        (20.0, 0.0),
        (15.0, 5.0),
    ] {
        assert_eq!(x_from(&mut wind, start_s), expected, "at {start_s} s");
    }
}

#[test]
fn overlapping_steps_add_and_edges_are_sorted_once() {
    let mut wind = Wind::new(vec![
        step(1.0, 20.0, 30.0),
        step(2.0, 10.0, 20.0),
        step(4.0, 15.0, f64::INFINITY),
        step(8.0, f64::NEG_INFINITY, 10.0),
    ]);
    assert_eq!(wind.edges_s(), [10.0, 15.0, 20.0, 30.0]);
    assert_eq!(wind.velocity_m_s(0.0).unwrap().x, 8.0);
    for (start_s, expected) in [
        (0.0, 8.0),
        (10.0, 2.0),
        (15.0, 6.0),
        (20.0, 5.0),
        (30.0, 4.0),
    ] {
        assert_eq!(x_from(&mut wind, start_s), expected, "at {start_s} s");
    }
}

#[test]
fn shear_is_zero_at_its_altitude_and_linear() {
    let wind = Wind::new(vec![shear()]);
    assert_eq!(wind.velocity_m_s(56_000.0), Ok(DVec3::ZERO));
    assert_eq!(wind.velocity_m_s(57_000.0), Ok(DVec3::new(0.0, 2.0, 0.0)));
    assert_eq!(wind.velocity_m_s(54_000.0), Ok(DVec3::new(0.0, -4.0, 0.0)));
    assert_eq!(wind.slope_per_s(0.0), Ok(DVec3::new(0.0, 0.002, 0.0)));
    assert!(wind.depends_on_altitude());
}

#[test]
fn sources_add() {
    let uniform = WindSource::Uniform {
        velocity_m_s: DVec3::new(-1.0, 0.0, 0.5),
    };
    let profile = WindSource::Profile(WindProfile::venus_zonal());
    let mut wind = Wind::new(vec![profile, step(3.0, 0.0, 1.0), shear(), uniform]);
    wind.begin_interval(0.0);
    let velocity = wind.velocity_m_s(60_000.0).unwrap();
    assert!((velocity - DVec3::new(72.7 - 1.0 + 3.0, 8.0, 0.5)).length() < 1e-12);
    let secant = wind.velocity_m_s(58_001.0).unwrap() - wind.velocity_m_s(57_999.0).unwrap();
    assert!((secant / 2.0 - wind.slope_per_s(58_000.0).unwrap()).length() < 1e-9);
}

#[test]
fn still_air_is_still_everywhere() {
    let wind = Wind::still();
    assert_eq!(wind.velocity_m_s(1e9), Ok(DVec3::ZERO));
    assert!(wind.edges_s().is_empty() && !wind.depends_on_altitude());
}

#[test]
fn outside_a_profile_is_an_error_that_says_its_bounds() {
    let wind = Wind::new(vec![WindSource::Profile(WindProfile::venus_zonal())]);
    assert_eq!(
        wind.velocity_m_s(70_001.0).unwrap_err().to_string(),
        "altitude 70001 m is outside the wind profile, which is known from 0 m to 70000 m"
    );
    assert!(wind.velocity_m_s(f64::NAN).is_err());
    assert!(wind.slope_per_s(-1.0).is_err());
    assert!(Wind::new(vec![shear()]).velocity_m_s(f64::NAN).is_err());
}
