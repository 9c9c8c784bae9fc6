use aerobot_components::control::{FeedbackTerm, Quantity};

use super::*;

const FREE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

fn controller(law: Law) -> Controller {
    Controller {
        actuator: ("sail".to_owned(), "rudder".to_owned()),
        period_s: 0.01,
        law,
        saturation: None,
        rate_limit_per_s: None,
    }
}

fn pid(proportional: f64, integral_per_s: f64, derivative_s: f64, filter_s: f64) -> Controller {
    controller(Law::Pid {
        measured: Quantity::Y("sail".to_owned()),
        target: 0.0,
        proportional,
        integral_per_s,
        derivative_s,
        filter_s,
        anti_windup_s: None,
    })
}

/// Of an error that grows as r t the law with a filtered derivative has
/// u = r (K t + K_i t^2/2 + K_d (1 - e^(-t/T_f))): the sampled law goes there with its period.
#[test]
fn a_pid_is_its_law_in_continuous_time_but_for_the_period() {
    let law = pid(2.0, 0.5, 3.0, 0.4);
    let mut state = LawState::default();
    let rate = 1.5;
    let mut worst = 0.0_f64;
    for k in 0..=300 {
        let time = f64::from(k) * law.period_s;
        let found = sample(&law, FREE, &[rate * time], &mut state);
        let exact = rate * (2.0 * time + 0.25 * time * time + 3.0 * (1.0 - (-time / 0.4).exp()));
        worst = worst.max((found - exact).abs());
    }
    // The backward difference lags by half a period: K_d r T/(2 T_f) at most 0.06.
    assert!(worst < 0.06, "{worst}");
    let mut finer = law.clone();
    finer.period_s /= 10.0;
    let mut state = LawState::default();
    let mut least = 0.0_f64;
    for k in 0..=3000 {
        let time = f64::from(k) * finer.period_s;
        let found = sample(&finer, FREE, &[rate * time], &mut state);
        let exact = rate * (2.0 * time + 0.25 * time * time + 3.0 * (1.0 - (-time / 0.4).exp()));
        least = least.max((found - exact).abs());
    }
    assert!((worst / least - 10.0).abs() < 0.5, "{worst} {least}");
}

/// A motor x' = u that may go no faster than 1 has 20 to go. Without the taking back the integral would carry it
/// far beyond; with it the overshoot is a part of that.
#[test]
fn the_integral_does_not_wind_up() {
    let overshoot = |anti_windup_s: f64| {
        let mut law = pid(1.0, 0.2, 0.0, 0.0);
        if let Law::Pid {
            anti_windup_s: own, ..
        } = &mut law.law
        {
            *own = Some(anti_windup_s);
        }
        let mut state = LawState::default();
        let (mut x, mut most) = (0.0, 0.0_f64);
        for _ in 0..10_000 {
            x += law.period_s * sample(&law, (-1.0, 1.0), &[20.0 - x], &mut state);
            most = most.max(x);
        }
        assert!((x - 20.0).abs() < 1e-3, "{x}");
        most - 20.0
    };
    let (wound, taken_back) = (overshoot(1e9), overshoot(5.0));
    assert!(taken_back < 0.1 * wound, "{taken_back} {wound}");
}

#[test]
fn feedback_clips_each_error_and_the_command_is_cut_in_size_and_rate() {
    let term = |gain, clip| FeedbackTerm {
        measured: Quantity::Y("sail".to_owned()),
        target: 0.0,
        gain,
        clip,
    };
    let mut law = controller(Law::StateFeedback {
        terms: vec![term(2.0, Some(3.0)), term(-1.0, None)],
        bias: 0.5,
    });
    let mut state = LawState::default();
    assert_eq!(
        sample(&law, FREE, &[10.0, 4.0], &mut state),
        0.5 + 6.0 - 4.0
    );
    assert_eq!(sample(&law, (-1.0, 1.0), &[-10.0, 4.0], &mut state), -1.0);
    law.rate_limit_per_s = Some(20.0);
    // From -1, by 20 per second for a hundredth of a second.
    let command = sample(&law, (-1.0, 1.0), &[10.0, 0.0], &mut state);
    assert!((command + 0.8).abs() < 1e-12, "{command}");
}

/// A sampled proportional law about an integrator, x' = u, has the closed form x_k = (1 - K T)^k x_0.
#[test]
fn a_held_command_gives_the_sampled_decay() {
    let mut law = controller(Law::Proportional {
        measured: Quantity::Y("sail".to_owned()),
        target: 0.0,
        gain: 0.7,
    });
    law.period_s = 0.5;
    let mut state = LawState::default();
    let mut x = 1.0;
    for k in 0..20 {
        assert!((x - 0.65_f64.powi(k)).abs() < 1e-12);
        x += law.period_s * sample(&law, FREE, &[-x], &mut state);
    }
}
