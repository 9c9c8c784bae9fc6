//! What runs and campaigns look like: their records read back, figures of them, animations and pages.
//!
//! | module | subject |
//! |---|---|
//! | [`record`] | a run as it was recorded, from its folder or from memory |
//! | [`animation`] | how a run moves: bodies with their shapes, tethers, wind, frame by frame |
//! | [`figure`] | a figure as data, drawn as SVG or as part of a page |
//! | [`page`] | one page that shows runs |
//! | [`run_figures`] | the figures of a run, and of two runs in one |
//! | [`spectrum`] | amplitude spectra and their peaks |

pub mod animation;
pub mod figure;
pub mod page;
pub mod record;
pub mod run_figures;
pub mod spectrum;
