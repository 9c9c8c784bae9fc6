//! Tables as Parquet: read back by the format's own reader, they are those of the CSV files.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod program;

use std::fs;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::Field;
use program::{Scratch, aerobot, text};

const SCENE: &str = "scenes/paper/multi_tether.ron";

fn run(format: &str) -> Scratch {
    let scratch = Scratch::new();
    let output = aerobot(&[
        "run",
        SCENE,
        "--until",
        "5",
        "--format",
        format,
        "--set",
        "run.record=(channels: All)",
        "--out",
        scratch.text(),
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    scratch
}

/// A value as a CSV file has it.
fn as_text(field: &Field) -> String {
    match field {
        Field::Null => String::new(),
        Field::Double(value) => format!("{value:?}"),
        other => other.to_string().trim_matches('"').to_owned(),
    }
}

fn is_same(csv: &str, parquet: &str) -> bool {
    csv == parquet || csv.parse::<f64>().ok() == parquet.parse::<f64>().ok()
}

#[test]
fn parquet_tables_are_the_csv_tables() {
    let (csv, parquet) = (run("csv"), run("parquet"));
    for (name, unit) in [
        ("states", r#""wx_rad_s":"rad/s""#),
        ("tethers", r#""tension_n":"N""#),
        ("channels", r#""time_s":"s""#),
    ] {
        assert!(!parquet.0.join(format!("{name}.csv")).exists());
        let expected = fs::read_to_string(csv.path(&format!("{name}.csv"))).unwrap();
        let mut lines = expected.lines();
        let file = fs::File::open(parquet.path(&format!("{name}.parquet"))).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let metadata = reader.metadata().file_metadata();
        let units = metadata.key_value_metadata().unwrap();
        assert!(units[0].value.as_ref().unwrap().contains(unit), "{units:?}");
        let columns = metadata.schema_descr().columns().iter();
        let names: Vec<&str> = columns.map(|column| column.name()).collect();
        assert_eq!(lines.next().unwrap(), names.join(","), "{name}");
        let mut rows = 0;
        for (row, line) in reader.get_row_iter(None).unwrap().zip(lines.by_ref()) {
            let row = row.unwrap();
            let fields: Vec<String> = row
                .get_column_iter()
                .map(|(_, field)| as_text(field))
                .collect();
            let expected: Vec<&str> = line.split(',').collect();
            assert_eq!(fields.len(), expected.len(), "{line}");
            let same = fields.iter().zip(&expected).all(|(a, b)| is_same(b, a));
            assert!(same, "{line}: {fields:?}");
            rows += 1;
        }
        assert!(rows > 10 && lines.next().is_none(), "{name}: {rows} rows");
        assert_eq!(i64::from(rows), metadata.num_rows());
    }
}

#[test]
fn the_same_run_has_the_same_bytes_and_what_was_there_goes() {
    let (once, twice) = (run("parquet"), run("parquet"));
    for name in ["states", "tethers", "channels"] {
        let file = format!("{name}.parquet");
        let bytes = |scratch: &Scratch| fs::read(scratch.path(&file)).unwrap();
        assert_eq!(bytes(&once), bytes(&twice), "{file}");
    }
    let again = aerobot(&[
        "run",
        SCENE,
        "--until",
        "1",
        "--force",
        "--quiet",
        "--out",
        once.text(),
    ]);
    assert_eq!(again.status.code(), Some(0), "{}", text(&again.stderr));
    assert!(!once.0.join("states.parquet").exists());
    assert!(once.0.join("states.csv").exists());
}
