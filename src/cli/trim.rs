//! `aerobot trim`.

use std::path::Path;
use std::process::ExitCode;

use aerobot_engine::plugin::Simulator;
use aerobot_engine::trim::scene_file::write_trimmed_scene;
use aerobot_engine::trim::{Residual, Trim, TrimmedBody, TrimmedEnd, TrimmedSystem, TrimmedTether};
use glam::DVec3;

use super::TrimArguments;
use super::finding::{self, Found};

pub(super) fn trim(simulator: &Simulator, arguments: &TrimArguments) -> ExitCode {
    let out = arguments.out.as_deref();
    let found = find_and_write(simulator, arguments).map(|trim| Found {
        text: describe(&trim),
        warnings: trim.warnings,
        written: "starts there",
    });
    finding::tell(found, &arguments.find, out)
}

/// Finds the steady state, and writes the scene that starts there if one is asked for.
fn find_and_write(simulator: &Simulator, arguments: &TrimArguments) -> Result<Trim, String> {
    let (find, out) = (&arguments.find, arguments.out.as_deref());
    let (scene, mut simulation) = finding::build(simulator, find, out)?;
    let trim = simulation.trim(&scene).map_err(|error| error.to_string())?;
    if let Some(file) = out {
        let folder = find.scene.parent().unwrap_or_else(|| Path::new("."));
        write_trimmed_scene(&scene, &trim, folder, file, find.force)
            .map_err(|error| error.to_string())?;
    }
    Ok(trim)
}

fn describe(trim: &Trim) -> String {
    let mut text = String::new();
    for note in &trim.notes {
        text.push_str(&format!("note: {note}\n"));
    }
    for system in &trim.systems {
        text.push_str(&describe_system(system));
        for body in trim.bodies.iter().filter(|body| has(system, body)) {
            text.push_str(&describe_body(body));
        }
        for tether in &trim.tethers {
            if system.tethers.contains(&tether.name) {
                text.push_str(&describe_tether(tether));
            }
        }
    }
    text.push_str(&describe_residual(&trim.residual));
    text
}

fn describe_residual(left: &Residual) -> String {
    if left.force_at.is_empty() {
        return String::new();
    }
    let turning = if left.angular_acceleration_at.is_empty() {
        String::new()
    } else {
        format!(
            ", {:.1e} rad/s^2 of `{}`",
            left.angular_acceleration_rad_s2, left.angular_acceleration_at
        )
    };
    format!(
        "left over: {:.1e} N on `{}`, {:.1e} m/s^2 of `{}`{turning} (round-off of positions: {:.1e} N)\n",
        left.force_n, left.force_at, left.acceleration_m_s2, left.acceleration_at, left.round_off_n
    )
}

fn has(system: &TrimmedSystem, body: &TrimmedBody) -> bool {
    system.bodies.contains(&body.name) || system.anchors.contains(&body.name)
}

fn describe_system(system: &TrimmedSystem) -> String {
    match &system.reference {
        Some(reference) => format!(
            "drifts at {} m/s, {:.6} m/s in the horizontal; the wind at `{reference}` is {} m/s\n",
            vector(system.velocity_m_s),
            system.velocity_m_s.truncate().length(),
            vector(system.wind_at_reference_m_s)
        ),
        None => {
            let anchors: Vec<String> = system.anchors.iter().map(|a| format!("`{a}`")).collect();
            let anchors = anchors.join(", ");
            if system.velocity_m_s == DVec3::ZERO {
                format!("held by {anchors}\n")
            } else {
                let velocity = vector(system.velocity_m_s);
                format!("held by {anchors}, moving at {velocity} m/s\n")
            }
        }
    }
}

fn describe_body(body: &TrimmedBody) -> String {
    let mut text = format!("  {:<16} at {} m", body.name, vector(body.position_m));
    if body.is_anchor {
        text.push_str(", held");
    } else if body.turns {
        text.push_str(&format!(
            ", tilt {} deg, heading {} deg",
            fixed(body.tilt_rad.to_degrees(), 4),
            fixed(body.heading_rad.to_degrees(), 4)
        ));
    }
    text.push('\n');
    text
}

fn describe_tether(tether: &TrimmedTether) -> String {
    let (top, bottom) = if tether.from.position_m.z >= tether.to.position_m.z {
        (&tether.from, &tether.to)
    } else {
        (&tether.to, &tether.from)
    };
    format!(
        "  {:<16} largest tension {:.6} N, in segment {}\n{}{}",
        tether.name,
        tether.largest_tension_n,
        tether.largest_segment,
        describe_end("top", top),
        describe_end("bottom", bottom)
    )
}

fn describe_end(place: &str, end: &TrimmedEnd) -> String {
    format!(
        "    {:<14} pulls `{}` with {:.6} N (end segment {:.6} N), {:.4} deg from the vertical\n",
        place,
        end.carrier,
        end.force_n,
        end.tension_n,
        end.angle_from_vertical_rad.to_degrees()
    )
}

fn vector(value: DVec3) -> String {
    let [x, y, z] = value.to_array().map(|part| fixed(part, 6));
    format!("({x}, {y}, {z})")
}

/// A number with so many decimals; a zero that came out negative reads as a difference where there is
/// none.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| c == '0' || c == '.') => digits.to_owned(),
        _ => text,
    }
}
