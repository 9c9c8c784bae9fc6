//! `aerobot wind fit` and `aerobot wind sample` as a user meets them.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;

use program::{Scratch, aerobot, text};

const SCENE: &str = "scenes/examples/gusty_tether.ron";

/// Every number of the table that `sample` prints, by the name of its row.
fn rows(printed: &str) -> Vec<(String, [f64; 4])> {
    let lines = printed.lines().filter(|line| line.starts_with("  "));
    lines
        .filter_map(|line| {
            let words: Vec<&str> = line.split_whitespace().collect();
            let (name, numbers) = words.split_at_checked(words.len().checked_sub(4)?)?;
            let numbers: Vec<f64> = numbers
                .iter()
                .filter_map(|word| word.parse().ok())
                .collect();
            Some((name.join(" "), numbers.try_into().ok()?))
        })
        .collect()
}

/// What is found lies within four standard errors of the theory, and the fit of what was written says what
/// the scene does.
#[test]
fn what_is_drawn_has_its_statistics_and_fits_what_it_was_drawn_from() {
    let scratch = Scratch::folder();
    let (file, again) = (scratch.path("wind.csv"), scratch.path("again.csv"));
    let sample = |out: &str| {
        let arguments = [
            "wind",
            "sample",
            SCENE,
            "--duration",
            "3600",
            "--altitude",
            "56000",
            "--out",
            out,
        ];
        let printed = aerobot(&arguments);
        assert_eq!(printed.status.code(), Some(0), "{printed:?}");
        text(&printed.stdout)
    };
    let printed = sample(&file);
    let rows = rows(&printed);
    assert!(rows.len() > 30, "{printed}");
    for (name, [found, theory, error, off]) in &rows {
        assert!(
            off.abs() < 4.0,
            "{name}: {found} {theory} {error}\n{printed}"
        );
    }
    let mean = rows.iter().find(|(name, _)| name == "mean, m/s").unwrap();
    assert_eq!(mean.1[1..3], [0.0, 0.02557]);
    sample(&again);
    let wind = fs::read_to_string(&file).unwrap();
    assert_eq!(wind, fs::read_to_string(&again).unwrap());
    assert!(wind.starts_with("time_s,altitude_m,zonal_m_s,meridional_m_s,vertical_m_s\n0,56000,"));
    assert_eq!(wind.lines().count(), 18_002);
    assert!(!wind.contains("NaN") && !wind.contains("inf"));

    let block = scratch.path("gust.ron");
    let fit = aerobot(&[
        "wind",
        "fit",
        &file,
        "--column",
        "zonal_m_s",
        "--out",
        &block,
    ]);
    assert_eq!(fit.status.code(), Some(0), "{fit:?}");
    let printed = text(&fit.stdout);
    for (name, truth) in [
        ("mean_m_s", 0.0),
        ("standard_deviation_m_s", 1.0),
        ("decay_per_s", 0.05),
        ("frequency_rad_s", 0.2),
    ] {
        let line = printed
            .lines()
            .find(|line| line.trim().starts_with(name))
            .unwrap();
        let interval = line.split_once('[').unwrap().1.trim_end_matches(']');
        let (low, high) = interval.split_once(", ").unwrap();
        let (low, high): (f64, f64) = (low.parse().unwrap(), high.parse().unwrap());
        // Twice as wide: of four intervals one may well miss.
        let half = 0.5 * (high - low);
        assert!(low - half < truth && truth < high + half, "{line}");
    }
    let gust = fs::read_to_string(&block).unwrap();
    let wind = format!("environment.wind=[{gust}]");
    let check = aerobot(&["check", SCENE, "--set", &wind]);
    assert_eq!(check.status.code(), Some(0), "{check:?}");
    assert!(text(&check.stdout).contains("gust 0, zonal: normal"));
}

#[test]
fn quiet_prints_nothing_and_a_file_that_exists_stays() {
    let scratch = Scratch::folder();
    let file = scratch.file("there.csv", "mine\n");
    let refused = aerobot(&["wind", "sample", SCENE, "--out", &file]);
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(fs::read_to_string(&file).unwrap(), "mine\n");
    let forced = aerobot(&[
        "wind", "sample", SCENE, "--out", &file, "--force", "--quiet",
    ]);
    assert_eq!(forced.status.code(), Some(0), "{forced:?}");
    assert!(forced.stdout.is_empty());
    assert!(
        fs::read_to_string(&file)
            .unwrap()
            .starts_with("time_s,altitude_m,")
    );
    let refused = aerobot(&[
        "wind",
        "fit",
        &file,
        "--column",
        "zonal_m_s",
        "--out",
        &file,
    ]);
    assert_eq!(refused.status.code(), Some(2));
}

/// Each with the message and nothing written.
#[test]
fn what_cannot_be_done_is_refused_with_the_reason() {
    let scratch = Scratch::folder();
    let out = scratch.path("out");
    let rows = |speed: &dyn Fn(u32) -> String| -> String {
        (0..40).map(|k| format!("{k},{}\n", speed(k))).collect()
    };
    let bad = scratch.file(
        "bad.csv",
        &format!(
            "time_s,u\n{}",
            rows(&|k| if k == 3 { "x".into() } else { k.to_string() })
        ),
    );
    let wave = scratch.file(
        "wave.csv",
        &format!("time_s,u\n{}", rows(&|k| (k % 5).to_string())),
    );
    for (arguments, expected) in [
        (
            vec!["wind", "fit", "nowhere.csv"],
            "error: cannot read `nowhere.csv`: ".to_owned(),
        ),
        (
            vec!["wind", "fit", &bad],
            format!("error: {bad}:5:3: `u` must be a number or empty: `x`\n"),
        ),
        (
            vec!["wind", "fit", &wave, "--marginal", "weibull"],
            format!(
                "error: {wave}: a Weibull distribution is of velocities above zero, and `u` has 0 m/s\n"
            ),
        ),
        (
            vec!["wind", "sample", "scenes/paper/comparison_900m.ron"],
            "error: the wind of `comparison-900m` has no stochastic gust\n".to_owned(),
        ),
        (
            vec!["wind", "sample", SCENE, "--duration", "-1"],
            "error: `--duration` must be above zero, it is -1\n".to_owned(),
        ),
        (
            vec!["wind", "sample", SCENE, "--every", "1e-9"],
            "error: 100 s in steps of 0.000000001 s are more than 2e7 rows\n".to_owned(),
        ),
        (
            vec!["wind", "sample", SCENE, "--altitude", "54999"],
            "error: altitude 54999 m is outside the gust, which is known from 55000 m to 57000 m\n"
                .to_owned(),
        ),
    ] {
        let arguments = [arguments.as_slice(), &["--out", &out]].concat();
        let refused = aerobot(&arguments);
        assert_eq!(refused.status.code(), Some(2), "{refused:?}");
        let message = text(&refused.stderr);
        assert!(
            message.starts_with(&expected),
            "expected {expected}found {message}"
        );
        assert!(!scratch.0.join("out").exists());
    }
}
