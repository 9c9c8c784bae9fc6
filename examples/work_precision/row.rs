//! Rows of the table.

/// The columns.
pub(crate) const HEADER: &str = "case,method,setting,steps,rejected,evaluations,error_bodies_m,\
                          error_nodes_m,cpu_us_per_simulated_s,reference";

/// An integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Method {
    /// Implicit or explicit, as the motion asks.
    Auto,
    /// ROS34PW2 throughout.
    Implicit,
    /// Dormand-Prince 5(4) under error control.
    DormandPrince,
    /// The classical method with a fixed step.
    RungeKutta4,
}

impl Method {
    /// All, in the order of table and legend.
    pub(crate) const ALL: [Self; 4] = [
        Self::Auto,
        Self::Implicit,
        Self::DormandPrince,
        Self::RungeKutta4,
    ];

    /// Name in table and legend.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Auto => "Auto",
            Self::Implicit => "Implicit (ROS34PW2)",
            Self::DormandPrince => "Dormand-Prince",
            Self::RungeKutta4 => "RK4",
        }
    }
}

/// A setting of a method in a case.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Name of the case.
    pub(crate) case: String,
    /// The method.
    pub(crate) method: Method,
    /// Its accuracy, tolerance or step.
    pub(crate) setting: String,
    /// Accepted steps.
    pub(crate) steps: u64,
    /// Rejected steps.
    pub(crate) rejected: u64,
    /// Evaluations of the rates.
    pub(crate) evaluations: u64,
    /// Largest distance of a body from the reference, m; not a number where the run stopped early.
    pub(crate) error_bodies_m: f64,
    /// Largest distance of a node from the reference, m.
    pub(crate) error_nodes_m: f64,
    /// CPU time of a simulated second, us.
    pub(crate) cpu_us_per_simulated_s: f64,
    /// What the reference is.
    pub(crate) reference: String,
}

impl Row {
    /// The row as a line of the table.
    pub(crate) fn line(&self) -> String {
        format!(
            "{},{},{},{},{},{},{:.3e},{:.3e},{:.2},{}",
            self.case,
            self.method.name(),
            self.setting,
            self.steps,
            self.rejected,
            self.evaluations,
            self.error_bodies_m,
            self.error_nodes_m,
            self.cpu_us_per_simulated_s,
            self.reference
        )
    }

    /// The row of a line; `None` if it is not one.
    pub(crate) fn parse(line: &str) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let [
            case,
            method,
            setting,
            steps,
            rejected,
            evaluations,
            bodies,
            nodes,
            cpu,
            reference,
        ] = fields[..]
        else {
            return None;
        };
        Some(Self {
            case: case.to_owned(),
            method: Method::ALL.into_iter().find(|one| one.name() == method)?,
            setting: setting.to_owned(),
            steps: steps.parse().ok()?,
            rejected: rejected.parse().ok()?,
            evaluations: evaluations.parse().ok()?,
            error_bodies_m: bodies.parse().ok()?,
            error_nodes_m: nodes.parse().ok()?,
            cpu_us_per_simulated_s: cpu.parse().ok()?,
            reference: reference.to_owned(),
        })
    }
}

/// CPU time per simulated second, us, with which `method` keeps the error `of` a row within `error_m` (m):
/// between two settings along the straight line that joins them in the picture; the flag says that its
/// cheapest setting is more accurate than that already. `None` if no setting is that accurate.
pub(crate) fn cost_us(
    rows: &[&Row],
    method: Method,
    of: fn(&Row) -> f64,
    error_m: f64,
) -> Option<(f64, bool)> {
    let mut rows: Vec<&&Row> = rows
        .iter()
        .filter(|row| row.method == method && of(row) > 0.0)
        .collect();
    rows.sort_by(|a, b| {
        a.cpu_us_per_simulated_s
            .total_cmp(&b.cpu_us_per_simulated_s)
    });
    let right = rows.iter().position(|row| of(row) <= error_m)?;
    let (fine, Some(coarse)) = (rows[right], right.checked_sub(1).map(|left| rows[left])) else {
        return Some((rows[right].cpu_us_per_simulated_s, true));
    };
    let log = |x: f64| libm::log(x);
    let part = (log(of(coarse)) - log(error_m)) / (log(of(coarse)) - log(of(fine)));
    let (from, to) = (
        log(coarse.cpu_us_per_simulated_s),
        log(fine.cpu_us_per_simulated_s),
    );
    Some((libm::exp(from + part * (to - from)), false))
}
