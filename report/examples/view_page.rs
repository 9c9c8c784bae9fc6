//! Writes a page with nothing but the view of runs: `view_page PAGE RUN_FOLDER...`.

use std::error::Error;
use std::fs;
use std::path::Path;

use aerobot_engine::plugin::Simulator;
use aerobot_report::animation::Animation;
use aerobot_report::page::view::{SCRIPT, STYLE, view};
use aerobot_report::record::Record;

/// About 30 frames a second for what takes a minute to watch.
const MOST_FRAMES: usize = 1500;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let page = arguments
        .next()
        .ok_or("usage: view_page PAGE RUN_FOLDER...")?;
    let simulator = Simulator::new();
    let records = arguments
        .map(|folder| Record::read(&simulator, Path::new(&folder)))
        .collect::<Result<Vec<_>, _>>()?;
    let animations: Vec<Animation> = records
        .iter()
        .map(|record| Animation::of(record, MOST_FRAMES))
        .collect();
    let names = records.iter().map(|record| record.label.as_str());
    let runs: Vec<(&str, &Animation)> = names.zip(&animations).collect();
    fs::write(
        page,
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>view</title>\n<style>body {{ margin: 16px; }}\n{STYLE}</style>\n</head>\n<body>\n{}<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
            view(&runs)
        ),
    )?;
    Ok(())
}
