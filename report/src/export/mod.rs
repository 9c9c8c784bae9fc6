//! Animations for other programs.
//!
//! | module | for |
//! |---|---|
//! | [`gltf`] | Blender, engines, viewers in browsers: glTF 2.0, one binary file |
//! | [`vtk`] | ParaView and the like: numbers at every frame |

pub mod gltf;
mod meshes;
pub mod vtk;

use std::io;
use std::path::PathBuf;

use thiserror::Error;

use crate::animation::Animation;

/// Why an animation is not written.
#[derive(Debug, Error)]
pub enum ExportError {
    /// The run has no frame, or no body in it.
    #[error("error: nothing to show: the run has recorded no body")]
    Empty,
    /// A binary glTF file has at most 4 GiB.
    #[error(
        "error: the animation takes more than the 4 GiB of a glTF file\n  = help: ask for fewer frames with `--frames`"
    )]
    TooLarge,
    /// The file system refused something.
    #[error("error: cannot write `{path}`: {error}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
}

/// Refuses an animation in which there is nothing.
fn check_not_empty(animation: &Animation) -> Result<(), ExportError> {
    if animation.bodies.is_empty() || animation.times_s.is_empty() {
        return Err(ExportError::Empty);
    }
    Ok(())
}
