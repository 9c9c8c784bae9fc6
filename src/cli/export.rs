//! `aerobot export`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_report::animation::Animation;
use aerobot_report::export::vtk::SeriesPlace;
use aerobot_report::export::{gltf, vtk};
use aerobot_report::record::Record;
use clap::{ArgGroup, Args};

use super::{REFUSED, complain, finding, say};

/// Endings of files that VTK has and a series is not.
const OTHER_VTK_FILES: [&str; 9] = [
    "vtk", "vtp", "vtu", "vtm", "vti", "vtr", "vts", "vtkhdf", "xml",
];

#[derive(Args)]
#[command(group(ArgGroup::new("target").required(true).multiple(true).args(["gltf", "vtk"])))]
pub(super) struct ExportArguments {
    /// The folder of a run.
    run: PathBuf,
    /// File for glTF 2.0, `.glb`: for Blender and viewers.
    #[arg(long, value_name = "FILE.glb")]
    gltf: Option<PathBuf>,
    /// Collection for ParaView, `.pvd`, with its frames in the folder of the same name; or a folder for both.
    #[arg(long, value_name = "FILE_OR_FOLDER")]
    vtk: Option<PathBuf>,
    /// Most frames, besides those nearest to events and to the largest tension.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=99_999))]
    frames: u32,
    /// Overwrite what exists.
    #[arg(long)]
    force: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

pub(super) fn export(simulator: &Simulator, arguments: &ExportArguments) -> ExitCode {
    match write(simulator, arguments) {
        Ok(lines) => {
            if !arguments.quiet {
                lines.iter().for_each(say);
            }
            ExitCode::SUCCESS
        }
        Err(message) => {
            complain(message);
            ExitCode::from(REFUSED)
        }
    }
}

/// Writes what is asked for; gives lines about it.
fn write(simulator: &Simulator, arguments: &ExportArguments) -> Result<Vec<String>, String> {
    if let Some(file) = &arguments.gltf {
        check_gltf(file, arguments.force)?;
    }
    let series = match &arguments.vtk {
        Some(path) => Some(check_vtk(path, arguments.force)?),
        None => None,
    };
    let record = Record::read(simulator, &arguments.run).map_err(|error| error.to_string())?;
    let animation = Animation::of(&record, arguments.frames as usize);
    let contents = contents(&animation);
    let mut lines = Vec::new();
    let gltf = arguments.gltf.as_deref().map(|file| {
        let bytes = gltf::binary(&animation, &record.summary);
        bytes.map(|bytes| (file, bytes))
    });
    if let Some((file, bytes)) = gltf.transpose().map_err(|error| error.to_string())? {
        finding::write_whole(file, |out| out.write_all(&bytes))?;
        let size = bytes.len() as f64 * 1e-6;
        lines.push(format!(
            "glTF, {contents}, {size:.1} MB: `{}`",
            file.display()
        ));
    }
    if let Some(place) = series {
        vtk::write(&animation, &record, &place).map_err(|error| error.to_string())?;
        lines.push(format!("VTK, {contents}: `{}`", place.collection.display()));
    }
    Ok(lines)
}

fn contents(animation: &Animation) -> String {
    let tethers = animation.tethers.iter();
    let segments: usize = tethers
        .map(|tether| tether.tensions_n.first().map_or(0, Vec::len))
        .sum();
    format!(
        "{} frames, bodies: {}, segments of tethers: {segments}",
        animation.times_s.len(),
        animation.bodies.len()
    )
}

fn check_gltf(file: &Path, force: bool) -> Result<(), String> {
    if file.extension().is_none_or(|extension| extension != "glb") {
        return Err(format!(
            "error: `{}` does not end in `.glb`\n  = help: glTF is written as one binary file, `.glb`",
            file.display()
        ));
    }
    check_parent(file)?;
    if file.is_dir() {
        return Err(format!(
            "error: cannot write `{}`: it is a folder",
            file.display()
        ));
    }
    refuse_existing(file, "file", force)
}

fn check_vtk(path: &Path, force: bool) -> Result<SeriesPlace, String> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    if OTHER_VTK_FILES.contains(&extension.as_ref()) {
        return Err(format!(
            "error: `{}` is neither a folder nor a collection\n  = help: a series has many files: name a \
             folder, or a `.pvd` that has one beside it",
            path.display()
        ));
    }
    check_parent(path)?;
    let place = SeriesPlace::of(path);
    if place.collection.is_dir() {
        let collection = place.collection.display();
        return Err(format!(
            "error: cannot write `{collection}`: it is a folder"
        ));
    }
    if fs::symlink_metadata(&place.folder).is_ok() && !place.folder.is_dir() {
        let folder = place.folder.display();
        return Err(format!(
            "error: cannot write into `{folder}`: it is no folder"
        ));
    }
    refuse_existing(&place.collection, "file", force)?;
    refuse_existing(&place.folder, "folder", force)?;
    Ok(place)
}

/// Refuses what is in no folder.
fn check_parent(path: &Path) -> Result<(), String> {
    let parent = path
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    let parent = parent.unwrap_or_else(|| Path::new("."));
    if path.file_name().is_none() || !parent.is_dir() {
        return Err(format!(
            "error: cannot write `{}`: there is no folder `{}`",
            path.display(),
            parent.display()
        ));
    }
    Ok(())
}

fn refuse_existing(path: &Path, what: &str, force: bool) -> Result<(), String> {
    if path.exists() && !force {
        return Err(format!(
            "error: the {what} `{}` exists\n  = help: name another, or overwrite it with `--force`",
            path.display()
        ));
    }
    Ok(())
}
