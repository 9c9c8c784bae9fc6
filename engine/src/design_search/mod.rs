//! Design searches: the best values of some fields of a scene, within bounds and constraints.
//!
//! [`specification`] is the file as written: a campaign, and what of it is to be found. [`preparation`] checks it
//! against its scene and makes of it a folder that needs nothing outside of itself; [`definition`] opens such a folder.
//! A design is evaluated by one run, or by the same small campaign as every other design: with the same inputs and
//! seeds, so that designs differ by what they are. [`searching`] goes from a sample of the whole box to local searches
//! from its best designs, which a library does ([`local_search`]), and each asks for designs in turn: the order of
//! evaluations depends on nothing but the file. A line of the [`journal`] is kept of each run; a search that was ended
//! is repeated from its beginning, with runs out of the journal as far as it goes.

pub mod definition;
pub mod design;
pub mod evaluation;
pub mod evaluator;
pub mod journal;
pub mod local_search;
pub mod measure;
pub mod preparation;
pub mod results;
mod scales;
pub mod searching;
pub mod specification;
pub mod summary;
mod variable_check;
