//! What the yaw is held against, and what it comes to.

use super::super::check::{Check, Tolerance};
use super::inertia::bin_of_table;
use super::{LengthResult, PAPER_RECORD_S};

pub(super) const TITLE: &str =
    "The yaw of a body on a ring of tethers (sec. 4.4.1, figures 13 and 14, table 1)";

pub(super) const PAPER_SHOWS: &str = "Figures 13 (the paper's simulator) and 14 (Project Chrono) show the yaw of a body of 20 kg on tethers of 10, 20 \
and 50 m, which starts at 0.1 rad/s: period and amplitude grow with the length. Table 1 has 0.133, 0.066 and 0.066 Hz \
for both programs. The text has the period grow because the rotation takes longer to travel along the tether.";

const SOURCE: &str = "the closed form of the multifilar pendulum, massless tethers";

pub(super) fn checks(results: &[LengthResult]) -> Vec<Check> {
    results.iter().flat_map(of_length).collect()
}

fn of_length(result: &LengthResult) -> Vec<Check> {
    let mut checks = Vec::new();
    let length_m = result.pendulum.length_m;
    for flight in [&result.lumped, &result.links] {
        let name = flight.formulation.name();
        if let (Some(found), Some(closed_hz)) = (flight.frequency(), result.pendulum.frequency_hz())
        {
            checks.push(
                Check::of(format!("frequency, {length_m} m, {name}"), "Hz", found.hz)
                    .paper(result.paper_hz)
                    .against(closed_hz, Tolerance::Relative(0.01), SOURCE),
            );
        }
        // What has come to its first turning point has shown its amplitude.
        if let (Some(_), Some(amplitude_rad)) =
            (flight.frequency(), result.pendulum.amplitude_rad())
        {
            let ours_deg = flight.amplitude_rad().to_degrees();
            checks.push(
                Check::of(format!("amplitude, {length_m} m, {name}"), "deg", ours_deg)
                    .paper("grows with the length")
                    .against(
                        amplitude_rad.to_degrees(),
                        Tolerance::Relative(0.02),
                        SOURCE,
                    ),
            );
        }
        if let Some(bin) = flight.paper_bin() {
            let paper = bin_of_table(result.paper_hz);
            checks.push(
                Check::of(
                    format!("largest bin of {PAPER_RECORD_S} s, {length_m} m, {name}"),
                    "/15 Hz",
                    bin as f64,
                )
                .paper(paper as f64)
                .as_in_paper("the same", bin == paper),
            );
        }
    }
    checks
}

pub(super) fn sentence(results: &[LengthResult]) -> String {
    let told = |of: &dyn Fn(&LengthResult) -> String| {
        results.iter().map(of).collect::<Vec<_>>().join(", ")
    };
    let closed = told(&|result| {
        let hz = result.pendulum.frequency_hz();
        hz.map_or_else(|| "-".to_owned(), |hz| format!("{hz:.4}"))
    });
    let table = told(&|result| result.paper_hz.to_string());
    let wave = told(&|result| format!("{:.2}", result.wave_s));
    format!(
        "As in the paper period and amplitude grow with the length. Its frequencies ({table} Hz) are bins of a record of \
         {PAPER_RECORD_S} s, and the first of them does not come out with the moment of inertia of its hollow cylinder: those of \
         a multifilar pendulum are {closed} Hz. A wave passes the tethers in {wave} s, so that it does not set the period."
    )
}
