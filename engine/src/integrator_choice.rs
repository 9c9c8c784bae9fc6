//! From what a scene asks of its integrator to the method that does it.

use aerobot_components::run::{FixedMethod, IntegratorSpec};
use aerobot_systems::integration::Integrator;
use aerobot_systems::integration::automatic::Automatic;
use aerobot_systems::integration::dormand_prince::DormandPrince;
use aerobot_systems::integration::rosenbrock::Rosenbrock;
use aerobot_systems::integration::runge_kutta4::RungeKutta4;

use crate::scene::{Scene, SceneError, SetupError};
use crate::stable_step::StableStep;

/// RK4 steps of this part of the largest stable one unless the scene says otherwise.
const DEFAULT_PART_OF_STABLE_STEP: f64 = 0.5;
/// Without a tether nothing limits the step of RK4; then it is this, s.
const DEFAULT_STEP_S: f64 = 1e-3;
/// First step of an adaptive explicit integration, as a part of the stable one.
const FIRST_PART_OF_STABLE_STEP: f64 = 0.1;

/// A method that was chosen.
pub(crate) struct Choice {
    pub(crate) integrator: Box<dyn Integrator>,
    /// The step of a fixed-step explicit method, s.
    pub(crate) step_s: Option<f64>,
    /// The method with its settings, in words.
    pub(crate) description: String,
}

/// Whether the method asks for the linearised motion, or measures its errors with it.
pub(crate) fn is_linearised(integrator: &IntegratorSpec) -> bool {
    match integrator {
        IntegratorSpec::Auto { .. } | IntegratorSpec::Implicit { .. } => true,
        IntegratorSpec::Fixed { method, .. } => *method == FixedMethod::Rosenbrock,
        IntegratorSpec::Adaptive { .. } => false,
    }
}

/// The method that the scene asks for; `scales` has the length of the state.
///
/// # Errors
/// A fixed step that is not stable.
pub(crate) fn choose_integrator(
    scene: &Scene,
    stable: &StableStep,
    scales: Vec<f64>,
) -> Result<Choice, SceneError> {
    let length = scales.len();
    let without_step = |integrator: Box<dyn Integrator>, description: String| {
        Ok(Choice {
            integrator,
            step_s: None,
            description,
        })
    };
    match scene.run.integrator {
        IntegratorSpec::Auto {
            accuracy_m,
            longest_step_s,
        } => {
            let longest_s = longest_step_s.unwrap_or(f64::INFINITY);
            let method = Automatic::new(accuracy_m, length, longest_s, stable.step_s);
            without_step(
                Box::new(method),
                format!("Auto (ROS34PW2 or RK4(3)), accuracy {accuracy_m:e} m"),
            )
        }
        IntegratorSpec::Implicit {
            accuracy_m,
            longest_step_s,
        } => {
            let longest_s = longest_step_s.unwrap_or(f64::INFINITY);
            let method = Rosenbrock::controlled(accuracy_m, length, longest_s);
            without_step(
                Box::new(method),
                format!("ROS34PW2, accuracy {accuracy_m:e} m"),
            )
        }
        IntegratorSpec::Adaptive {
            relative_tolerance,
            longest_step_s,
        } => {
            let first_s = (FIRST_PART_OF_STABLE_STEP * stable.step_s).min(DEFAULT_STEP_S);
            let longest_s = longest_step_s.unwrap_or(f64::INFINITY);
            let method = DormandPrince::new(relative_tolerance, scales, first_s, longest_s);
            without_step(
                Box::new(method),
                format!("Dormand-Prince 5(4), relative tolerance {relative_tolerance:e}"),
            )
        }
        IntegratorSpec::Fixed {
            step_s: Some(step_s),
            method: FixedMethod::Rosenbrock,
        } => without_step(
            Box::new(Rosenbrock::fixed(step_s, length)),
            format!("ROS34PW2, step {step_s:e} s"),
        ),
        IntegratorSpec::Fixed { step_s, .. } => runge_kutta_4(scene, stable, step_s),
    }
}

fn runge_kutta_4(
    scene: &Scene,
    stable: &StableStep,
    step_s: Option<f64>,
) -> Result<Choice, SceneError> {
    let default_s = if stable.step_s.is_finite() {
        DEFAULT_PART_OF_STABLE_STEP * stable.step_s
    } else {
        DEFAULT_STEP_S
    };
    let chosen_s = step_s.unwrap_or(default_s);
    if chosen_s > stable.step_s {
        return Err(scene.refuse(SetupError::new(
            "run.integrator.step_s",
            format!(
                "a step of {chosen_s} s is not stable: the largest stable one is {:.4e} s, \
                 set by segment `{}`",
                stable.step_s, stable.segment
            ),
            "choose a shorter step, leave it out, or use `Auto()`",
        )));
    }
    Ok(Choice {
        integrator: Box::new(RungeKutta4::new(chosen_s)),
        step_s: Some(chosen_s),
        description: format!("RK4, step {chosen_s:e} s"),
    })
}
