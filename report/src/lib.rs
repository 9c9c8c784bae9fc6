//! What runs and campaigns look like: their records read back, figures of them, animations and pages.
//!
//! | module | subject |
//! |---|---|
//! | [`record`] | a run as it was recorded, from its folder or from memory |
//! | [`animation`] | how a run moves: bodies with their shapes, tethers, wind, frame by frame |
//! | [`campaign`] | a finished campaign, and figures of its runs together |
//! | [`export`] | an animation as glTF and as VTK files, for other programs |
//! | [`figure`] | a figure as data, drawn as SVG or as part of a page |

pub mod animation;
pub mod campaign;
pub mod export;
pub mod figure;
pub mod record;
