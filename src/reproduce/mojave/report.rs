//! The Mojave case as a text and as tables.

use aerobot_engine::modes::Motion;
use aerobot_engine::recording::number::number_text;
use aerobot_report::spectrum::{Spectrum, peak_near, peaks};

use super::super::check::{Check, Tolerance, Verdict, largest};
use super::super::flight::row;
use super::super::{Report, Table};
use super::{BALLOON, CALM_S, GONDOLA, MojaveSettings, MojaveStudy, OffsetFlight, OffsetResult};

const TITLE: &str =
    "Pendulum and torsion coupled: the test in the Mojave desert (sec. 4.3.1, figure 11)";

const PAPER_SHOWS: &str = "Figure 11 is a photograph from the balloon down to the gondola on its tethers. The text says that the \
simulator was used to prove the origin of a pendulum-torsion coupling that the flight showed, and that it will not be \
explained there. There are no numbers.";

const HEAD: &str = "\
A gondola of 10 kg on a ring of three tethers of 10 m below a balloon in the air of Earth, after a gust along x (paper,
sec. 4.3.1, figure 11).

The paper names a coupled motion of pendulum and torsion and does not explain it; it has no numbers, and those of
`scenes/paper/mojave_test.ron` are chosen. Here a centre of mass beside the axis of the ring couples them: the gust is
along x, the offset along y. Frequencies in Hz: modes of small motions, peaks of the spectrum of the flight after the
gust, closed forms for massless tethers.
";

/// Peaks lower than this part of the highest are not told.
const LEAST_PEAK: f64 = 0.05;
/// Shorter flights do not tell the frequencies apart, s.
const RESOLVED_S: f64 = 250.0;

pub(super) fn report(settings: &MojaveSettings, found: &MojaveStudy) -> Report {
    let checks = checks(settings, found);
    let mut text = HEAD.to_owned();
    for result in &found.offsets {
        text.push_str(&offset(result));
    }
    Report {
        figures: Vec::new(),
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        text,
        verdict: Verdict::of(&checks, sentence(found)),
        checks,
        tables: vec![
            table("mojave_motion.csv", motion(found)),
            table("mojave_spectrum.csv", spectra(found)),
            table("mojave_modes.csv", modes(found)),
        ],
        stopped: flights(found)
            .filter_map(|flown| {
                flown
                    .flight
                    .stop_of(&format!("mojave: {} m", flown.offset_m))
            })
            .collect(),
    }
}

fn table(file_name: &'static str, text: String) -> Table {
    Table { file_name, text }
}

fn flights(found: &MojaveStudy) -> impl Iterator<Item = &OffsetFlight> {
    let lumped = found.offsets.iter().map(|result| &result.flown);
    lumped.chain([&found.links])
}

/// Largest size of a record.
fn size(record: &[(f64, f64)]) -> f64 {
    largest(record.iter().map(|(_, value)| value.abs()))
}

fn sentence(found: &MojaveStudy) -> String {
    let turned = found.offsets.iter().map(|result| {
        let degrees = size(&result.flown.turn()).to_degrees();
        format!("{degrees:.2} deg at {} m", result.flown.offset_m)
    });
    format!(
        "The paper shows no numbers to agree with. A coupling of pendulum and torsion as it reports comes about where the \
         centre of mass is beside the axis of the ring: the swing turns the gondola by {}.",
        turned.collect::<Vec<_>>().join(", ")
    )
}

fn checks(settings: &MojaveSettings, found: &MojaveStudy) -> Vec<Check> {
    let mut checks = Vec::new();
    for result in &found.offsets {
        checks.extend(of_modes(result));
        if settings.duration_s >= RESOLVED_S {
            checks.extend(of_peaks(result));
        }
        if result.flown.offset_m == 0.0 {
            let what = "turn of a gondola on the axis";
            checks.push(
                Check::of(what, "rad", size(&result.flown.turn()))
                    .vanishes(1e-9, "mirror symmetry, to round-off"),
            );
        }
    }
    checks.extend(mirrored(found));
    if settings.duration_s > CALM_S {
        checks.extend(other_formulation(found));
    }
    checks
}

fn of_modes(result: &OffsetResult) -> [Check; 2] {
    let offset = number_text(result.flown.offset_m);
    let mode = |motion, what: &str| {
        let hz = result.mode_hz(motion).unwrap_or(f64::NAN);
        Check::of(format!("{what}, offset {offset} m"), "Hz", hz)
    };
    [
        mode(Motion::X, "mode of the swing").against(
            result.pair.swing_hz(),
            Tolerance::Relative(0.005),
            "the closed form of a dumbbell, massless tethers",
        ),
        mode(Motion::Yaw, "mode of the turn").against(
            result.pair.yaw_hz(),
            Tolerance::Relative(0.005),
            "the closed form of a multifilar pendulum off its axis, massless tethers",
        ),
    ]
}

/// The flight shows the frequencies of the modes, where they are far enough apart.
fn of_peaks(result: &OffsetResult) -> Vec<Check> {
    let offset = number_text(result.flown.offset_m);
    let (swing_hz, turn_hz) = (result.mode_hz(Motion::X), result.mode_hz(Motion::Yaw));
    let mut wanted = vec![("swing", &result.swing, "swing", swing_hz)];
    if result.flown.offset_m != 0.0 {
        wanted.push(("turn", &result.turn, "turn", turn_hz));
    }
    if turns_apart(result) && result.flown.offset_m != 0.0 {
        wanted.push(("turn", &result.turn, "swing", swing_hz));
    }
    let near = |(record, spectrum, mode, hz): (&str, &Spectrum, &str, Option<f64>)| {
        let hz = hz.unwrap_or(f64::NAN);
        let peak = peak_near(spectrum, hz, LEAST_PEAK);
        let peak_hz = peak.map_or(f64::NAN, |peak| peak.frequency_hz);
        let what = format!(
            "peak in the spectrum of the {record} near the mode of the {mode}, offset {offset} m"
        );
        Check::of(what, "Hz", peak_hz).against(
            hz,
            Tolerance::Relative(0.005),
            "the linearised forces' eigenvalues",
        )
    };
    wanted.into_iter().map(near).collect()
}

/// Whether both modes stand in a spectrum of this length.
fn turns_apart(result: &OffsetResult) -> bool {
    let (Some(swing_hz), Some(turn_hz)) = (result.mode_hz(Motion::X), result.mode_hz(Motion::Yaw))
    else {
        return false;
    };
    // A Hann window widens a line to four bins.
    (swing_hz - turn_hz).abs() * (result.flown.flight.simulated_s - CALM_S) > 2.0
}

/// An offset to the other side gives the mirror image; half the offset half the turn.
fn mirrored(found: &MojaveStudy) -> Vec<Check> {
    let mut checks = Vec::new();
    for result in &found.offsets {
        let own = &result.flown;
        let other = found
            .offsets
            .iter()
            .map(|other| &other.flown)
            .find(|other| own.offset_m > 0.0 && other.offset_m == -own.offset_m);
        if let Some(other) = other {
            let pairs = own.turn().into_iter().zip(other.turn());
            let sums = pairs.map(|((_, a), (_, b))| (a + b).abs());
            let part = 100.0 * largest(sums) / size(&own.turn());
            let what = format!("turns of offsets {} m to either side, added", own.offset_m);
            checks.push(Check::of(what, "%", part).vanishes(1e-3, "mirror symmetry"));
        }
    }
    checks
}

/// The turn in rigid links: the formulations must approach each other as 1/EA.
fn other_formulation(found: &MojaveStudy) -> Vec<Check> {
    let offset = number_text(found.links.offset_m);
    let [first, .., last] = found.limit.as_slice() else {
        return Vec::new();
    };
    let power = libm::log(first.1 / last.1) / libm::log(last.0 / first.0);
    let (less, more) = (number_text(first.0), number_text(last.0));
    let part = 100.0 * last.1 / last.2;
    vec![
        Check::of(
            format!("power of 1/EA in which the turns of the formulations approach, EA x {less} to {more}, offset {offset} m"),
            "",
            power,
        )
        .against(1.0, Tolerance::Absolute(0.1), "first order in the stretch, which is as 1/EA"),
        Check::of(
            format!("difference of the turn from inextensible links, EA x {more}, offset {offset} m"),
            "%",
            part,
        )
        .vanishes(1.0, "the other formulation"),
    ]
}

fn offset(result: &OffsetResult) -> String {
    let told = |hz: Option<f64>| hz.map_or_else(|| "-".to_owned(), |hz| format!("{hz:.5}"));
    let told_peaks = |spectrum: &Spectrum| {
        let told: Vec<String> = peaks(spectrum, LEAST_PEAK)
            .into_iter()
            .take(4)
            .map(|peak| {
                let amplitude_deg = peak.amplitude.to_degrees();
                format!("{:.4} ({amplitude_deg:.4} deg)", peak.frequency_hz)
            })
            .collect();
        told.join(", ")
    };
    let largest = |record: Vec<(f64, f64)>| size(&record).to_degrees();
    let mut text = format!(
        "\noffset {} m: swings by {:.3} deg at most, turns against the balloon by {:.3e} deg\n",
        result.flown.offset_m,
        largest(result.flown.swing()),
        largest(result.flown.turn())
    );
    text.push_str(&format!(
        "  swing: mode {}, closed form {:.5}, peaks {}\n",
        told(result.mode_hz(Motion::X)),
        result.pair.swing_hz(),
        told_peaks(&result.swing)
    ));
    // Round-off has peaks too.
    let turns = if result.flown.offset_m == 0.0 {
        "none".to_owned()
    } else {
        told_peaks(&result.turn)
    };
    text.push_str(&format!(
        "  turn:  mode {}, closed form {:.5}, peaks {turns}\n",
        told(result.mode_hz(Motion::Yaw)),
        result.pair.yaw_hz(),
    ));
    text
}

fn motion(found: &MojaveStudy) -> String {
    let mut text = "offset_m,formulation,time_s,swing_x_rad,swing_y_rad,gondola_heading_rad,balloon_heading_rad\n".to_owned();
    for flown in flights(found) {
        let of = |body, channel| flown.flight.results.channel(body, channel);
        let swing_y = of(GONDOLA, "swing_y_rad");
        let headings = of(GONDOLA, "heading_rad")
            .into_iter()
            .zip(of(BALLOON, "heading_rad"));
        for (((time_s, x), (_, y)), ((_, gondola), (_, balloon))) in
            flown.swing().into_iter().zip(swing_y).zip(headings)
        {
            let [time, x, y, gondola, balloon] = [time_s, x, y, gondola, balloon].map(number_text);
            let formulation = flown.flight.formulation.name().to_owned();
            let offset = number_text(flown.offset_m);
            row(
                &mut text,
                &[offset, formulation, time, x, y, gondola, balloon],
            );
        }
    }
    text
}

fn spectra(found: &MojaveStudy) -> String {
    let mut text = "offset_m,frequency_hz,swing_rad,turn_rad\n".to_owned();
    for result in &found.offsets {
        for ((hz, swing), (_, turn)) in result.swing.points().zip(result.turn.points()) {
            row(
                &mut text,
                &[result.flown.offset_m, hz, swing, turn].map(number_text),
            );
        }
    }
    text
}

fn modes(found: &MojaveStudy) -> String {
    let mut text =
        "offset_m,mode,frequency_hz,damping_ratio,gondola_x,gondola_yaw,name\n".to_owned();
    for result in &found.offsets {
        for (index, mode) in result.modes.iter().enumerate() {
            let numbers = [
                mode.frequency_hz(),
                mode.damping_ratio(),
                mode.share(GONDOLA, Motion::X),
                mode.share(GONDOLA, Motion::Yaw),
            ]
            .map(number_text);
            let mut fields = vec![number_text(result.flown.offset_m), (index + 1).to_string()];
            fields.extend(numbers);
            // Names of bodies are set apart by commas.
            fields.push(mode.name.replace(',', ";"));
            row(&mut text, &fields);
        }
    }
    text
}
