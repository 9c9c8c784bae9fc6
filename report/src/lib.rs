//! What runs and campaigns look like: their records read back, figures of them, animations and pages.
//!
//! | module | subject |
//! |---|---|
//! | [`record`] | a run as it was recorded, from its folder or from memory |
//! | [`animation`] | how a run moves: bodies with their shapes, tethers, wind, frame by frame |
//! | [`campaign`] | a finished campaign, and figures of its runs together |
//! | [`export`] | an animation as glTF and as VTK files, for other programs |
//! | [`figure`] | a figure as data, drawn as SVG or as part of a page |
//! | [`page`] | one HTML file with figures and a view that plays |
//! | [`run_figures`] | the figures of a run, and of two runs in one |
//! | [`spectrum`] | amplitude spectra and their peaks |
//! | [`table_figures`] | figures of tables that studies wrote |

pub mod animation;
pub mod campaign;
pub mod export;
pub mod figure;
pub mod page;
pub mod record;
pub mod run_figures;
pub mod spectrum;
pub mod table_figures;
