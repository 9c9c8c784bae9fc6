//! What a scene records: found by running it, since instruments of any plugin may add to it.

use std::collections::BTreeSet;
use std::io;

use super::quantity::{Quantity, recorded};
use crate::recording::frame::{Frame, ResultSink};

/// Collects names until all that is wanted has been seen, and then ends the run.
pub(super) struct Probe<'a> {
    pub(super) wanted: Vec<&'a Quantity>,
    /// Entities and channels.
    pub(super) seen: BTreeSet<(String, String)>,
}

impl ResultSink for Probe<'_> {
    fn take(&mut self, frame: &Frame) -> io::Result<()> {
        self.wanted
            .retain(|quantity| quantity.read(frame).is_none());
        if self.wanted.is_empty() {
            return Err(io::Error::other("all is seen"));
        }
        self.seen.extend(recorded(frame));
        Ok(())
    }
}

impl Probe<'_> {
    /// Why a quantity was not seen, and what may have been meant.
    pub(super) fn why(&self, quantity: &Quantity) -> (&'static str, String, String) {
        let Quantity {
            entity,
            channel,
            segment,
        } = quantity;
        let of_entity: Vec<&str> = (self.seen.iter())
            .filter(|(owner, _)| owner == entity)
            .map(|(_, channel)| channel.as_str())
            .collect();
        let listed = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
            names.join(", ")
        };
        if of_entity.is_empty() {
            let mut owners: Vec<&str> = self.seen.iter().map(|(owner, _)| owner.as_str()).collect();
            owners.dedup();
            let message = format!("nothing is recorded of `{entity}`");
            return ("entity", message, format!("there is {}", listed(&owners)));
        }
        if let (Some(number), true) = (segment, of_entity.contains(&channel.as_str())) {
            return (
                "segment",
                format!("`{entity}` has no segment {number}"),
                String::new(),
            );
        }
        let message = format!("no channel `{channel}` of `{entity}` is recorded");
        (
            "channel",
            message,
            format!("there is {}", listed(&of_entity)),
        )
    }
}
