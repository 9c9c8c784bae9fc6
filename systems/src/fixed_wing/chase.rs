//! How a pursuit stands: on the way, on station, without hope, in the end game, past the target.
//!
//! A target is out of reach when, for a time, one of these holds without a break: keeping its station takes more
//! airspeed than level flight has, and the drone falls behind; the throttle is open, or the pitch at its limit, and
//! the drone falls behind; or it takes less airspeed than level flight has. It is in reach again when none has held
//! for as long.

/// How a pursuit stands; the numbers are those of the channel `chase_state`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChaseState {
    /// 0: on the way.
    #[default]
    Pursuing,
    /// 1: on station.
    Station,
    /// 2: the target is out of reach.
    Unreachable,
    /// 3: proportional navigation to the target.
    EndGame,
    /// 4: past the target.
    Passed,
}

/// Why a target is out of reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hopeless {
    /// Its station moves faster through the drone's air than level flight does.
    TooFast,
    /// Its station moves slower through the drone's air than level flight can.
    TooSlow,
    /// The throttle is open, and the station draws away.
    OutOfThrust,
    /// The pitch is at its limit, and the station draws away.
    TooSteep,
    /// In the end game the target draws away from afar.
    EndGame,
}

impl Hopeless {
    /// The kind of event that tells it.
    #[must_use]
    pub fn event(self) -> &'static str {
        match self {
            Self::TooFast => "target unreachable: faster than the drone in level flight",
            Self::TooSlow => "target unreachable: slower than the drone can fly",
            Self::OutOfThrust => "target unreachable: out of thrust",
            Self::TooSteep => "target unreachable: climbs or sinks too steeply",
            Self::EndGame => "target unreachable: draws away in the end game",
        }
    }
}

/// A target that draws away from farther than this part of the distance at which the end game begins was not passed.
const PASSED_PART: f64 = 0.25;

/// What is seen of a pursuit at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Distance from the station, m.
    pub station_m: f64,
    /// How fast it grows, m/s.
    pub parting_m_s: f64,
    /// Airspeed that keeps the station, m/s.
    pub required_m_s: f64,
    /// Distance from the target, m.
    pub range_m: f64,
    /// Rate at which that falls, m/s.
    pub closing_m_s: f64,
    /// The throttle.
    pub throttle: f64,
    /// Whether the pitch asked for is at a limit.
    pub at_pitch_limit: bool,
}

/// What is asked of a pursuit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Distance within which the station is kept, m.
    pub station_m: f64,
    /// Airspeeds of level flight, m/s.
    pub level_m_s: (f64, f64),
    /// Time before a target is given up, or taken up again, s.
    pub patience_s: f64,
    /// Distance from the target at which the end game begins, m.
    pub end_game_m: Option<f64>,
}

/// A pursuit on its way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chase {
    /// How it stands.
    pub state: ChaseState,
    /// Time without a break for which there was no hope, and why; negative: for which there was.
    doubt_s: f64,
    reason: Option<Hopeless>,
    /// The least distance from the target so far, m.
    pub closest_m: Option<f64>,
}

/// Throttle that counts as open.
const OPEN: f64 = 0.999;
/// Falling behind slower than this is none, m/s.
const PARTING_M_S: f64 = 0.01;

impl Chase {
    /// Goes on by a sample of `period_s`; gives the word of an event if the state has changed to one that is
    /// worth telling.
    pub fn advance(&mut self, seen: &Seen, rules: &Rules, period_s: f64) -> Option<&'static str> {
        let closest = self.closest_m.unwrap_or(f64::INFINITY);
        self.closest_m = Some(closest.min(seen.range_m));
        match self.state {
            ChaseState::Passed => return None,
            ChaseState::EndGame
                if seen.closing_m_s <= 0.0
                    && seen.range_m > rules.end_game_m.unwrap_or(0.0) * PASSED_PART =>
            {
                self.state = ChaseState::Unreachable;
                self.reason = Some(Hopeless::EndGame);
                self.doubt_s = 0.0;
                return self.reason.map(Hopeless::event);
            }
            ChaseState::EndGame if seen.closing_m_s <= 0.0 => {
                self.state = ChaseState::Passed;
                return Some("target passed");
            }
            ChaseState::EndGame => return None,
            _ => {}
        }
        let hopeless = hopeless(seen, rules);
        self.doubt_s = match (hopeless, self.state) {
            (Some(_), ChaseState::Unreachable)
            | (None, ChaseState::Pursuing | ChaseState::Station) => 0.0,
            _ => self.doubt_s + period_s,
        };
        self.reason = hopeless.or(self.reason);
        let turned = self.doubt_s >= rules.patience_s;
        if self.state == ChaseState::Unreachable {
            if !turned {
                return None;
            }
            self.doubt_s = 0.0;
            self.state = ChaseState::Pursuing;
            return Some("target in reach again");
        }
        if turned {
            self.doubt_s = 0.0;
            self.state = ChaseState::Unreachable;
            return self.reason.map(Hopeless::event);
        }
        if rules
            .end_game_m
            .is_some_and(|within_m| seen.range_m < within_m)
            && seen.closing_m_s > 0.0
        {
            self.state = ChaseState::EndGame;
            return Some("end game");
        }
        // It takes more to lose a station than to reach it.
        let kept_m = match self.state {
            ChaseState::Station => 1.5 * rules.station_m,
            _ => rules.station_m,
        };
        let on_station = seen.station_m < kept_m;
        let event = match (self.state, on_station) {
            (ChaseState::Pursuing, true) => Some("station reached"),
            (ChaseState::Station, false) => Some("station lost"),
            _ => None,
        };
        self.state = if on_station {
            ChaseState::Station
        } else {
            ChaseState::Pursuing
        };
        event
    }
}

fn hopeless(seen: &Seen, rules: &Rules) -> Option<Hopeless> {
    let (least, most) = rules.level_m_s;
    let falls_behind = seen.parting_m_s > PARTING_M_S && seen.station_m > rules.station_m;
    if seen.required_m_s < least {
        Some(Hopeless::TooSlow)
    } else if seen.required_m_s > most && falls_behind {
        Some(Hopeless::TooFast)
    } else if seen.throttle >= OPEN && falls_behind {
        Some(Hopeless::OutOfThrust)
    } else if seen.at_pitch_limit && falls_behind {
        Some(Hopeless::TooSteep)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: Rules = Rules {
        station_m: 2.0,
        level_m_s: (14.0, 32.0),
        patience_s: 5.0,
        end_game_m: None,
    };

    const NEAR: Seen = Seen {
        station_m: 50.0,
        parting_m_s: -1.0,
        required_m_s: 25.0,
        range_m: 80.0,
        closing_m_s: 1.0,
        throttle: 0.8,
        at_pitch_limit: false,
    };

    /// Goes on for a time in s and collects what is told.
    fn advance(chase: &mut Chase, seen: Seen, rules: &Rules, time_s: f64) -> Vec<&'static str> {
        (0..(time_s / 0.1).round() as usize)
            .filter_map(|_| chase.advance(&seen, rules, 0.1))
            .collect()
    }

    #[test]
    fn a_target_is_given_up_once_after_its_time_and_taken_up_again() {
        let too_fast = Seen {
            required_m_s: 35.0,
            parting_m_s: 3.0,
            throttle: 1.0,
            ..NEAR
        };
        let mut chase = Chase::default();
        assert!(advance(&mut chase, too_fast, &RULES, 4.0).is_empty());
        assert!(advance(&mut chase, NEAR, &RULES, 0.1).is_empty());
        assert!(advance(&mut chase, too_fast, &RULES, 4.8).is_empty());
        let told = advance(&mut chase, too_fast, &RULES, 20.0);
        assert_eq!(told, [Hopeless::TooFast.event()]);
        assert_eq!(chase.state, ChaseState::Unreachable);
        assert!(advance(&mut chase, NEAR, &RULES, 4.8).is_empty());
        let told = advance(&mut chase, NEAR, &RULES, 20.0);
        assert_eq!(told, ["target in reach again"]);
        assert_eq!(chase.state, ChaseState::Pursuing);
    }

    #[test]
    fn the_reason_is_the_one_that_holds() {
        let out_of_thrust = Seen {
            throttle: 1.0,
            parting_m_s: 0.5,
            ..NEAR
        };
        let too_slow = Seen {
            required_m_s: 4.0,
            ..NEAR
        };
        let too_steep = Seen {
            at_pitch_limit: true,
            parting_m_s: 0.5,
            ..NEAR
        };
        for (seen, reason) in [
            (out_of_thrust, Hopeless::OutOfThrust),
            (too_steep, Hopeless::TooSteep),
            (too_slow, Hopeless::TooSlow),
        ] {
            let told = advance(&mut Chase::default(), seen, &RULES, 30.0);
            assert_eq!(told, [reason.event()]);
        }
    }

    #[test]
    fn stations_are_reached_and_targets_passed() {
        let on_station = Seen {
            station_m: 1.0,
            ..NEAR
        };
        let mut chase = Chase::default();
        assert_eq!(
            advance(&mut chase, on_station, &RULES, 1.0),
            ["station reached"]
        );
        let edge = Seen {
            station_m: 2.5,
            ..NEAR
        };
        assert!(advance(&mut chase, edge, &RULES, 1.0).is_empty());
        assert_eq!(advance(&mut chase, NEAR, &RULES, 1.0), ["station lost"]);
        let ends = Rules {
            end_game_m: Some(100.0),
            ..RULES
        };
        assert_eq!(advance(&mut chase, NEAR, &ends, 1.0), ["end game"]);
        let past = Seen {
            closing_m_s: -1.0,
            range_m: 0.7,
            ..NEAR
        };
        assert_eq!(advance(&mut chase, past, &ends, 1.0), ["target passed"]);
        assert_eq!(chase.closest_m, Some(0.7));
        let falls_back = Seen {
            closing_m_s: -1.0,
            range_m: 51.0,
            ..NEAR
        };
        let mut chase = Chase::default();
        assert_eq!(advance(&mut chase, NEAR, &ends, 1.0), ["end game"]);
        assert_eq!(
            advance(&mut chase, falls_back, &ends, 1.0),
            [Hopeless::EndGame.event()]
        );
        assert_eq!(chase.state, ChaseState::Unreachable);
    }
}
