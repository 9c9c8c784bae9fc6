//! The sail against a separate program: a step of its rudder on a rigid line, and the same system steered by a law of
//! four states.

use aerobot_engine::plugin::Simulator;
use aerobot_engine::recording::frame::MemorySink;
use aerobot_engine::scene::SceneError;
use aerobot_report::figure::{Figure, Mark, Series};

use super::super::check::{Check, Tolerance, largest};
use super::super::drawing::{over_time, panel};
use super::super::flight::PaperScene;
use super::{BALLOON, BAND_M, SAIL, arrival_s};

const SCENE: PaperScene = PaperScene {
    name: "scenes/examples/rudder_step.ron",
    text: include_str!("../../../scenes/examples/rudder_step.ron"),
};
const SOURCE: &str = "a separate program";

/// The step by a separate program: time (s), yaw (deg), y of the sail and of the balloon (m).
pub const RUDDER_STEP: [[f64; 4]; 4] = [
    [20.0, -2.378_296, -0.610_464, -0.014_730],
    [30.0, -3.662_328, -2.444_368, -0.260_770],
    [50.0, -4.033_063, -7.480_072, -3.180_744],
    [100.0, -2.647_805, -13.106_748, -14.334_736],
];
/// Target of y (m), time from which on the balloon stays within a metre of it by a separate program, and how long we
/// look (s).
const STEERED: [[f64; 3]; 2] = [[10.0, 71.0, 150.0], [500.0, 483.0, 700.0]];

/// What was flown.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SeparateProgram {
    /// The step: time (s), yaw (deg), y of the sail and of the balloon (m).
    pub step: Vec<[f64; 4]>,
    /// The law of four states: target (m), and the time (s) from which on the balloon stays within a metre.
    pub steered: Vec<(f64, Option<f64>)>,
}

impl SeparateProgram {
    pub(super) fn fly(simulator: &Simulator) -> Result<Self, SceneError> {
        let step = from_steady_state(simulator, &["run.output_every_s=1".to_owned()])?;
        let heading = step.channel(SAIL, "heading_rad");
        let (sail, balloon) = (step.positions(SAIL), step.positions(BALLOON));
        let rows = heading.iter().zip(&sail).zip(&balloon);
        let rows = rows.map(|(((time_s, heading), (_, sail)), (_, balloon))| {
            [*time_s, heading.to_degrees(), sail.y, balloon.y]
        });
        let mut found = Self {
            step: rows.collect(),
            steered: Vec::new(),
        };
        for [target_m, _, until_s] in STEERED {
            let flown = from_steady_state(simulator, &law(target_m, until_s))?;
            let balloon = flown.positions(BALLOON);
            let rows: Vec<(f64, f64)> = balloon.iter().map(|(t, at)| (*t, at.y)).collect();
            found.steered.push((target_m, arrival_s(&rows, target_m)));
        }
        Ok(found)
    }

    pub(super) fn checks(&self) -> Vec<Check> {
        let difference = |column: usize| {
            let rows = RUDDER_STEP.iter().map(|row| {
                let ours = self.step.iter().find(|own| own[0] == row[0]);
                ours.map_or(f64::NAN, |ours| (ours[column] - row[column]).abs())
            });
            largest(rows)
        };
        let mut checks = Vec::new();
        for (what, unit, column) in [
            ("turn of the sail", "deg", 1),
            ("y of the sail", "m", 2),
            ("y of the balloon", "m", 3),
        ] {
            let [.., last] = &RUDDER_STEP;
            let ours = self.step.last().map_or(f64::NAN, |row| row[column]);
            let step = "50 s after 40 s with the rudder 1 deg over, on a rigid line";
            let check = Check::of(format!("{what} {step}"), unit, ours);
            checks.push(check.against(last[column], Tolerance::Absolute(1e-4), SOURCE));
            let what = format!("{what}, largest difference at 20, 30, 50 and 100 s");
            checks.push(Check::of(what, unit, difference(column)).vanishes(1e-4, SOURCE));
        }
        for ((target_m, arrived_s), [_, expected_s, _]) in self.steered.iter().zip(STEERED) {
            let what = format!(
                "time after which a law of four states keeps the balloon within {BAND_M} m of {target_m} m"
            );
            let check = Check::of(what, "s", arrived_s.unwrap_or(f64::NAN));
            checks.push(check.against(expected_s, Tolerance::Absolute(2.0), SOURCE));
        }
        checks
    }

    pub(super) fn figure(&self) -> Figure {
        let panels = [
            ("turn of the sail [deg]", 1),
            ("y of the sail [m]", 2),
            ("y of the balloon [m]", 3),
        ];
        let panels = panels.map(|(label, column)| {
            let of = |rows: &[[f64; 4]]| -> Vec<(f64, f64)> {
                rows.iter().map(|row| (row[0], row[column])).collect()
            };
            panel(
                label,
                vec![
                    Series::line("aerobot", of(&self.step)).with_tone(0),
                    Series::line(SOURCE, of(&RUDDER_STEP))
                        .with_mark(Mark::Points)
                        .with_tone(1),
                ],
            )
        });
        over_time(
            "sail-rudder-step",
            "A step of the rudder, beside a separate program",
            "The rudder is 1 deg over from 10 to 50 s; the line is rigid and has neither mass nor drag.",
            panels.into(),
        )
    }
}

/// Feeds back y and velocity of the balloon, and those of the sail against it.
fn law(target_m: f64, until_s: f64) -> Vec<String> {
    vec![
        format!("run.duration_s={until_s:?}"),
        "run.output_every_s=1".to_owned(),
        "entities.sail.Sail.rudder.deflection=(limit: 0.2617993877991494, rate_per_s: 0.08726646259971647, lag_s: 0.5)"
            .to_owned(),
        format!(
            "entities.helm=(Controller: (actuator: (\"sail\", \"rudder\"), period_s: 0.5, law: StateFeedback(terms: [\
             (measured: Y(\"balloon\"), target: {target_m:?}, gain: -0.005235987755982988, clip: 100), \
             (measured: VelocityY(\"balloon\"), gain: -0.17453292519943295), \
             (measured: Difference(Y(\"sail\"), Y(\"balloon\")), gain: -0.006981317007977318), \
             (measured: Difference(VelocityY(\"sail\"), VelocityY(\"balloon\")), gain: -0.17453292519943295)])))"
        ),
    ]
}

/// A flight from the steady state in the scene's wind.
fn from_steady_state(
    simulator: &Simulator,
    overrides: &[String],
) -> Result<MemorySink, SceneError> {
    let scene = SCENE.load(simulator, overrides)?;
    let mut simulation = simulator.build(&scene)?;
    simulation.settle_in_wind(&scene)?;
    let mut results = MemorySink::default();
    simulation.run(&mut results, &mut |_| {});
    Ok(results)
}
