//! Why a scene cannot be compared.

use std::fmt;

use aerobot_engine::run_folder::RunError;
use aerobot_engine::scene::SceneError;
use aerobot_engine::scene::source::parse_override;

use super::Variant;

/// Why nothing was compared.
#[derive(Debug)]
pub enum CompareError {
    /// The scene is refused for one reason in both ways.
    Scene(SceneError),
    /// The scene is refused in these ways.
    Variants(Vec<(Variant, SceneError)>),
    /// An override sets the field in which the two differ: its path.
    Override(String),
    /// There is no folder to write into.
    Folder(RunError),
}

impl fmt::Display for CompareError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(formatter),
            Self::Variants(refused) => {
                for (index, (variant, error)) in refused.iter().enumerate() {
                    let gap = if index == 0 { "" } else { "\n\n" };
                    let Variant { name, change } = variant;
                    write!(
                        formatter,
                        "{gap}{error}\n  = note: in the run `{name}`, with `{change}`"
                    )?;
                }
                Ok(())
            }
            Self::Override(path) => write!(
                formatter,
                "error: `--set {path}`: the two runs that are compared differ in `{path}`\n  = help: \
                 leave it out"
            ),
            Self::Folder(error) => error.fmt(formatter),
        }
    }
}

impl std::error::Error for CompareError {}

impl From<RunError> for CompareError {
    fn from(error: RunError) -> Self {
        Self::Folder(error)
    }
}

/// Both, if both are there.
pub(super) fn both<T>(
    built: [Result<T, SceneError>; 2],
    variants: &[Variant; 2],
) -> Result<[T; 2], CompareError> {
    let [first, second] = *variants;
    match built {
        [Ok(a), Ok(b)] => Ok([a, b]),
        [Err(a), Err(b)] if a == b => Err(CompareError::Scene(a)),
        [Err(a), Err(b)] => Err(CompareError::Variants(vec![(first, a), (second, b)])),
        [Err(a), Ok(_)] => Err(CompareError::Variants(vec![(first, a)])),
        [Ok(_), Err(b)] => Err(CompareError::Variants(vec![(second, b)])),
    }
}

/// An override of what the variants change would be lost without a word.
pub(super) fn check_overrides(
    overrides: &[String],
    variants: &[Variant; 2],
) -> Result<(), CompareError> {
    // What cannot be read is refused with the scene.
    let path = |text: &str| parse_override(text).ok().map(|change| change.path);
    let changed = variants.map(|variant| path(variant.change));
    for given in overrides.iter().filter_map(|text| path(text)) {
        if changed.iter().flatten().any(|changed| *changed == given) {
            return Err(CompareError::Override(given.to_string()));
        }
    }
    Ok(())
}
