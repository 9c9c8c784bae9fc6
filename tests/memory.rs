//! Memory does not grow with simulated time. Alone in its file, so that no other test allocates in the
//! same process meanwhile.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod flight;

use std::fs;

use aerobot::engine::plugin::Simulator;
use aerobot::engine::recording::frame::NullSink;
use flight::load;

/// Resident memory of this process, bytes.
fn resident_bytes() -> usize {
    let text = fs::read_to_string("/proc/self/statm").unwrap();
    let pages: usize = text.split_whitespace().nth(1).unwrap().parse().unwrap();
    pages * 4096
}

/// Twenty times the simulated time, and a slack event at every bounce, on the same memory.
#[test]
#[cfg(target_os = "linux")]
fn memory_does_not_grow_with_simulated_time() {
    let text = r#"(
        name: "bouncing",
        environment: (atmosphere: Vacuum),
        entities: {
            "top": (Fixed: (position_m: (0, 0, 0))),
            "ball": (Body: (mass_kg: 1), Pose: (position_m: (0, 0, -0.5))),
            "line": (Tether: (
                from: ("top", Centre), to: ("ball", Centre),
                length_m: 1, nodes: 0, axial_stiffness_n: 1000,
            )),
        },
        run: (duration_s: 200, output_every_s: 0.1),
    )"#;
    let simulator = Simulator::new();
    let grown = |duration: &str| {
        let scene = load(&simulator, text, &[duration]);
        let mut simulation = simulator.build(&scene).unwrap();
        let before = resident_bytes();
        let summary = simulation.run(&mut NullSink, &mut |_| {});
        assert!(summary.events.len() <= 1000);
        resident_bytes().saturating_sub(before)
    };
    let _warm = grown("run.duration_s=200");
    let long = grown("run.duration_s=4000");
    assert!(long < 1 << 20, "{long} bytes");
}
