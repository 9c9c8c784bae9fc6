//! A scene that starts in its steady state: its own text with the poses, motions and node positions of a
//! [`Trim`] put in. Comments and layout survive; tables keep their places, named as seen from the new
//! file. Rings stay rings, with the nodes of `Each` of their tethers; copies are written out.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

use aerobot_components::body::{Fixed, Motion, Moving, Pose};
use aerobot_components::scene_component::SceneComponent;
use aerobot_components::tether::Tether;
use aerobot_components::tether_ring::Tethers;
use glam::DVec3;

use super::written_out::with_copies_written_out;
use super::{Trim, TrimmedBody, TrimmedTether};
use crate::recording::number::write_number;
use crate::scene::source::{FieldPath, Segment, apply, parse_override};
use crate::scene::{Scene, SceneError};

/// Why a trimmed scene was not written.
#[derive(Debug)]
pub enum WriteError {
    /// The text cannot be edited.
    Scene(SceneError),
    /// The file exists.
    Exists(PathBuf),
    /// A table of the scene has no name that would lead to it from the new file.
    Table(String),
    /// The file system refused something.
    Io(PathBuf, io::Error),
}

impl fmt::Display for WriteError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(error) => error.fmt(formatter),
            Self::Exists(file) => write!(
                formatter,
                "error: the file `{}` exists\n  = help: name another with `--out`, or overwrite it \
                 with `--force`",
                file.display()
            ),
            Self::Table(table) => write!(
                formatter,
                "error: the table `{table}` cannot be named from the new file\n  = help: write the \
                 scene beside its tables"
            ),
            Self::Io(file, error) => write!(
                formatter,
                "error: cannot write `{}`: {error}",
                file.display()
            ),
        }
    }
}

impl std::error::Error for WriteError {}

/// Refuses a file that exists, unless it may be overwritten, and one that cannot be a file.
///
/// # Errors
/// [`WriteError::Exists`]; [`WriteError::Io`] for a folder, or a file in no folder.
pub fn check_target(file: &Path, overwrite: bool) -> Result<(), WriteError> {
    if file.is_dir() {
        let error = io::ErrorKind::IsADirectory.into();
        return Err(WriteError::Io(file.to_owned(), error));
    }
    let folder = folder_of(file);
    if file.file_name().is_none() || !folder.is_dir() {
        let error = io::ErrorKind::NotFound.into();
        return Err(WriteError::Io(file.to_owned(), error));
    }
    if file.exists() && !overwrite {
        return Err(WriteError::Exists(file.to_owned()));
    }
    Ok(())
}

/// Writes the scene that starts in `trim` to `file`. `scene_folder` is where `scene` looks for its
/// tables.
///
/// # Errors
/// Why nothing was written.
pub fn write_trimmed_scene(
    scene: &Scene,
    trim: &Trim,
    scene_folder: &Path,
    file: &Path,
    overwrite: bool,
) -> Result<(), WriteError> {
    check_target(file, overwrite)?;
    let text = trimmed_text(scene, trim, scene_folder, folder_of(file))?;
    // Whole or not at all.
    let mut part = file.as_os_str().to_owned();
    part.push(".part");
    let part = PathBuf::from(part);
    fs::write(&part, text)
        .and_then(|()| fs::rename(&part, file))
        .map_err(|error| {
            let _ = fs::remove_file(&part);
            WriteError::Io(file.to_owned(), error)
        })
}

fn folder_of(file: &Path) -> &Path {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// The text of a scene in `new_folder` that starts in `trim`.
fn trimmed_text(
    scene: &Scene,
    trim: &Trim,
    scene_folder: &Path,
    new_folder: &Path,
) -> Result<String, WriteError> {
    let mut edits = Vec::new();
    for body in &trim.bodies {
        if body.is_anchor {
            push_place_of_copy(scene, &body.name, &mut edits);
        } else {
            edits.push(edit(&body.name, &[Pose::NAME], &pose(body)));
            push_motion(scene, &body.name, &body.name, body.velocity_m_s, &mut edits);
        }
    }
    push_tethers(scene, trim, &mut edits);
    for (path, table) in scene.tables.paths(&scene.environment) {
        let name = renamed(&table, scene_folder, new_folder)?;
        if name != table {
            edits.push(format!("{path}={name:?}"));
        }
    }
    let refused = |message: String| WriteError::Scene(SceneError::plain(message));
    let overrides = edits
        .iter()
        .map(|argument| parse_override(argument).map_err(refused))
        .collect::<Result<Vec<_>, _>>()?;
    let written_out = with_copies_written_out(scene.source.text(), &scene.groups);
    let edited =
        apply(&written_out, &overrides).map_err(|diagnostic| refused(diagnostic.message))?;
    Ok(edited.text().to_owned())
}

/// Where nodes start, and how they move: of single tethers, and of the tethers of each ring together.
fn push_tethers(scene: &Scene, trim: &Trim, edits: &mut Vec<String>) {
    let ring_of = |tether: &TrimmedTether| {
        let (group, _) = scene.groups.of(&tether.name)?;
        (group.component == Tethers::NAME).then_some(group.name.as_str())
    };
    let mut rest = trim.tethers.as_slice();
    while let Some(first) = rest.first() {
        let ring = ring_of(first);
        let count = rest
            .iter()
            .take_while(|tether| ring.is_some() && ring_of(tether) == ring)
            .count();
        let (tethers, others) = rest.split_at(count.max(1));
        rest = others;
        let (name, component, start) = match ring {
            None => (first.name.as_str(), Tether::NAME, start(first)),
            Some(ring) => {
                let lists: Vec<String> = tethers.iter().map(positions).collect();
                (ring, Tethers::NAME, format!("Each([{}])", lists.join(", ")))
            }
        };
        if !first.node_positions_m.is_empty() {
            edits.push(edit(name, &[component, "start"], &start));
        }
        if let Some(twist_rad) = first.twist_rad {
            let fields = [component, "torsion", "twist_rad"];
            edits.push(edit(name, &fields, &number(twist_rad)));
        }
        push_motion(scene, name, &first.name, first.velocity_m_s, edits);
    }
}

/// A copy of an anchor stands where its number puts it.
fn push_place_of_copy(scene: &Scene, name: &str, edits: &mut Vec<String>) {
    let Some(anchor) = scene.groups.of(name).and_then(|_| scene.entity(name)) else {
        return;
    };
    let fixed = anchor.get::<Fixed>().and_then(|fixed| fixed.position_m);
    let places = [
        (Fixed::NAME, fixed),
        (Moving::NAME, anchor.get::<Moving>().map(|m| m.position_m)),
        (Pose::NAME, anchor.get::<Pose>().map(|pose| pose.position_m)),
    ];
    for (component, place) in places {
        if let Some(place) = place {
            edits.push(edit(name, &[component, "position_m"], &vector(place)));
        }
    }
}

/// What moves says so, and what was said to move and does not: the entity `name` of the text, that stands
/// for `member` of the scene.
fn push_motion(
    scene: &Scene,
    name: &str,
    member: &str,
    velocity_m_s: DVec3,
    edits: &mut Vec<String>,
) {
    let has_motion = scene
        .entity(member)
        .is_some_and(|entity| entity.has::<Motion>());
    if has_motion || velocity_m_s != DVec3::ZERO {
        let motion = format!("(velocity_m_s: {})", vector(velocity_m_s));
        edits.push(edit(name, &[Motion::NAME], &motion));
    }
}

/// An override of a field of an entity.
fn edit(name: &str, fields: &[&str], value: &str) -> String {
    let steps = ["entities", name].into_iter().chain(fields.iter().copied());
    let path = FieldPath {
        segments: steps.map(|step| Segment::Name(step.to_owned())).collect(),
    };
    format!("{path}={value}")
}

fn pose(body: &TrimmedBody) -> String {
    let position = vector(body.position_m);
    if !body.turns {
        return format!("(position_m: {position})");
    }
    let q = body.attitude;
    let parts = [q.x, q.y, q.z, q.w].map(number).join(", ");
    format!("(position_m: {position}, attitude: Quaternion({parts}))")
}

fn start(tether: &TrimmedTether) -> String {
    format!("Positions({})", positions(tether))
}

/// The list of the positions of a tether's nodes.
fn positions(tether: &TrimmedTether) -> String {
    let positions: Vec<String> = tether
        .node_positions_m
        .iter()
        .copied()
        .map(vector)
        .collect();
    format!("[{}]", positions.join(", "))
}

fn vector(value: DVec3) -> String {
    format!("({})", value.to_array().map(number).join(", "))
}

/// The shortest text that reads back to the same number.
fn number(value: f64) -> String {
    let mut text = Vec::new();
    match write_number(&mut text, value) {
        Ok(()) => String::from_utf8_lossy(&text).into_owned(),
        Err(_) => format!("{value:?}"),
    }
}

/// The name under which a table beside `scene_folder` is found from `new_folder`.
fn renamed(table: &str, scene_folder: &Path, new_folder: &Path) -> Result<String, WriteError> {
    if Path::new(table).is_absolute() {
        return Ok(table.to_owned());
    }
    let real = |path: &Path| {
        let path = if path.as_os_str().is_empty() {
            Path::new(".")
        } else {
            path
        };
        fs::canonicalize(path).map_err(|error| WriteError::Io(path.to_owned(), error))
    };
    let (from, to) = (real(new_folder)?, real(scene_folder)?);
    if from == to {
        return Ok(table.to_owned());
    }
    let name = relative(&from, &real(&scene_folder.join(table))?);
    let text = name.to_str().map(str::to_owned);
    text.ok_or_else(|| WriteError::Table(table.to_owned()))
}

/// The way from a folder to a file, both without links and dots.
fn relative(folder: &Path, file: &Path) -> PathBuf {
    let shared = folder
        .components()
        .zip(file.components())
        .take_while(|(a, b)| a == b)
        .count();
    let up = folder
        .components()
        .skip(shared)
        .map(|_| Component::ParentDir);
    up.chain(file.components().skip(shared)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_named_from_the_new_folder() {
        for (folder, file, expected) in [
            ("/a/b", "/a/b/wind.csv", "wind.csv"),
            ("/a/b", "/a/c/wind.csv", "../c/wind.csv"),
            ("/a", "/a/b/wind.csv", "b/wind.csv"),
            ("/a/b/c", "/d.csv", "../../../d.csv"),
        ] {
            let way = relative(Path::new(folder), Path::new(file));
            assert_eq!(way, Path::new(expected));
        }
    }

    #[test]
    fn names_with_dots_and_spaces_are_quoted() {
        assert_eq!(edit("a b.c", &["Pose"], "()"), "entities.\"a b.c\".Pose=()");
    }
}
