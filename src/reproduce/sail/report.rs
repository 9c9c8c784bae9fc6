//! The sail case as a text and as tables.

use aerobot_engine::recording::number::number_text;
use aerobot_systems::environment::zonal_wind;

use super::super::check::Verdict;
use super::super::{Report, Table};
use super::checks::{self, PAPER_SHOWS, TITLE};
use super::{BAND_M, SailStudy};

const HEAD: &str = "\
The sail of the paper (sec. 5.2): a wing of 3 m2 (AR 5, e 0.7) 0.5 m from the centre of mass and a rudder 4 m aft of
it, 2 km below the balloon. The paper gives neither the rudder's area (0.5 m2 here) nor C_D0 (0.02), masses, the side
of the wing, the limits of the rudder or the tether; what is chosen stands in `scenes/paper/sail_trajectory.ron`.

Figure 17, equation 5: lift stands across the motion and drag against it; the axes printed in equation 5 are exchanged.
The printed incidence of the rudder, alpha_w - delta + epsilon, has the downwash with the wrong sign: downwash takes
from the incidence behind the wing. For small deflections delta, by lift alone, with the dynamic pressure q (the drag
of a wing aft adds l_w S_w C_D0 = 0.03 m3/rad to the yaw stiffness):

lift slope       wing   downwash      alpha_w/delta  side force/(q delta)  yaw stiffness/q  stable from a rudder of
";

const WORDS: &str = "
With the wing ahead, as the paper's words can be read, the right sign shows a sail that turns away from where it goes;
the printed sign hides that. With the wing aft it is stable with either.
";

const RESPONSES: &str = "
Figure 19: y of the balloon is to be TARGET m, delta = -0.1 deg/m times the error (equation 6, in which alpha_rudder is
the commanded deflection delta), sampled at 2 Hz.

                                                overshoot   period, s   within BAND m after, s
";

const ENDING: &str = "
The paper shows the system at its target \"with some oscillations due to the used control law\". They are here too: with
y alone fed back nothing but drag and the tether's lag damp the drift of the whole, least where the line has no drag.
What is fed back (the paper does not say whether the sail's y or the balloon's) and the tether's drag, which it does not
give, change the overshoot by more than the sign of the downwash does. `scenes/sail_hold_latitude.ron` has a law that
feeds back velocities too.
";

pub(super) fn report(found: &SailStudy) -> Report {
    let stopped = found.flights.iter().filter_map(|(words, response)| {
        let reason = response.stopped.as_ref()?;
        Some(format!("sail: {words}: stopped: {reason}"))
    });
    let checks = checks::checks(found);
    Report {
        figures: Vec::new(),
        title: TITLE.to_owned(),
        paper_shows: PAPER_SHOWS.to_owned(),
        verdict: Verdict::of(&checks, checks::sentence(found)),
        checks,
        stopped: stopped.collect(),
        tables: vec![
            Table {
                file_name: "sail_trim.csv",
                text: trims(found),
            },
            Table {
                file_name: "sail_zonal_wind.csv",
                text: profile(),
            },
            Table {
                file_name: "sail_response.csv",
                text: responses(found),
            },
        ],
        text: text(found),
    }
}

fn text(found: &SailStudy) -> String {
    let mut text = HEAD.to_owned();
    for (words, trim) in &found.trims {
        let least = trim
            .least_rudder_m2
            .map_or_else(|| "any".to_owned(), |area_m2| format!("{area_m2:.3} m2"));
        text.push_str(&format!(
            "{words} {:>14.4} {:>16.3} m2/rad {:>9.3} m3/rad  {least}{}\n",
            trim.incidence_per_deflection,
            trim.force_m2_rad,
            trim.stiffness_m3_rad,
            if trim.stiffness_m3_rad > 0.0 {
                ""
            } else {
                "   UNSTABLE"
            }
        ));
    }
    text.push_str(WORDS);
    text.push_str(&wind());
    text.push_str(
        &RESPONSES
            .replace("TARGET", &number_text(found.target_m))
            .replace("BAND", &number_text(BAND_M)),
    );
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.0}"));
    for (words, response) in &found.flights {
        text.push_str(&format!(
            "{words:<46} {:>8.0} % {:>11} {:>12}\n",
            100.0 * response.overshoot,
            number(response.period_s),
            number(response.arrived_s)
        ));
    }
    text.push_str(ENDING);
    text
}

fn wind() -> String {
    let at = |altitude_m: f64| {
        let rows = zonal_wind::ROWS;
        let row = rows.iter().find(|row| row[0] == altitude_m);
        row.map_or(f64::NAN, |row| row[1])
    };
    format!(
        "
Figure 18: the zonal wind over altitude, here that of the reference profile (`sail_zonal_wind.csv`): {} m/s at 50 km, \
{} at 55 km,
{} at 60 km. What drives the sail is its change over 2 km: about 4 m/s below 55 km. The figure's values are not given.
",
        at(50_000.0),
        at(55_000.0),
        at(60_000.0)
    )
}

fn profile() -> String {
    let mut text = "altitude_m,zonal_wind_m_s\n".to_owned();
    for [altitude_m, speed_m_s] in zonal_wind::ROWS {
        text.push_str(&format!(
            "{},{}\n",
            number_text(altitude_m),
            number_text(speed_m_s)
        ));
    }
    text
}

fn trims(found: &SailStudy) -> String {
    let mut text = "sail,alpha_wing_per_deflection,side_force_m2_rad,yaw_stiffness_m3_rad,\
                    least_rudder_area_m2\n"
        .to_owned();
    for (words, trim) in &found.trims {
        let words: Vec<&str> = words.split_whitespace().collect();
        text.push_str(&format!(
            "{},{},{},{},{}\n",
            words.join(" "),
            number_text(trim.incidence_per_deflection),
            number_text(trim.force_m2_rad),
            number_text(trim.stiffness_m3_rad),
            trim.least_rudder_m2.map_or_else(String::new, number_text)
        ));
    }
    text
}

fn responses(found: &SailStudy) -> String {
    let mut text = "flight,time_s,balloon_y_m,sail_y_m,rudder_rad\n".to_owned();
    for (words, response) in &found.flights {
        let words = words.replace(',', ";");
        for (time_s, balloon_m, sail_m, rudder_rad) in &response.rows {
            let numbers = [*time_s, *balloon_m, *sail_m, *rudder_rad].map(number_text);
            text.push_str(&format!("{words},{}\n", numbers.join(",")));
        }
    }
    text
}
