//! `manifest.json`: what the folder of a campaign or a design search is of. With the files that it names in `input/` it is all that a
//! run needs: shards on other machines, and repetitions years later, read nothing else.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::CampaignError;
use super::fingerprint::fingerprint;
use crate::recording::summary::VERSION;

/// Name of the manifest in the folder.
pub const MANIFEST: &str = "manifest.json";
/// Name of the folder of what the campaign was made of.
pub const INPUT: &str = "input";
/// The layout of folders that this program writes and reads.
pub const LAYOUT: u32 = 1;

/// What a folder is of.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// The layout of the folder.
    pub layout: u32,
    /// Version of the program.
    pub version: String,
    /// Name of the campaign.
    pub campaign: String,
    /// Fingerprint of the version, the campaign, its scene, and all tables: 16 hexadecimal digits.
    pub fingerprint: String,
    /// Seed of the campaign.
    pub seed: u64,
    /// Number of runs.
    pub runs: u64,
    /// Number of shards: shard k has the runs k - 1, k - 1 + shards, and so on.
    pub shards: u64,
    /// Names of files in `input/`, in the order of the fingerprint.
    pub files: Vec<String>,
    /// Names in `input/` of the tables that the campaign names.
    pub tables: BTreeMap<String, String>,
}

/// The fingerprint of input files by names and texts.
#[must_use]
pub fn fingerprint_of(files: &[(String, String)]) -> String {
    let texts = files
        .iter()
        .flat_map(|(name, text)| [name.as_bytes(), text.as_bytes()]);
    format!(
        "{:016x}",
        fingerprint([VERSION.as_bytes()].into_iter().chain(texts))
    )
}

/// What many runs are done for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Study {
    /// What they have in common.
    Campaign,
    /// The best design.
    DesignSearch,
}

/// The manifest of a design search: by its name no campaign takes it for its own.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct OfSearch<M> {
    design_search: M,
}

impl Study {
    /// The word in messages.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Campaign => "campaign",
            Self::DesignSearch => "design search",
        }
    }

    /// The command that makes a folder.
    fn command(self) -> &'static str {
        match self {
            Self::Campaign => "aerobot campaign plan FILE --out DIR",
            Self::DesignSearch => "aerobot optimise FILE --out DIR",
        }
    }

    /// Whose folder this is, by its manifest; nothing if there is none. One that is damaged is a campaign's.
    #[must_use]
    pub fn of_folder(folder: &Path) -> Option<Self> {
        let text = fs::read_to_string(folder.join(MANIFEST)).ok()?;
        let is_search = Self::DesignSearch.parse(&text).is_ok();
        Some(match is_search {
            true => Self::DesignSearch,
            false => Self::Campaign,
        })
    }

    fn parse(self, text: &str) -> serde_json::Result<Manifest> {
        match self {
            Self::Campaign => serde_json::from_str(text),
            Self::DesignSearch => {
                serde_json::from_str(text).map(|of: OfSearch<Manifest>| of.design_search)
            }
        }
    }

    fn text(self, manifest: &Manifest) -> serde_json::Result<String> {
        match self {
            Self::Campaign => serde_json::to_string_pretty(manifest),
            Self::DesignSearch => serde_json::to_string_pretty(&OfSearch {
                design_search: manifest,
            }),
        }
    }
}

impl Manifest {
    /// Reads that of a folder; `None` if there is no such file.
    ///
    /// # Errors
    /// The file is not a manifest, or one of another study, layout or version.
    pub fn read(folder: &Path, study: Study) -> Result<Option<Self>, CampaignError> {
        let path = folder.join(MANIFEST);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(CampaignError::unreadable(&path, &error)),
        };
        let word = study.word();
        let manifest = study.parse(&text).map_err(|error| {
            let message = format!(
                "{}:{}:{}: this is not the manifest of a {word}: {error}",
                path.display(),
                error.line(),
                error.column()
            );
            CampaignError::refused(message, "name another folder")
        })?;
        if (manifest.layout, manifest.version.as_str()) != (LAYOUT, VERSION) {
            let message = format!(
                "the {word} in `{}` is of version {}, this is {VERSION}",
                folder.display(),
                manifest.version
            );
            let help = "the numbers of versions differ: finish it with the version that began it";
            return Err(CampaignError::refused(message, help));
        }
        if manifest.shards == 0 || manifest.runs == 0 {
            let message = format!("{}: `runs` and `shards` must be above zero", path.display());
            return Err(CampaignError::refused(message, ""));
        }
        Ok(Some(manifest))
    }

    /// Reads that of a folder of a study.
    ///
    /// # Errors
    /// As [`Manifest::read`], or that there is none.
    pub fn open(folder: &Path, study: Study) -> Result<Self, CampaignError> {
        Self::read(folder, study)?.ok_or_else(|| {
            let (folder, word) = (folder.display(), study.word());
            let message =
                format!("`{folder}` is not the folder of a {word}: it has no `{MANIFEST}`");
            let help = format!("`{}` makes one", study.command());
            CampaignError::refused(message, &help)
        })
    }
}

/// Makes the folder of a study, whole or not at all: it is filled beside its place and renamed.
///
/// # Errors
/// What the file system refused; nothing is left then.
pub fn create_folder(
    folder: &Path,
    study: Study,
    manifest: &Manifest,
    files: &[(String, String)],
) -> Result<(), CampaignError> {
    let refused = |path: &Path, error: &io::Error| {
        CampaignError::refused(
            format_args!("cannot write `{}`: {error}", path.display()),
            "",
        )
    };
    let Some(name) = folder.file_name() else {
        let error = io::ErrorKind::InvalidFilename.into();
        return Err(refused(folder, &error));
    };
    let new = folder.with_file_name(format!(".{}.new", name.to_string_lossy()));
    let filled = fill(&new, study, manifest, files).and_then(|()| fs::rename(&new, folder));
    filled.map_err(|error| {
        let _ = fs::remove_dir_all(&new);
        refused(folder, &error)
    })
}

fn fill(
    folder: &Path,
    study: Study,
    manifest: &Manifest,
    files: &[(String, String)],
) -> io::Result<()> {
    // Left over from a program that was ended here.
    if folder.exists() {
        fs::remove_dir_all(folder)?;
    }
    fs::create_dir_all(folder.join(INPUT))?;
    if study == Study::Campaign {
        fs::create_dir(folder.join(super::shards::SHARDS))?;
    }
    for (name, text) in files {
        fs::write(folder.join(INPUT).join(name), text)?;
    }
    let mut text = study.text(manifest)?;
    text.push('\n');
    fs::write(folder.join(MANIFEST), text)
}
