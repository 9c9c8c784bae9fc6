//! A line that hangs slack and snaps taut, against a separate program (explicit, of eighth order, in 80-bit
//! arithmetic, with every change from slack to taut located).

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on fails"
)]

mod flight;

use flight::{assert_below, assert_relative, fly, position, summary_of};
use glam::DVec3;

const SNAP: &str = r#"(
    name: "snap", environment: (atmosphere: Vacuum),
    entities: {
        "top": (Fixed: (position_m: (0, 0, 0))),
        "probe": (Body: (mass_kg: 10), Pose: (position_m: (20, 0, -96.9587))),
        "line": (Tether: (
            from: ("top", Centre), to: ("probe", Centre), length_m: 100, nodes: 20,
            diameter_m: 0.003, density_kg_m3: 1414.7106052612919, // 0.01 kg/m
            axial_stiffness_n: 1e5, damping_n_s_m: 0.1543033499620919, // 0.1 sqrt(k_N m_node) a segment
            lumping: Interior, start: Straight,
        )),
    },
    run: (duration_s: 0.8, output_every_s: 0.1, record: (channels: All)),
)"#;

/// Time in s; probe, nodes 1, 7, 14 and 20, (x, z) in m: from the separate program, which locates every
/// instant at which a segment goes taut or slack; good to 1e-10 m.
const SNAP_ROWS: [(f64, [[f64; 2]; 5]); 3] = [
    (
        0.4,
        [
            [20.0, -97.6683],
            [0.86553961010, -4.68435062940],
            [6.59414887817, -32.67760514147],
            [13.32843656653, -65.32499412614],
            [19.04761904762, -93.05121904762],
        ],
    ),
    (
        0.6,
        [
            [19.97378447053, -98.42820881712],
            [0.91610242726, -4.69717305993],
            [6.45281866151, -32.87110865741],
            [13.21529637697, -65.66349784117],
            [19.00843758013, -93.74826984004],
        ],
    ),
    (
        0.8,
        [
            [19.67550717169, -98.22397985204],
            [0.93261137265, -4.67934082379],
            [6.55354307578, -32.75122423884],
            [12.95325037287, -65.52950895296],
            [18.71236830806, -93.55473531735],
        ],
    ),
];

/// From slack to taut: the probe to 1 mm at every tolerance from 1 cm down and the nodes at the end at a
/// tight one (in between, folds that open amplify any difference); the peak to 1 % at a tight tolerance,
/// to 12 % at 1 cm. The separate program has 616.139 N.
#[test]
fn a_snap_follows_the_separate_program() {
    for method in ["Implicit", "Auto"] {
        for accuracy in ["0.01", "0.001", "1e-5"] {
            let integrator = format!("run.integrator={method}(accuracy_m: {accuracy})");
            let (results, summary) = summary_of(SNAP, &[&integrator]);
            let what = format!("{method} at {accuracy} m");
            let is_tight = accuracy == "1e-5";
            for (time_s, row) in SNAP_ROWS {
                let entities = ["probe", "line/1", "line/7", "line/14", "line/20"];
                let checked = if is_tight && time_s == 0.8 { 5 } else { 1 };
                for (entity, [x, z]) in entities.into_iter().zip(row).take(checked) {
                    let found = position(&results, entity, time_s);
                    let error = (found - DVec3::new(x, 0.0, z)).length();
                    assert_below(&format!("{what}, {entity} at {time_s} s"), error, 1e-3);
                }
            }
            let peak = summary.largest_tension.unwrap().tension_n;
            let allowed = if is_tight { 0.01 } else { 0.12 };
            assert_relative(&format!("{what}, first peak, N"), peak, 616.139, allowed);
        }
    }
}

/// No tolerance makes energy: 20 s of going slack and snapping taut.
#[test]
fn a_snapping_line_gains_no_energy_at_any_tolerance() {
    for method in ["Implicit", "Auto"] {
        for accuracy in ["1", "0.1", "0.01", "0.001", "1e-4"] {
            let integrator = format!("run.integrator={method}(accuracy_m: {accuracy})");
            let overrides = [&*integrator, "run.duration_s=20", "run.output_every_s=0.05"];
            let results = fly(SNAP, &overrides);
            let channel = |name: &str| -> Vec<f64> {
                let rows = results.frames.iter().flat_map(|frame| &frame.channels);
                rows.filter(|row| row.channel == name)
                    .map(|row| row.value)
                    .collect()
            };
            let energy = channel("mechanical_energy_j");
            let kinetic = channel("kinetic_energy_j").into_iter().fold(0.0, f64::max);
            assert_eq!(energy.len(), 401);
            let gain = energy
                .iter()
                .fold(0.0, |most, e| f64::max(most, e - energy[0]));
            println!("{method} at {accuracy} m: gain {gain:.3e} J of {kinetic:.1} J kinetic");
            assert!(gain <= 1e-3 * kinetic, "{gain} {kinetic}");
        }
    }
}

/// In a burst of snaps the explicit method is cheaper, and `Auto` takes it.
#[test]
fn auto_goes_explicit_through_a_burst_of_snaps_and_says_so() {
    let overrides = ["run.duration_s=20", "run.integrator=Auto(accuracy_m: 0.01)"];
    let (_, summary) = summary_of(SNAP, &overrides);
    println!(
        "{} of {} steps implicit",
        summary.implicit_steps, summary.steps
    );
    assert!(summary.implicit_steps > 0 && summary.implicit_steps < summary.steps / 2);
}
