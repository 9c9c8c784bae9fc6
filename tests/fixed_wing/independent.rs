//! The twelve equations of motion of Beard and McLain (2012), ch. 3 and 4, in north-east-down and Euler angles,
//! written as printed there and integrated by the classical Runge-Kutta method: shares no code with the engine
//! but the record of the controls.

use aerobot::components::fixed_wing::controls::Controls;
use glam::DVec3;

/// p_n, p_e, p_d; u, v, w over ground, in the body; phi, theta, psi; p, q, r.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) position: DVec3,
    pub(crate) velocity: DVec3,
    pub(crate) angles: DVec3,
    pub(crate) rate: DVec3,
}

impl State {
    fn plus(self, h: f64, k: Self) -> Self {
        Self {
            position: self.position + h * k.position,
            velocity: self.velocity + h * k.velocity,
            angles: self.angles + h * k.angles,
            rate: self.rate + h * k.rate,
        }
    }
}

const MASS: f64 = 11.0;
const JX: f64 = 0.8244;
const JY: f64 = 1.135;
const JZ: f64 = 1.759;
const JXZ: f64 = 0.1204;
const S: f64 = 0.55;
const B: f64 = 2.8956;
const C: f64 = 0.18994;

/// Flies from `start` with held controls in air of (density, gravity) and a wind that depends on time; the states
/// at some times, which no step crosses.
pub(crate) fn fly(
    start: State,
    controls: &Controls,
    air: (f64, f64),
    wind: impl Fn(f64) -> DVec3,
    times_s: &[f64],
) -> Vec<(f64, State)> {
    let h = 1e-3;
    let mut state = start;
    let mut step = 0_u32;
    let mut found = Vec::new();
    for &time_s in times_s {
        while f64::from(step) * h < time_s - 0.5 * h {
            // The wind is steady between the times.
            let wind = wind((f64::from(step) + 0.5) * h);
            let f = |state| rates(state, controls, air, wind);
            let k1 = f(state);
            let k2 = f(state.plus(0.5 * h, k1));
            let k3 = f(state.plus(0.5 * h, k2));
            let k4 = f(state.plus(h, k3));
            let half = state.plus(h / 6.0, k1).plus(h / 3.0, k2);
            state = half.plus(h / 3.0, k3).plus(h / 6.0, k4);
            step += 1;
        }
        found.push((time_s, state));
    }
    found
}

/// Rows of the rotation from the body to north-east-down (eq. 2.5, transposed).
fn rotation(angles: DVec3) -> [DVec3; 3] {
    let (sf, cf) = angles.x.sin_cos();
    let (st, ct) = angles.y.sin_cos();
    let (sp, cp) = angles.z.sin_cos();
    [
        DVec3::new(ct * cp, sf * st * cp - cf * sp, cf * st * cp + sf * sp),
        DVec3::new(ct * sp, sf * st * sp + cf * cp, cf * st * sp - sf * cp),
        DVec3::new(-st, sf * ct, cf * ct),
    ]
}

fn rates(state: State, controls: &Controls, (rho, g): (f64, f64), wind: DVec3) -> State {
    let [north, east, down] = rotation(state.angles);
    let (phi, theta) = (state.angles.x, state.angles.y);
    let (u, v, w) = (state.velocity.x, state.velocity.y, state.velocity.z);
    let (p, q, r) = (state.rate.x, state.rate.y, state.rate.z);
    let (force, moment) = loads(state, controls, rho, wind, [north, east, down]);
    // eqs. 3.14 to 3.17
    let velocity = DVec3::new(r * v - q * w, p * w - r * u, q * u - p * v)
        + force / MASS
        + g * DVec3::new(
            -theta.sin(),
            theta.cos() * phi.sin(),
            theta.cos() * phi.cos(),
        );
    let gamma = JX * JZ - JXZ * JXZ;
    let g1 = JXZ * (JX - JY + JZ) / gamma;
    let g2 = (JZ * (JZ - JY) + JXZ * JXZ) / gamma;
    let (g3, g4) = (JZ / gamma, JXZ / gamma);
    let (g5, g6) = ((JZ - JX) / JY, JXZ / JY);
    let g7 = ((JX - JY) * JX + JXZ * JXZ) / gamma;
    let g8 = JX / gamma;
    let rate = DVec3::new(
        g1 * p * q - g2 * q * r + g3 * moment.x + g4 * moment.z,
        g5 * p * r - g6 * (p * p - r * r) + moment.y / JY,
        g7 * p * q - g1 * q * r + g4 * moment.x + g8 * moment.z,
    );
    let angles = DVec3::new(
        p + (q * phi.sin() + r * phi.cos()) * theta.tan(),
        q * phi.cos() - r * phi.sin(),
        (q * phi.sin() + r * phi.cos()) / theta.cos(),
    );
    let position = DVec3::new(
        north.dot(state.velocity),
        east.dot(state.velocity),
        down.dot(state.velocity),
    );
    State {
        position,
        velocity,
        angles,
        rate,
    }
}

/// Force and moment of air and propeller (ch. 4).
fn loads(
    state: State,
    controls: &Controls,
    rho: f64,
    wind: DVec3,
    [north, east, down]: [DVec3; 3],
) -> (DVec3, DVec3) {
    let wind_body = wind.x * north + wind.y * east + wind.z * down;
    let air = state.velocity - wind_body;
    let va = air.length();
    let alpha = (air.z / air.x).atan();
    let beta = (air.y / va).asin();
    let (p, q, r) = (state.rate.x, state.rate.y, state.rate.z);
    let (de, da, dr) = (
        controls.elevator_rad,
        controls.aileron_rad,
        controls.rudder_rad,
    );
    let qs = 0.5 * rho * va * va * S;
    let (qc, pb, rb) = (C * q / (2.0 * va), B * p / (2.0 * va), B * r / (2.0 * va));
    let (m, a0) = (50.0_f64, 0.47_f64);
    let (e1, e2) = ((-m * (alpha - a0)).exp(), (m * (alpha + a0)).exp());
    let sigma = (1.0 + e1 + e2) / ((1.0 + e1) * (1.0 + e2));
    let plate = 2.0 * alpha.signum() * alpha.sin().powi(2) * alpha.cos();
    let lift = qs * ((1.0 - sigma) * (0.23 + 5.61 * alpha) + sigma * plate + 7.95 * qc + 0.13 * de);
    let drag = qs * (0.043 + 0.03 * alpha + 0.0135 * de);
    // eq. 4.18's motor, by its current: Omega from the torques of both.
    let (d, kv, ohm) = (0.508_f64, 0.065_857_22, 0.042);
    let volts = 44.4 * controls.throttle;
    let torques = |omega: f64| {
        let n = omega / std::f64::consts::TAU;
        let j = va / (n * d);
        let propeller = rho * n * n * d.powi(5) * (0.00523 + 0.00497 * j - 0.01664 * j * j);
        let motor = kv * ((volts - kv * omega) / ohm - 1.5);
        (propeller, motor)
    };
    // Bisection: the motor's torque falls and the propeller's grows with speed.
    let (mut slow, mut fast) = (1.0, 1000.0);
    for _ in 0..100 {
        let middle = 0.5 * (slow + fast);
        let (propeller, motor) = torques(middle);
        if motor > propeller {
            slow = middle;
        } else {
            fast = middle;
        }
    }
    let omega = 0.5 * (slow + fast);
    let n = omega / std::f64::consts::TAU;
    let j = va / (n * d);
    let thrust = rho * n * n * d.powi(4) * (0.09357 - 0.06044 * j - 0.1079 * j * j);
    let (propeller, _) = torques(omega);
    let force = DVec3::new(
        thrust - drag * alpha.cos() + lift * alpha.sin(),
        qs * (-0.98 * beta + 0.075 * da + 0.19 * dr),
        -drag * alpha.sin() - lift * alpha.cos(),
    );
    let moment = DVec3::new(
        qs * B * (-0.13 * beta - 0.51 * pb + 0.25 * rb + 0.17 * da + 0.0024 * dr) - propeller,
        qs * C * (0.0135 - 2.74 * alpha - 38.21 * qc - 0.99 * de),
        qs * B * (0.073 * beta - 0.069 * pb - 0.095 * rb - 0.011 * da - 0.069 * dr),
    );
    (force, moment)
}
