//! The text of a scene with every copy of an entity written out, so that each can have a start of its own.

use std::ops::Range;

use crate::scene::copies::{COPIES, numbered_text};
use crate::scene::groups::{Group, Groups};
use crate::scene::source::{Entry, FieldPath, Kind, Node, Scalar, scan};

/// A part of the text, and what stands in its place.
type Replacement = (Range<usize>, String);

/// `text` with an entity for every copy, also where they are recorded.
pub(super) fn with_copies_written_out(text: &str, groups: &Groups) -> String {
    let copied: Vec<&Group> = groups.iter().filter(|g| g.component == COPIES).collect();
    let mut result = text.to_owned();
    let (false, Ok(root)) = (copied.is_empty(), scan(text)) else {
        return result;
    };
    let mut replacements: Vec<Replacement> = Vec::new();
    for group in copied {
        for path in ["entities", "run.record.channels.0"] {
            let entry = entries(&root, path)
                .iter()
                .find(|entry| entry.name == group.name);
            replacements.extend(entry.map(|entry| entry_of_each(text, entry, group)));
        }
        replacements.extend(recorded(text, &root, group));
    }
    replacements.sort_by_key(|(range, _)| std::cmp::Reverse(range.start));
    for (range, new) in replacements {
        result.replace_range(range, &new);
    }
    result
}

fn at<'a>(root: &'a Node, path: &str) -> Option<&'a Node> {
    root.get(&path.parse::<FieldPath>().ok()?)
}

fn entries<'a>(root: &'a Node, path: &str) -> &'a [Entry] {
    match at(root, path).map(|node| &node.kind) {
        Some(Kind::Map { entries }) => entries,
        _ => &[],
    }
}

/// An entry of a map once for every copy, on lines of their own if it has some.
fn entry_of_each(text: &str, entry: &Entry, group: &Group) -> Replacement {
    let range = entry.key.span.start..entry.value.span.end;
    let line = text[..range.start]
        .rfind('\n')
        .map_or(0, |newline| newline + 1);
    let before = &text[line..range.start];
    let between = if before.trim().is_empty() {
        format!(",\n{before}")
    } else {
        ", ".to_owned()
    };
    let value = without_copies(text, &entry.value);
    let tree = scan(&value).ok();
    let entries = group.members.iter().zip(1..).map(|(name, number)| {
        let own = tree.as_ref();
        let own = own.and_then(|tree| numbered_text(&value, tree, number));
        format!("\"{name}\": {}", own.as_deref().unwrap_or(&value))
    });
    (range, entries.collect::<Vec<_>>().join(&between))
}

/// The text of an entity without its `Copies`.
fn without_copies(text: &str, value: &Node) -> String {
    let mut own = text[value.span.clone()].to_owned();
    let Kind::Struct { fields, .. } = &value.kind else {
        return own;
    };
    if let Some(field) = fields.iter().find(|field| field.name == COPIES) {
        let after = &text[field.value.span.end..value.span.end];
        let rest = after.trim_start();
        let rest = rest.strip_prefix(',').unwrap_or(rest).trim_start();
        let end = value.span.end - rest.len();
        let start = value.span.start;
        own.replace_range(field.name_span.start - start..end - start, "");
    }
    own
}

/// The name of the group in the list of what has its instruments recorded, for every copy.
fn recorded(text: &str, root: &Node, group: &Group) -> Option<Replacement> {
    let Kind::List(names) = &at(root, "run.record.instruments.0")?.kind else {
        return None;
    };
    let quoted = format!("\"{}\"", group.name);
    let name = names.iter().find(|name| {
        name.kind == Kind::Scalar(Scalar::Text) && text[name.span.clone()] == quoted
    })?;
    let members = group.members.iter().map(|member| format!("\"{member}\""));
    Some((name.span.clone(), members.collect::<Vec<_>>().join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plugin::Simulator;

    #[test]
    fn copies_are_written_out_wherever_they_are_named() {
        let text = r##"(
    name: "row",
    entities: {
        "mast": (
            Copies: (count: 2, step_m: (5, 0, 0)), // two
            Fixed: (position_m: (0, 0, 0)),
        ),
        "buoy": (Body: (mass_kg: 1), Copies: (count: 2)),
        "line": (Copies: (count: 2), Tether: (
            from: ("mast/#", Centre), to: ("buoy/#", Centre), length_m: 1, nodes: 0, axial_stiffness_n: 10,
        )),
    },
    run: (
        duration_s: 1, output_every_s: 1,
        record: (channels: Only({"buoy": ["tilt_rad"]}), instruments: Only(["buoy"])),
    ),
)"##;
        let simulator = Simulator::new();
        let folder = std::path::Path::new(".");
        let scene = simulator
            .load_text("row.ron", text.to_owned(), folder, &[])
            .map_err(|error| println!("{error}"))
            .ok();
        let groups = scene.map(|scene| scene.groups).unwrap_or_default();
        let expected = r##"(
    name: "row",
    entities: {
        "mast/1": (
            // two
            Fixed: (position_m: (0, 0, 0)),
        ),
        "mast/2": (
            // two
            Fixed: (position_m: (0, 0, 0)),
        ),
        "buoy/1": (Body: (mass_kg: 1), ),
        "buoy/2": (Body: (mass_kg: 1), ),
        "line/1": (Tether: (
            from: ("mast/1", Centre), to: ("buoy/1", Centre), length_m: 1, nodes: 0, axial_stiffness_n: 10,
        )),
        "line/2": (Tether: (
            from: ("mast/2", Centre), to: ("buoy/2", Centre), length_m: 1, nodes: 0, axial_stiffness_n: 10,
        )),
    },
    run: (
        duration_s: 1, output_every_s: 1,
        record: (channels: Only({"buoy/1": ["tilt_rad"], "buoy/2": ["tilt_rad"]}), instruments: Only(["buoy/1", "buoy/2"])),
    ),
)"##;
        assert_eq!(with_copies_written_out(text, &groups), expected);
    }
}
