//! Tables that a scene reads from CSV files beside it.

use std::collections::BTreeMap;
use std::path::Path;

use aerobot_components::environment::{AtmosphereSpec, Environment, GasSpec, WindSpec};
use aerobot_components::gust::{GustSpec, MarginalSpec};
use aerobot_components::scene_component::FieldReport;
use aerobot_systems::environment::atmosphere_table::AtmosphereTable;
use aerobot_systems::environment::table_csv::{
    TableError, read_atmosphere, read_sample, read_wind_profile,
};
use aerobot_systems::environment::viscosity::Gas;
use aerobot_systems::environment::wind_profile::WindProfile;

/// The tables of a scene, read.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// The table of the atmosphere, if it is one.
    pub atmosphere: Option<AtmosphereTable>,
    /// Wind profiles by their place in the list of winds.
    pub winds: BTreeMap<usize, WindProfile>,
    /// Samples of velocities (m/s) by the file that the scene names.
    pub samples: BTreeMap<String, Vec<f64>>,
    /// Every file that was read, by the path that the scene gives it, with its text.
    pub files: BTreeMap<String, String>,
}

impl Tables {
    /// Reads what `environment` names from `folder`; what is wrong goes to the report.
    pub fn read(environment: &Environment, folder: &Path, report: &mut FieldReport) -> Self {
        let mut tables = Self::default();
        if let AtmosphereSpec::Table { file, gas } = &environment.atmosphere {
            tables.atmosphere = tables
                .text("environment.atmosphere.file", file, folder, report)
                .map(|text| read_atmosphere(&text, gas_of(*gas)))
                .and_then(|result| accept("environment.atmosphere.file", file, result, report));
        }
        for (path, file) in samples(environment) {
            let sample = tables
                .text(&path, file, folder, report)
                .map(|text| read_sample(&text))
                .and_then(|result| accept(&path, file, result, report));
            if let Some(sample) = sample {
                tables.samples.insert(file.to_owned(), sample);
            }
        }
        for (index, wind) in environment.wind.iter().enumerate() {
            let WindSpec::Profile { file } = wind else {
                continue;
            };
            let path = format!("environment.wind.{index}.file");
            let profile = tables
                .text(&path, file, folder, report)
                .map(|text| read_wind_profile(&text))
                .and_then(|result| accept(&path, file, result, report));
            if let Some(profile) = profile {
                tables.winds.insert(index, profile);
            }
        }
        tables
    }

    /// Where the scene names each file: the path of the field, and the file.
    #[must_use]
    pub fn paths(&self, environment: &Environment) -> Vec<(String, String)> {
        let mut paths = Vec::new();
        if let AtmosphereSpec::Table { file, .. } = &environment.atmosphere {
            paths.push(("environment.atmosphere.file".to_owned(), file.clone()));
        }
        for (index, wind) in environment.wind.iter().enumerate() {
            if let WindSpec::Profile { file } = wind {
                paths.push((format!("environment.wind.{index}.file"), file.clone()));
            }
        }
        paths.extend(samples(environment).map(|(path, file)| (path, file.to_owned())));
        paths
    }

    fn text(
        &mut self,
        path: &str,
        file: &str,
        folder: &Path,
        report: &mut FieldReport,
    ) -> Option<String> {
        match std::fs::read_to_string(folder.join(file)) {
            Ok(text) => {
                self.files.insert(file.to_owned(), text.clone());
                Some(text)
            }
            Err(error) => {
                report.add(
                    path,
                    format!("cannot read the table `{file}`: {error}"),
                    "the path is relative to the scene's own folder",
                );
                None
            }
        }
    }
}

/// The samples that gusts name: the path of the field, and the file.
fn samples(environment: &Environment) -> impl Iterator<Item = (String, &str)> {
    let gusts = environment.wind.iter().enumerate();
    let gusts = gusts.filter_map(|(index, wind)| match wind {
        WindSpec::Gust(gust) => Some((index, gust)),
        _ => None,
    });
    gusts.flat_map(|(index, gust)| samples_of(index, gust))
}

fn samples_of(index: usize, gust: &GustSpec) -> impl Iterator<Item = (String, &str)> {
    let axes = gust.axes().into_iter();
    axes.filter_map(move |(name, axis)| match &axis?.marginal {
        MarginalSpec::Empirical { file } => {
            let path = format!("environment.wind.{index}.{name}.marginal.file");
            Some((path, file.as_str()))
        }
        _ => None,
    })
}

fn accept<T>(
    path: &str,
    file: &str,
    result: Result<T, TableError>,
    report: &mut FieldReport,
) -> Option<T> {
    match result {
        Ok(table) => Some(table),
        Err(error) => {
            let TableError {
                line,
                column,
                message,
            } = error;
            report.add(path, format!("{file}:{line}:{column}: {message}"), "");
            None
        }
    }
}

/// The gas that a scene names.
#[must_use]
pub fn gas_of(gas: GasSpec) -> Gas {
    match gas {
        GasSpec::CarbonDioxide => Gas::CarbonDioxide,
        GasSpec::Air => Gas::Air,
    }
}
