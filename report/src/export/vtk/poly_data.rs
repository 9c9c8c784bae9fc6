//! A file of XML PolyData, version 1.0: numbers inline as base64 of little-endian bytes after their length (of 8
//! bytes), texts as the codes of their bytes, each text ended by a zero.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;

/// Values of points or cells.
pub(super) enum Array {
    /// So many numbers for each.
    Reals(usize, Vec<f64>),
    /// A whole number for each.
    Wholes(Vec<i32>),
    /// A text for each.
    Texts(Vec<String>),
}

/// Points, what joins them, and values.
#[derive(Default)]
pub(super) struct PolyData {
    pub(super) points: Vec<DVec3>,
    pub(super) vertices: Vec<Vec<usize>>,
    pub(super) lines: Vec<Vec<usize>>,
    pub(super) polygons: Vec<Vec<usize>>,
    pub(super) point_data: Vec<(&'static str, Array)>,
    /// Of vertices, lines and polygons in this order.
    pub(super) cell_data: Vec<(&'static str, Array)>,
}

impl PolyData {
    /// The file, for this time in s.
    pub(super) fn text(&self, time_s: f64) -> String {
        let mut text = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n",
        );
        let _ = writeln!(
            text,
            "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{time_s}</DataArray>\n</FieldData>"
        );
        let _ = writeln!(
            text,
            "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{}\">",
            self.points.len(),
            self.vertices.len(),
            self.lines.len(),
            self.polygons.len()
        );
        write_arrays(&mut text, "PointData", &self.point_data);
        write_arrays(&mut text, "CellData", &self.cell_data);
        let points = self.points.iter().flat_map(|point| point.to_array());
        let points = Array::Reals(3, points.collect());
        text.push_str("<Points>\n");
        write_array(&mut text, "Points", &points);
        text.push_str("</Points>\n");
        write_cells(&mut text, "Verts", &self.vertices);
        write_cells(&mut text, "Lines", &self.lines);
        write_cells(&mut text, "Polys", &self.polygons);
        text.push_str("</Piece>\n</PolyData>\n</VTKFile>\n");
        text
    }
}

/// A text as the value of an attribute.
pub(super) fn attribute(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('"', "&quot;")
        .replace('<', "&lt;")
}

fn write_arrays(text: &mut String, element: &str, arrays: &[(&str, Array)]) {
    let _ = writeln!(text, "<{element}>");
    for (name, array) in arrays {
        write_array(text, name, array);
    }
    let _ = writeln!(text, "</{element}>");
}

fn write_array(text: &mut String, name: &str, array: &Array) {
    match array {
        Array::Reals(components, values) => {
            let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            write_numbers(text, ("Float64", name, *components), &bytes);
        }
        Array::Wholes(values) => {
            let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
            write_numbers(text, ("Int32", name, 1), &bytes);
        }
        Array::Texts(values) => {
            let count = values.len();
            let _ = write!(
                text,
                "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"{count}\" format=\"ascii\">"
            );
            for byte in values.iter().flat_map(|value| value.bytes().chain([0])) {
                let _ = write!(text, "{byte} ");
            }
            text.push_str("</Array>\n");
        }
    }
}

fn write_numbers(text: &mut String, (kind, name, components): (&str, &str, usize), bytes: &[u8]) {
    let mut with_length = (bytes.len() as u64).to_le_bytes().to_vec();
    with_length.extend_from_slice(bytes);
    let _ = writeln!(
        text,
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
         format=\"binary\">{}</DataArray>",
        STANDARD.encode(with_length)
    );
}

fn write_cells(text: &mut String, element: &str, cells: &[Vec<usize>]) {
    let mut ends = Vec::with_capacity(cells.len());
    let mut corners = Vec::new();
    for cell in cells {
        corners.extend(cell.iter().map(|place| *place as u64));
        ends.push(corners.len() as u64);
    }
    let _ = writeln!(text, "<{element}>");
    for (name, values) in [("connectivity", corners), ("offsets", ends)] {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        write_numbers(text, ("Int64", name, 1), &bytes);
    }
    let _ = writeln!(text, "</{element}>");
}
