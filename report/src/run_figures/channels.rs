//! Channels: what controllers ask and actuators do, and everything that instruments recorded.

use std::collections::BTreeMap;

use super::{nothing, unit};
use crate::figure::{Axis, Figure, Panel, Series};
use crate::record::{ChannelTrack, Record};

/// Channels of these are shown elsewhere.
const SYSTEM: &str = "system";
const COMMAND: &str = "command_";

/// Commands beside what became of them, an axis for each unit of which there are any.
pub(super) fn commands(record: &Record) -> Result<Figure, String> {
    let all = &record.tables.channels;
    let of_command = |channel: &str| channel.contains(COMMAND);
    let answers = |track: &ChannelTrack| {
        all.iter().any(|other| {
            of_command(&other.channel)
                && other.entity == track.entity
                && other.channel.replace(COMMAND, "") == track.channel
        })
    };
    let shown = all
        .iter()
        .filter(|track| of_command(&track.channel) || answers(track));
    let mut panels: BTreeMap<String, Panel> = BTreeMap::new();
    for (tone, track) in shown.enumerate() {
        let answer = track.channel.replace(COMMAND, "");
        let panel = panels.entry(answer.clone()).or_insert_with(|| Panel {
            x: Axis::time(),
            y: Axis::new(unit::label(&answer)),
            ..Panel::default()
        });
        let (name, _) = unit::of_channel(&track.channel);
        panel
            .series
            .push(line(track, format!("{}: {name}", track.entity)).with_tone(tone));
    }
    figure("Commands and actuators", panels)
        .ok_or_else(|| "no channel of a command was recorded".to_owned())
}

/// Every other channel, a panel for each name.
pub(super) fn others(record: &Record) -> Result<Figure, String> {
    let all = &record.tables.channels;
    let is_answer = |track: &ChannelTrack| {
        all.iter().any(|other| {
            other.entity == track.entity
                && other.channel.replace(COMMAND, "") == track.channel
                && other.channel != track.channel
        })
    };
    let mut panels: BTreeMap<String, Panel> = BTreeMap::new();
    let mut entities: Vec<&str> = Vec::new();
    for track in all {
        if track.entity == SYSTEM || track.channel.contains(COMMAND) || is_answer(track) {
            continue;
        }
        let known = entities.iter().position(|entity| *entity == track.entity);
        let tone = known.unwrap_or_else(|| {
            entities.push(&track.entity);
            entities.len() - 1
        });
        let panel = panels
            .entry(track.channel.clone())
            .or_insert_with(|| Panel {
                x: Axis::time(),
                y: Axis::new(unit::label(&track.channel)),
                ..Panel::default()
            });
        panel
            .series
            .push(line(track, track.entity.clone()).with_tone(tone));
    }
    match figure("Channels of instruments", panels) {
        Some(figure) => Ok(figure),
        None => nothing("no channel was recorded"),
    }
}

fn figure(title: &str, panels: BTreeMap<String, Panel>) -> Option<Figure> {
    (!panels.is_empty()).then(|| Figure {
        title: title.to_owned(),
        panels: panels.into_values().collect(),
        ..Figure::default()
    })
}

fn line(track: &ChannelTrack, name: String) -> Series {
    let points = track
        .times_s
        .iter()
        .copied()
        .zip(track.values.iter().copied());
    Series::line(name, points)
}
