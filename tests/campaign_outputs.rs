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
        "fast_s": FirstTime(entity: "stone", channel: "vz_m_s", below: Some(-10)),
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
