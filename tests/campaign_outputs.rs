//! What comes out of a campaign.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod program;

use std::fs;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row};
use program::{Scratch, aerobot, text};

/// The scene of a fall in a vacuum, and a campaign of it.
fn falls(scratch: &Scratch, rest: &str) -> String {
    scratch.file(
        "fall.ron",
        r#"(
    name: "fall",
    environment: (gravity: Constant(8.87), atmosphere: Uniform(density_kg_m3: 0)),
    entities: {
        "stone": (
            Body: (mass_kg: 4, inertia: SolidSphere),
            Sphere: (radius_m: 0.05),
            Pose: (position_m: (0, 0, 50_000)),
            Motion: (velocity_m_s: (0, 0, 0)),
        ),
    },
    run: (duration_s: 2, output_every_s: 0.5, integrator: Auto()),
)"#,
    );
    scratch.file(
        "falls.ron",
        &format!("(name: \"falls\", scene: \"fall.ron\", seed: 3, {rest})"),
    )
}

fn run(file: &str, out: &str) -> String {
    let output = aerobot(&["campaign", "run", file, "--out", out]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

/// The fields of a line, of which some may be in quotes.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut in_quotes) = (vec![String::new()], false);
    for character in line.chars() {
        match character {
            '"' => in_quotes = !in_quotes,
            ',' if !in_quotes => cells.push(String::new()),
            other => cells.last_mut().unwrap().push(other),
        }
    }
    cells
}

fn open(path: &str) -> SerializedFileReader<fs::File> {
    SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap()
}

/// Rows of `NAME.parquet` are those of `NAME.csv` to the last digit; gives the types of the first row, and the
/// units.
fn compare(out: &str, name: &str) -> (Vec<Field>, String) {
    let csv = fs::read_to_string(format!("{out}/{name}.csv")).unwrap();
    let reader = open(&format!("{out}/{name}.parquet"));
    let metadata = reader.metadata().file_metadata();
    let columns = metadata.schema_descr().columns().iter();
    let names: Vec<String> = columns.map(|column| column.name().to_owned()).collect();
    let mut lines = csv.lines();
    assert_eq!(cells(lines.next().unwrap()), names);
    let rows: Vec<Row> = reader
        .get_row_iter(None)
        .unwrap()
        .map(Result::unwrap)
        .collect();
    assert_eq!(rows.len(), csv.lines().count() - 1);
    for (row, line) in rows.iter().zip(lines) {
        for ((name, field), cell) in row.get_column_iter().zip(cells(line)) {
            let is_same = match field {
                Field::Null => cell.is_empty(),
                // Both have the bits of one number.
                Field::Double(value) => cell.parse::<f64>().unwrap().to_bits() == value.to_bits(),
                Field::ULong(value) => cell.parse::<u64>().unwrap() == *value,
                Field::Str(value) => cell == value.replace('"', ""),
                _ => false,
            };
            assert!(is_same, "{name}: {cell} and {field:?}");
        }
    }
    let fields = rows[0].get_column_iter().map(|(_, field)| field.clone());
    let units = metadata.key_value_metadata().unwrap();
    let units = units.iter().find(|entry| entry.key == "units").unwrap();
    (fields.collect(), units.value.clone().unwrap())
}

/// A leaf so heavy that a wind does not move it: its airspeed is that of the wind.
fn gusty_leaf(wind: &str) -> String {
    format!(
        r#"(
    name: "gust",
    environment: (wind: [{wind}]),
    entities: {{
        "leaf": (
            Body: (mass_kg: 400, inertia: SolidSphere),
            Sphere: (radius_m: 0.05),
            Pose: (position_m: (0, 0, 56_000)),
            Drag: Constant(coefficient: 0.47),
        ),
    }},
    run: (duration_s: 0.1, output_every_s: 0.1, integrator: Auto()),
)"#
    )
}

/// Numbers as numbers, choices that are not as text, seeds beyond what floating point holds as they are.
#[test]
fn parquet_tables_are_the_csv_tables() {
    let scratch = Scratch::folder();
    let file = falls(
        &scratch,
        r#"
    runs: 40,
    vary: {
        "entities.stone.Motion.velocity_m_s.2": Uniform(-3, 9),
        "entities.stone.Sphere.radius_m": Uniform(-0.05, 0.1),
        "entities.stone.Body.mass_kg": Choice([3, 4.5, 5]),
        "environment.gravity": Choice([Constant(8.87), Constant(9.81)]),
    },
    metrics: {
        "height_z_m": Final(entity: "stone", channel: "z_m"),
        "fast_s": FirstTime(entity: "stone", channel: "vz_m_s", below: -10),
    },
    envelopes: {"fall_vz_m_s": (entity: "stone", channel: "vz_m_s", every_s: 0.1)},
"#,
    );
    let out = scratch.path("out");
    run(&file, &out);
    let (fields, units) = compare(&out, "runs");
    let is_as_given = matches!(
        fields.as_slice(),
        [
            Field::ULong(0),
            Field::ULong(_),
            Field::Double(_),
            Field::Double(_),
            Field::Double(_),
            Field::Str(_),
            Field::Str(_),
            Field::Str(_),
            Field::Double(_),
            ..
        ]
    );
    assert!(is_as_given, "{fields:?}");
    let units: serde_json::Value = serde_json::from_str(&units).unwrap();
    assert_eq!(units["entities.stone.Motion.velocity_m_s.2"], "m/s");
    assert_eq!(units["height_z_m"], "m");
    let seeds = open(&format!("{out}/runs.parquet"))
        .get_row_iter(None)
        .unwrap()
        .map(|row| row.unwrap().get_column_iter().nth(1).unwrap().1.clone())
        .filter(|seed| matches!(seed, Field::ULong(seed) if *seed > i64::MAX as u64))
        .count();
    assert!(seeds > 5, "{seeds} seeds need all 64 bits");
    let table = fs::read_to_string(format!("{out}/runs.csv")).unwrap();
    assert!(table.contains(",refused,") && table.contains(",done,"));
    let (fields, units) = compare(&out, "envelopes");
    assert!(
        matches!(fields[2], Field::ULong(runs) if runs > 10),
        "{fields:?}"
    );
    assert!(units.contains(r#""fall_vz_m_s":"m/s""#), "{units}");
}

/// The indices of a field on a metric: first-order and total estimates with their intervals.
fn indices(out: &str, field: &str, metric: &str) -> serde_json::Value {
    let summary = fs::read_to_string(format!("{out}/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let all = summary["sobol_indices"].as_array().unwrap().clone();
    let is_it = |index: &serde_json::Value| index["field"] == field && index["metric"] == metric;
    all.into_iter().find(is_it).unwrap()
}

fn assert_holds(estimate: &serde_json::Value, exact: f64, within: f64) {
    let value = estimate["value"].as_f64().unwrap();
    assert!((value - exact).abs() < within, "{estimate}, not {exact}");
    let bound = |place: usize| estimate["interval_95"][place].as_f64().unwrap();
    assert!(
        bound(0) - 1e-9 <= exact && exact <= bound(1) + 1e-9,
        "{estimate}, not {exact}"
    );
}

/// The height after 2 s is z0 + 2 v0 and a constant: variances 20^2/12 and 2^2 12^2/12, nothing together, and no
/// chance.
#[test]
fn a_fall_has_the_indices_of_its_closed_form() {
    let vary = r#"vary: {
        "entities.stone.Pose.position_m.2": Uniform(49_990, 50_010),
        "entities.stone.Motion.velocity_m_s.2": Uniform(-3, 9),
    },
    metrics: {"height_z_m": Final(entity: "stone", channel: "z_m")}"#;
    let of_place = 400.0 / (400.0 + 4.0 * 144.0);
    let scratch = Scratch::folder();
    let out = scratch.path("saltelli");
    let file = falls(
        &scratch,
        &format!("plan: Saltelli, base_samples: 256, {vary}"),
    );
    let said = run(&file, &out);
    assert!(said.contains("Sobol index"), "{said}");
    let table = fs::read_to_string(format!("{out}/runs.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 256 * 5);
    let (place, speed) = (
        "entities.stone.Pose.position_m.2",
        "entities.stone.Motion.velocity_m_s.2",
    );
    for (field, exact) in [
        (place, of_place),
        (speed, 1.0 - of_place),
        ("run.seed", 0.0),
    ] {
        let found = indices(&out, field, "height_z_m");
        assert_eq!(
            (&found["samples"], &found["left_out"]),
            (&256.into(), &0.into())
        );
        assert_holds(&found["first_order"], exact, 0.01);
        assert_holds(&found["total"], exact, 0.01);
    }
    // The same from runs of chance, by ranks.
    let out = scratch.path("chance");
    let said = run(&falls(&scratch, &format!("runs: 400, {vary}")), &out);
    assert!(said.contains("Sobol index"), "{said}");
    for (field, exact) in [(place, of_place), (speed, 1.0 - of_place)] {
        let found = indices(&out, field, "height_z_m");
        assert_holds(&found["first_order"], exact, 0.15);
        assert!(found["total"].is_null());
    }
    // Seeds that are set are no factor.
    let out = scratch.path("set");
    let set = format!("plan: Saltelli, runs: 40, set: {{\"run.seed\": 5}}, {vary}");
    run(&falls(&scratch, &set), &out);
    let table = fs::read_to_string(format!("{out}/runs.csv")).unwrap();
    assert_eq!(
        table.lines().filter(|line| line.contains(",5,")).count(),
        40
    );
    assert!(
        !fs::read_to_string(format!("{out}/summary.json"))
            .unwrap()
            .contains("run.seed\"")
    );
}

/// Wind of 18 to 22 m/s and a gust of 1 m/s: variances 16/12 and 1, of which the gust's is chance. A tenth of the
/// radii are below zero.
#[test]
fn chance_is_a_factor_and_base_samples_are_whole() {
    let scratch = Scratch::folder();
    scratch.file(
        "gust.ron",
        &gusty_leaf(
            "Uniform(velocity_m_s: (20, 0, 0)),
            Gust(zonal: (decay_per_s: 0.05, marginal: Normal(standard_deviation_m_s: 1)))",
        ),
    );
    let file = scratch.file(
        "gusts.ron",
        r#"(name: "gusts", scene: "gust.ron", seed: 8, plan: Saltelli, base_samples: 256,
    vary: {
        "environment.wind.0.velocity_m_s.0": Uniform(18, 22),
        "entities.leaf.Sphere.radius_m": Uniform(-0.01, 0.09),
    },
    metrics: {"wind_m_s": Final(entity: "leaf", channel: "airspeed_m_s")})"#,
    );
    let out = scratch.path("out");
    let said = run(&file, &out);
    // Each base sample has two draws of the radius, each of which is refused in a tenth of them.
    let wind = "environment.wind.0.velocity_m_s.0";
    let exact = 16.0 / 12.0 / (16.0 / 12.0 + 1.0);
    for (field, exact) in [(wind, exact), ("run.seed", 1.0 - exact)] {
        let found = indices(&out, field, "wind_m_s");
        let left_out = found["left_out"].as_u64().unwrap();
        assert!((35..65).contains(&left_out), "{left_out}");
        assert_eq!(found["samples"].as_u64(), Some(256 - left_out));
        assert_holds(&found["first_order"], exact, 0.2);
        assert_holds(&found["total"], exact, 0.12);
    }
    assert!(said.contains("base samples lack wind_m_s"), "{said}");
    let precise = aerobot(&[
        "campaign",
        "run",
        &file,
        "--out",
        &out,
        "--until-ci",
        "1",
        "--of",
        "wind_m_s",
    ]);
    assert_eq!(precise.status.code(), Some(2));
}

/// Some radii are below zero, and some falls get into a gravity that no step can follow: what failed is told by its
/// reason, with the inputs of the first run and the command that repeats it.
#[test]
fn failures_are_told_by_reason_with_a_way_to_see_them_again() {
    let scratch = Scratch::folder();
    let file = falls(
        &scratch,
        r#"
    runs: 40,
    set: {"run.integrator": Fixed(step_s: 0.5)},
    vary: {
        "entities.stone.Sphere.radius_m": Uniform(-0.05, 0.1),
        "environment.gravity": Choice([Constant(8.87), Constant(1e200)]),
    },
    metrics: {
        "height_z_m": Final(entity: "stone", channel: "z_m"),
        "fast_s": FirstTime(entity: "stone", channel: "vz_m_s", below: -10),
        "never_s": FirstTime(entity: "stone", channel: "vz_m_s", above: 1),
    },
"#,
    );
    let out = scratch.path("out");
    let said = run(&file, &out);
    let summary = fs::read_to_string(format!("{out}/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let failures = summary["failures"].as_array().unwrap();
    let table = fs::read_to_string(format!("{out}/runs.csv")).unwrap();
    let rows: Vec<Vec<String>> = table.lines().skip(1).map(cells).collect();
    let of = |outcome: &str| rows.iter().filter(|row| row[4] == outcome).count() as u64;
    assert!(
        of("refused") > 5 && of("stopped") > 5 && of("done") > 5,
        "{table}"
    );
    for outcome in ["refused", "stopped"] {
        let is_it =
            |failure: &&serde_json::Value| failure["reason"].as_str().unwrap().starts_with(outcome);
        let found: Vec<_> = failures.iter().filter(is_it).collect();
        let runs: u64 = found.iter().map(|of| of["runs"].as_u64().unwrap()).sum();
        assert_eq!(runs, of(outcome));
        let first = found[0]["first_run"].as_u64().unwrap() as usize;
        let row = &rows[first];
        assert_eq!(row[4], outcome);
        assert!(row[7..].iter().all(String::is_empty), "{row:?}");
        assert_eq!(
            found[0]["first_inputs"],
            serde_json::json!([
                format!("entities.stone.Sphere.radius_m={}", row[2]),
                format!("environment.gravity={}", row[3]),
                format!("run.seed={}", row[1]),
            ])
        );
        assert_eq!(
            found[0]["replay"],
            format!("aerobot campaign replay DIR --run {first}")
        );
        let command = format!("aerobot campaign replay {out} --run {first}");
        assert!(said.contains(&command), "{said}");
        let replayed = aerobot(&["campaign", "replay", &out, "--run", &first.to_string()]);
        let expected = if outcome == "refused" { 2 } else { 3 };
        assert_eq!(
            replayed.status.code(),
            Some(expected),
            "{}",
            text(&replayed.stderr)
        );
    }
    // What never was is told apart from what failed.
    let never = &summary["metrics"][2];
    assert_eq!(
        (&never["runs"], &never["done_without"]),
        (&0.into(), &of("done").into())
    );
    assert_eq!(summary["metrics"][1]["done_without"], 0);
}

/// The CSV file of a gust goes with the folder: what it was made of may be gone, and the folder be elsewhere.
#[test]
fn a_folder_has_the_table_of_a_gust() {
    let scratch = Scratch::folder();
    let speeds: String = (0..400)
        .map(|k| format!("{}\n", f64::from(k) * 0.01))
        .collect();
    scratch.file("there/speeds.csv", &format!("speed_m_s\n{speeds}"));
    scratch.file(
        "there/gust.ron",
        &gusty_leaf(r#"Gust(zonal: (decay_per_s: 0.05, marginal: Empirical(file: "speeds.csv")))"#),
    );
    let file = scratch.file(
        "there/gusts.ron",
        r#"(name: "gusts", scene: "gust.ron", runs: 12,
    vary: {"entities.leaf.Body.mass_kg": Uniform(300, 500)},
    metrics: {"wind_m_s": Final(entity: "leaf", channel: "airspeed_m_s")})"#,
    );
    let (plan, moved, whole) = (
        scratch.path("plan"),
        scratch.path("moved"),
        scratch.path("whole"),
    );
    run(&file, &whole);
    let planned = aerobot(&["campaign", "plan", &file, "--out", &plan, "--shards", "2"]);
    assert_eq!(planned.status.code(), Some(0), "{}", text(&planned.stderr));
    fs::remove_dir_all(scratch.path("there")).unwrap();
    fs::rename(&plan, &moved).unwrap();
    for shard in ["1/2", "2/2"] {
        let output = aerobot(&["campaign", "run", &moved, "--shard", shard]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    }
    let merged = aerobot(&["campaign", "merge", &moved]);
    assert_eq!(merged.status.code(), Some(0), "{}", text(&merged.stderr));
    let bytes = |folder: &str, name: &str| fs::read(format!("{folder}/{name}")).unwrap();
    for name in ["runs.csv", "runs.parquet", "summary.json"] {
        assert_eq!(bytes(&whole, name), bytes(&moved, name), "{name}");
    }
    let table = fs::read_to_string(format!("{moved}/runs.csv")).unwrap();
    assert_eq!(table.matches(",done,").count(), 12, "{table}");
}
