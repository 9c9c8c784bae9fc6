//! From a campaign file to what its folder holds: everything is checked against the scene before a byte is
//! written.

use std::path::Path;

use super::CampaignError;
use super::distributions::Distribution;
use super::manifest::{LAYOUT, MANIFEST, Manifest, Study, create_folder, fingerprint_of};
use super::plan::Plan;
use super::plan_tables::{Files, read_tables};
use super::probe::Probe;
use super::specification::{CampaignSpec, Faults, entry_path, read_specification};
use crate::plugin::Simulator;
use crate::recording::summary::VERSION;
use crate::run_folder::scene_as_run;
use crate::scene::source::Source;
use crate::scene::{Scene, SceneError};

/// Name of the campaign in `input/`.
pub const CAMPAIGN_FILE: &str = "campaign.ron";
/// Name of the scene in `input/`.
pub const SCENE_FILE: &str = "scene.ron";

/// A campaign or a design search that is in order, and the files that its folder will hold.
pub struct Prepared {
    study: Study,
    /// What the folder is of.
    pub manifest: Manifest,
    /// Names and texts of the files in `input/`.
    pub files: Vec<(String, String)>,
}

/// Reads a campaign file and everything that it names, and checks it.
///
/// # Errors
/// Everything that is wrong, rendered.
pub fn prepare(simulator: &Simulator, file: &Path, shards: u64) -> Result<Prepared, SceneError> {
    let text = std::fs::read_to_string(file).map_err(|error| {
        SceneError::plain(format_args!("cannot read `{}`: {error}", file.display()))
    })?;
    let (specification, source) = read_specification(&file.display().to_string(), &text)?;
    let folder = file.parent().unwrap_or_else(|| Path::new("."));
    let checked = check(simulator, folder, &specification, &source)?;
    checked.into_prepared(
        Study::Campaign,
        (CAMPAIGN_FILE, text),
        &specification,
        shards,
    )
}

/// A specification that fits its scene.
pub(crate) struct Checked {
    plan: Plan,
    /// The scene with what all runs have in common.
    pub(crate) scene: Scene,
    tables: Files,
}

/// Checks a specification that is in order by itself against what it names in `folder`; `source` is its text.
///
/// # Errors
/// Everything that is wrong, rendered.
pub(crate) fn check(
    simulator: &Simulator,
    folder: &Path,
    specification: &CampaignSpec,
    source: &Source,
) -> Result<Checked, SceneError> {
    let mut faults = Faults::default();
    let read =
        |name: &str| std::fs::read_to_string(folder.join(name)).map_err(|error| error.to_string());
    let (tables, table_files) = read_tables(specification, &read, &mut faults);
    faults.into_result(source)?;
    let mut faults = Faults::default();
    let plan = Plan::new(specification, tables, &mut faults);
    faults.into_result(source)?;
    let Some(plan) = plan else {
        return Err(SceneError::plain("the campaign has no plan"));
    };
    let checked = SceneOfCampaign {
        simulator,
        file: &folder.join(&specification.scene),
        specification,
        source,
    };
    let scene = checked.check(&plan)?;
    Ok(Checked {
        plan,
        scene,
        tables: table_files,
    })
}

impl Checked {
    /// With the text of the specification, which `input/` will have under `name`.
    pub(crate) fn into_prepared(
        self,
        study: Study,
        (name, text): (&str, String),
        specification: &CampaignSpec,
        shards: u64,
    ) -> Result<Prepared, SceneError> {
        let runs = self.plan.runs;
        if shards > runs {
            return Err(SceneError::plain(format_args!(
                "{shards} shards are more than the {runs} runs"
            )));
        }
        let (files, tables) = input_files((name, text), &self.scene, self.tables)?;
        Ok(Prepared {
            study,
            manifest: Manifest {
                layout: LAYOUT,
                version: VERSION.to_owned(),
                campaign: specification.name.clone(),
                fingerprint: fingerprint_of(&files),
                seed: specification.seed,
                runs,
                shards,
                files: files.iter().map(|(name, _)| name.clone()).collect(),
                tables,
            },
            files,
        })
    }
}

impl Prepared {
    /// Makes the folder, or makes sure that it is of this study.
    ///
    /// # Errors
    /// The folder holds something else; then nothing was written.
    pub fn into_folder(self, folder: &Path) -> Result<(), CampaignError> {
        let Some(there) = Manifest::read(folder, self.study)? else {
            let is_free = match std::fs::read_dir(folder) {
                Ok(mut entries) => entries.next().is_none(),
                Err(_) => !folder.exists(),
            };
            if !is_free {
                let message = format!("`{}` exists, and has no `{MANIFEST}`", folder.display());
                return Err(CampaignError::refused(
                    message,
                    "name another folder with `--out`",
                ));
            }
            return create_folder(folder, self.study, &self.manifest, &self.files);
        };
        let (wanted, folder, word) = (&self.manifest, folder.display(), self.study.word());
        if there.fingerprint != wanted.fingerprint {
            let what = if there.campaign == wanted.campaign {
                "its file, its scene or a table of them has changed since".to_owned()
            } else {
                format!(
                    "that one is `{}`, this one `{}`",
                    there.campaign, wanted.campaign
                )
            };
            let message = format!("`{folder}` belongs to another {word}: {what}");
            return Err(CampaignError::refused(
                message,
                "name another folder with `--out`",
            ));
        }
        if there.shards != wanted.shards {
            let message = format!("the campaign in `{folder}` has {} shards", there.shards);
            let help = "`aerobot campaign run DIR --shard K/N` runs one of them";
            return Err(CampaignError::refused(message, help));
        }
        Ok(())
    }
}

/// Names and texts, and the names by which the campaign knows its tables.
type InputFiles = (
    Vec<(String, String)>,
    std::collections::BTreeMap<String, String>,
);

fn input_files(
    (name, text): (&str, String),
    scene: &Scene,
    tables: Files,
) -> Result<InputFiles, SceneError> {
    let as_run = scene_as_run(scene)?;
    let mut files = vec![
        (name.to_owned(), text),
        (SCENE_FILE.to_owned(), as_run.text),
    ];
    let mut names = std::collections::BTreeMap::new();
    for (number, (name, text)) in tables.into_iter().enumerate() {
        let new = format!("campaign-table-{}.csv", number + 1);
        names.insert(name, new.clone());
        files.push((new, text));
    }
    files.extend(as_run.tables);
    Ok((files, names))
}

/// A scene, looked at as its campaign does.
struct SceneOfCampaign<'a> {
    simulator: &'a Simulator,
    file: &'a Path,
    specification: &'a CampaignSpec,
    source: &'a Source,
}

impl SceneOfCampaign<'_> {
    /// The scene with what all runs have in common.
    fn check(&self, plan: &Plan) -> Result<Scene, SceneError> {
        // What is wrong with the scene itself is shown as `aerobot run` would.
        self.simulator.load(self.file, &[])?;
        let mut faults = Faults::default();
        let set: Vec<String> = (self.specification.set.0.iter())
            .map(|(path, value)| format!("{path}={}", value.0))
            .collect();
        for ((path, _), change) in self.specification.set.0.iter().zip(&set) {
            if let Err(error) = self.simulator.load(self.file, std::slice::from_ref(change)) {
                add(&mut faults, &entry_path("set", path), change, &error);
            }
        }
        faults.into_result(self.source)?;
        let scene = self.simulator.load(self.file, &set)?;
        let mut faults = Faults::default();
        for (path, values) in plan.samples() {
            self.check_field(&scene, (path, &values), &set, &mut faults);
        }
        for (name, envelope) in &self.specification.envelopes.0 {
            let report = &mut faults.0;
            report.within(&entry_path("envelopes", name), |report| {
                envelope.check(scene.run.duration_s, report);
            });
        }
        faults.into_result(self.source)?;
        let mut faults = Faults::default();
        self.check_channels(plan, &set, &mut faults)?;
        faults.into_result(self.source)?;
        Ok(scene)
    }

    fn check_field(
        &self,
        scene: &Scene,
        (path, values): (&str, &[String]),
        set: &[String],
        faults: &mut Faults,
    ) {
        let mut written = self.specification.vary.0.iter();
        let distribution = written.find_map(|(field, of)| (field == path).then_some(of));
        let has_list =
            |of: &Distribution| matches!(of, Distribution::Choice(_) | Distribution::List(_));
        for (number, value) in values.iter().enumerate() {
            let place = match distribution {
                Some(of) if has_list(of) => format!("{}.0.{number}", entry_path("vary", path)),
                Some(_) => entry_path("vary", path),
                None => "plan".to_owned(),
            };
            let change = format!("{path}={value}");
            let changes: Vec<String> = set.iter().cloned().chain([change.clone()]).collect();
            match self.simulator.load(self.file, &changes) {
                Err(error) => return add(faults, &place, &change, &error),
                Ok(varied) if !varied.tables.files.keys().eq(scene.tables.files.keys()) => {
                    let message = format!("`{path}` names a table, and cannot vary");
                    return faults
                        .0
                        .add(&place, message, "make a campaign for each table");
                }
                Ok(_) => {}
            }
        }
    }

    /// Runs the first run until everything that is looked at has been recorded.
    fn check_channels(
        &self,
        plan: &Plan,
        set: &[String],
        faults: &mut Faults,
    ) -> Result<(), SceneError> {
        let inputs = plan.inputs(0).overrides();
        let changes: Vec<String> = set.iter().cloned().chain(inputs).collect();
        let build = |changes: &[String]| {
            let scene = self.simulator.load(self.file, changes)?;
            self.simulator.build(&scene)
        };
        // The first run may be one that fails.
        let mut simulation = build(&changes).or_else(|_| build(set))?;
        let quantities = self.specification.quantities();
        let mut probe = Probe {
            wanted: quantities.iter().map(|(_, quantity)| quantity).collect(),
            seen: Default::default(),
        };
        simulation.run(&mut probe, &mut |_| {});
        for (path, quantity) in &quantities {
            if probe.wanted.contains(&quantity) {
                let (field, message, help) = probe.why(quantity);
                faults.0.add(&format!("{path}.{field}"), message, help);
            }
        }
        Ok(())
    }
}

/// What a scene says of a field, shown in the campaign.
pub(crate) fn add(faults: &mut Faults, place: &str, change: &str, error: &SceneError) {
    let mut lines = error.text.lines();
    let first = lines.next().unwrap_or_default();
    let message = first.strip_prefix("error: ").unwrap_or(first);
    let help = lines.find_map(|line| line.trim_start().strip_prefix("= help: "));
    let message = format!("the scene refuses `{change}`: {message}");
    faults.0.add(place, message, help.unwrap_or_default());
}
