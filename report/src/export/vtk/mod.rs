//! An animation as a time series of VTK files: XML PolyData for each frame, and a ParaView collection (`.pvd`)
//! that gives each its time. Everything is in the inertial frame and of double precision, as it was recorded.
//!
//! | file of frame N | holds |
//! |---|---|
//! | `tethers_N.vtp` | points; a line for each segment that is there, with `tension_n`, `length_m`, `tether`, `segment` |
//! | `bodies_N.vtp` | a vertex for each body, with `name`, `velocity_m_s`, `wind_m_s`, `attitude` (x, y, z, w), `radius_m` |
//! | `solids_N.vtp` | the triangles of what bodies look like, with `body` (its place among bodies) and `role` |

mod poly_data;

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::meshes::shape_and_scale;
use super::{ExportError, check_not_empty};
use crate::animation::Animation;
use crate::animation::appearance::{Role, Solid};
use crate::record::Record;
use poly_data::{Array, PolyData};

/// The files of a frame, and their blocks in ParaView.
const BLOCKS: [&str; 3] = ["tethers", "bodies", "solids"];

/// Where a series goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SeriesPlace {
    /// The collection, what ParaView opens.
    pub collection: PathBuf,
    /// The folder of the frames.
    pub folder: PathBuf,
}

impl SeriesPlace {
    /// `FILE.pvd` has its frames in the folder `FILE`; any other path is a folder, with `flight.pvd` in it.
    #[must_use]
    pub fn of(path: &Path) -> Self {
        if path.extension().is_some_and(|extension| extension == "pvd") {
            Self {
                collection: path.to_owned(),
                folder: path.with_extension(""),
            }
        } else {
            Self {
                collection: path.join("flight.pvd"),
                folder: path.to_owned(),
            }
        }
    }

    /// What leads from the collection to the frames.
    fn prefix(&self) -> String {
        if self.collection.parent() == Some(self.folder.as_path()) {
            return String::new();
        }
        let name = self.folder.file_name().unwrap_or_default();
        format!("{}/", name.to_string_lossy())
    }
}

/// Writes the series, its collection last. Frames of a longer series that was there before are removed; other
/// files are left alone.
///
/// # Errors
/// There is nothing to show, or the file system refused something.
pub fn write(
    animation: &Animation,
    record: &Record,
    place: &SeriesPlace,
) -> Result<(), ExportError> {
    check_not_empty(animation)?;
    let refused = |path: &Path, error| ExportError::Io {
        path: path.to_owned(),
        error,
    };
    fs::create_dir_all(&place.folder).map_err(|error| refused(&place.folder, error))?;
    for (frame, time_s) in animation.times_s.iter().enumerate() {
        for block in BLOCKS {
            let data = match block {
                "tethers" => tethers(animation, frame),
                "bodies" => bodies(animation, record, frame),
                _ => solids(animation, frame),
            };
            let file = place.folder.join(name(block, frame));
            fs::write(&file, data.text(*time_s)).map_err(|error| refused(&file, error))?;
        }
    }
    remove_left_over(&place.folder, animation.times_s.len());
    let mut part = place.collection.clone().into_os_string();
    part.push(".part");
    fs::write(&part, collection(animation, &place.prefix()))
        .and_then(|()| fs::rename(&part, &place.collection))
        .map_err(|error| refused(&place.collection, error))
}

fn name(block: &str, frame: usize) -> String {
    format!("{block}_{frame:05}.vtp")
}

/// Removes the frames from this one on, as far as they go without a gap.
fn remove_left_over(folder: &Path, from: usize) {
    for frame in from.. {
        let removed = BLOCKS.map(|block| fs::remove_file(folder.join(name(block, frame))).is_ok());
        if !removed.contains(&true) {
            break;
        }
    }
}

/// The collection: which files show which time.
fn collection(animation: &Animation, prefix: &str) -> String {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n\
         <Collection>\n",
    );
    let prefix = poly_data::attribute(prefix);
    for (frame, time_s) in animation.times_s.iter().enumerate() {
        for (part, block) in BLOCKS.iter().enumerate() {
            let file = name(block, frame);
            let _ = writeln!(
                text,
                "<DataSet timestep=\"{time_s}\" part=\"{part}\" name=\"{block}\" file=\"{prefix}{file}\"/>"
            );
        }
    }
    text.push_str("</Collection>\n</VTKFile>\n");
    text
}

fn tethers(animation: &Animation, frame: usize) -> PolyData {
    let mut data = PolyData::default();
    let (mut tensions_n, mut lengths_m) = (Vec::new(), Vec::new());
    let (mut names, mut numbers) = (Vec::new(), Vec::new());
    for tether in &animation.tethers {
        let first = data.points.len();
        let points_m = &tether.points_m[frame];
        data.points.extend(points_m);
        for (segment, tension) in tether.tensions_n[frame].iter().enumerate() {
            let Some(tension_n) = tension else {
                continue;
            };
            data.lines.push(vec![first + segment, first + segment + 1]);
            tensions_n.push(*tension_n);
            lengths_m.push((points_m[segment + 1] - points_m[segment]).length());
            names.push(tether.name.clone());
            numbers.push(segment as i32 + 1);
        }
    }
    data.cell_data = vec![
        ("tension_n", Array::Reals(1, tensions_n)),
        ("length_m", Array::Reals(1, lengths_m)),
        ("tether", Array::Texts(names)),
        ("segment", Array::Wholes(numbers)),
    ];
    data
}

fn bodies(animation: &Animation, record: &Record, frame: usize) -> PolyData {
    let mut data = PolyData::default();
    let (mut names, mut velocities, mut winds) = (Vec::new(), Vec::new(), Vec::new());
    let (mut attitudes, mut radii_m) = (Vec::new(), Vec::new());
    let time_s = animation.times_s[frame];
    for (place, body) in animation.bodies.iter().enumerate() {
        data.points.push(body.positions_m[frame]);
        data.vertices.push(vec![place]);
        let track = record.tables.state(&body.name);
        let velocity_m_s = track.and_then(|track| track.velocity_at_m_s(time_s));
        names.push(body.name.clone());
        velocities.extend(velocity_m_s.unwrap_or_default().to_array());
        winds.extend(
            body.wind_m_s
                .get(frame)
                .copied()
                .unwrap_or_default()
                .to_array(),
        );
        attitudes.extend(body.attitudes[frame].to_array());
        radii_m.push(match body.parts.first().map(|part| part.solid) {
            Some(Solid::Sphere { radius_m }) => radius_m,
            _ => 0.0,
        });
    }
    data.point_data = vec![
        ("name", Array::Texts(names)),
        ("velocity_m_s", Array::Reals(3, velocities)),
        ("wind_m_s", Array::Reals(3, winds)),
        ("attitude", Array::Reals(4, attitudes)),
        ("radius_m", Array::Reals(1, radii_m)),
    ];
    data
}

fn solids(animation: &Animation, frame: usize) -> PolyData {
    let mut data = PolyData::default();
    let (mut places, mut roles) = (Vec::new(), Vec::new());
    for (place, body) in animation.bodies.iter().enumerate() {
        for part in &body.parts {
            let (shape, scale_m) = shape_and_scale(&part.solid);
            let mesh = shape.mesh();
            let first = data.points.len();
            let at_m = DVec3::from_array(part.at_m);
            data.points.extend(mesh.positions.iter().map(|corner| {
                let offset_m = at_m + scale_m * *corner;
                body.positions_m[frame] + body.attitudes[frame] * offset_m
            }));
            for triangle in &mesh.triangles {
                let corners = triangle.iter().map(|corner| first + *corner as usize);
                data.polygons.push(corners.collect());
                places.push(place as i32);
                roles.push(role_number(part.role));
            }
        }
    }
    data.cell_data = vec![
        ("body", Array::Wholes(places)),
        ("role", Array::Wholes(roles)),
    ];
    data
}

/// 0 balloon, 1 body, 2 sail, 3 drone, 4 anchor.
fn role_number(role: Role) -> i32 {
    match role {
        Role::Balloon => 0,
        Role::Body => 1,
        Role::Sail => 2,
        Role::Drone => 3,
        Role::Anchor => 4,
    }
}
