//! The plan: what the inputs of a run are. They follow from the seed and the run's index; of a Latin hypercube
//! from the number of runs as well.

use super::comma_separated::CommaSeparated;
use super::distributions::Distribution;
use super::latin_hypercube::strata;
use super::random_stream::{Purpose, RandomStream};
use super::saltelli::Saltelli;
use super::sobol::{MOST_FIELDS, Sobol};
use super::specification::{CampaignSpec, Faults, MOST_RUNS, PlanSpec, entry_path};

/// What varies, and how it is spread over the runs.
pub struct Plan {
    seed: u64,
    /// Number of runs.
    pub runs: u64,
    fields: Vec<Field>,
    spread: Spread,
    /// The seed of all runs, if the campaign sets it.
    set_seed: Option<String>,
}

struct Field {
    path: String,
    source: FieldSource,
}

enum FieldSource {
    /// Its number among those that are drawn, its distribution, and the numbers of a measured one, sorted.
    Drawn(usize, Distribution, Vec<f64>),
    /// Its values, and how many runs each of them stands before the next comes.
    Steps(Vec<String>, u64),
}

enum Spread {
    Independent,
    LatinHypercube(Vec<Vec<u32>>),
    Sobol(Sobol),
    /// The sequence of twice as many fields as are drawn, and how runs are laid out.
    Saltelli(Sobol, Saltelli),
}

/// The inputs of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Inputs {
    /// Path and value, as text of the scene language, of each field that varies.
    pub fields: Vec<(String, String)>,
    /// Seed of the run's own draws.
    pub seed: String,
}

/// The field of a scene that seeds its draws.
pub const RUN_SEED: &str = "run.seed";

impl Inputs {
    /// As overrides `PATH=RON` of the scene.
    #[must_use]
    pub fn overrides(&self) -> Vec<String> {
        let fields = self.fields.iter().filter(|(path, _)| path != RUN_SEED);
        let fields = fields.map(|(path, value)| format!("{path}={value}"));
        fields
            .chain([format!("{RUN_SEED}={}", self.seed)])
            .collect()
    }
}

/// The tables that a plan may read.
pub(super) struct PlanTables {
    /// That of `Table`.
    pub(super) plan: Option<CommaSeparated>,
    /// Numbers of each `Measured` in the order of `vary`, sorted.
    pub(super) measured: Vec<Vec<f64>>,
}

impl Plan {
    /// Of a specification that is in order by itself; what does not fit together goes to `faults`.
    pub(super) fn new(
        specification: &CampaignSpec,
        tables: PlanTables,
        faults: &mut Faults,
    ) -> Option<Self> {
        let mut fields = Vec::new();
        let mut drawn = 0;
        let table = tables.plan.iter().flat_map(|table| {
            let names = table.header.iter().enumerate();
            names.map(|(place, name)| {
                let column = table.rows.iter().map(|(_, row)| row[place].clone());
                (name.clone(), column.collect::<Vec<String>>())
            })
        });
        for (path, values) in table {
            let source = FieldSource::Steps(values, 1);
            fields.push(Field { path, source });
        }
        let mut measured = tables.measured.into_iter();
        for (path, distribution) in &specification.vary.0 {
            let source = distribution.steps().map_or_else(
                || {
                    let is_measured = matches!(distribution, Distribution::Measured { .. });
                    let numbers = is_measured.then(|| measured.next()).flatten();
                    drawn += 1;
                    FieldSource::Drawn(drawn - 1, distribution.clone(), numbers.unwrap_or_default())
                },
                |values| FieldSource::Steps(values, 1),
            );
            fields.push(Field {
                path: path.clone(),
                source,
            });
        }
        let runs = count_runs(specification, &mut fields, faults)?;
        let seed = specification.seed;
        let spread = match specification.plan {
            PlanSpec::LatinHypercube => {
                Spread::LatinHypercube((0..drawn).map(|k| strata(seed, k, runs as u32)).collect())
            }
            PlanSpec::Sobol if drawn > MOST_FIELDS => {
                let message =
                    format!("`Sobol` has coordinates for {MOST_FIELDS} fields, {drawn} vary");
                faults
                    .0
                    .add("plan", message, "`LatinHypercube` has no such limit");
                return None;
            }
            PlanSpec::Sobol => Spread::Sobol(Sobol::new(seed, drawn)),
            PlanSpec::Saltelli if 2 * drawn > MOST_FIELDS => {
                let most = MOST_FIELDS / 2;
                let message = format!("`Saltelli` has coordinates for {most} fields, {drawn} vary");
                let help = "set those that matter least";
                faults.0.add("plan", message, help);
                return None;
            }
            PlanSpec::Saltelli => {
                let layout = Saltelli::of_campaign(specification);
                Spread::Saltelli(Sobol::new(seed, 2 * drawn), layout)
            }
            _ => Spread::Independent,
        };
        Some(Self {
            seed,
            runs,
            fields,
            spread,
            set_seed: set_seed(specification),
        })
    }

    /// The inputs of a run, by its index from 0.
    #[must_use]
    pub fn inputs(&self, index: u64) -> Inputs {
        let mut random = RandomStream::new(self.seed, Purpose::Inputs, index);
        let fields: Vec<(String, String)> = self
            .fields
            .iter()
            .map(|field| {
                let value = match &field.source {
                    FieldSource::Steps(values, stride) => {
                        let place = index / stride % values.len().max(1) as u64;
                        values.get(place as usize).cloned().unwrap_or_default()
                    }
                    FieldSource::Drawn(number, distribution, measured) => {
                        let u = self.part(index, *number, &mut random);
                        distribution.value(u, measured)
                    }
                };
                (field.path.clone(), value)
            })
            .collect();
        let given = fields.iter().find(|(path, _)| path == RUN_SEED);
        let seed = given.map(|(_, value)| value).or(self.set_seed.as_ref());
        let seed = seed.cloned().unwrap_or_else(|| {
            let stream = match &self.spread {
                Spread::Saltelli(_, layout) => layout.seed_stream(index),
                _ => index,
            };
            let mut stream = RandomStream::new(self.seed, Purpose::RunSeed, stream);
            stream.bits().to_string()
        });
        Inputs { fields, seed }
    }

    /// How the runs of a Saltelli plan are laid out.
    #[must_use]
    pub fn saltelli(&self) -> Option<Saltelli> {
        match self.spread {
            Spread::Saltelli(_, layout) => Some(layout),
            _ => None,
        }
    }

    /// Whether fields are drawn independently of each other and of the runs before, but for the strata of a Latin
    /// hypercube.
    #[must_use]
    pub fn is_independent(&self) -> bool {
        let is_drawn = |field: &Field| matches!(field.source, FieldSource::Drawn(..));
        let is_spread = matches!(
            self.spread,
            Spread::Independent | Spread::LatinHypercube(..)
        );
        is_spread && self.fields.iter().all(is_drawn)
    }

    /// Names of the fields that vary, in the order of the table.
    #[must_use]
    pub fn field_names(&self) -> Vec<&str> {
        self.fields
            .iter()
            .map(|field| field.path.as_str())
            .collect()
    }

    /// Whether all values that a field may have are numbers that 64 bits of floating point hold.
    #[must_use]
    pub fn is_numeric(&self, field: usize) -> bool {
        let Some(field) = self.fields.get(field) else {
            return false;
        };
        match &field.source {
            FieldSource::Steps(values, _) => values.iter().all(|value| is_number(value)),
            FieldSource::Drawn(_, Distribution::Choice(values), _) => {
                values.iter().all(|value| is_number(&value.0))
            }
            FieldSource::Drawn(..) => true,
        }
    }

    /// Some values of each field that a scene should accept: of steps and choices all, up to a hundred.
    pub(super) fn samples(&self) -> Vec<(&str, Vec<String>)> {
        let of_field = |field: &Field| match &field.source {
            FieldSource::Steps(values, _) => values.iter().take(100).cloned().collect(),
            FieldSource::Drawn(_, Distribution::Choice(values), _) => values
                .iter()
                .take(100)
                .map(|value| value.0.clone())
                .collect(),
            FieldSource::Drawn(_, distribution, measured) => {
                vec![distribution.value(0.5, measured)]
            }
        };
        let fields = self.fields.iter();
        fields
            .map(|field| (field.path.as_str(), of_field(field)))
            .collect()
    }

    /// The part of a distribution that lies below the value of a run; `random` are the run's own draws.
    fn part(&self, index: u64, number: usize, random: &mut RandomStream) -> f64 {
        let jitter = random.unit();
        match &self.spread {
            Spread::Saltelli(sequence, layout) => {
                let half = if layout.is_of_b(index, number) {
                    sequence.fields() / 2
                } else {
                    0
                };
                sequence.coordinate(index / layout.runs_each(), half + number)
            }
            Spread::Independent => jitter,
            Spread::Sobol(sequence) => sequence.coordinate(index, number),
            Spread::LatinHypercube(strata) => {
                let order = strata
                    .get(number)
                    .and_then(|order| order.get(index as usize));
                let part = (f64::from(order.copied().unwrap_or(0)) + jitter) / self.runs as f64;
                part.min(1.0 - f64::EPSILON)
            }
        }
    }
}

/// The seed that a campaign sets for all its runs.
pub(super) fn set_seed(specification: &CampaignSpec) -> Option<String> {
    let mut set = specification.set.0.iter();
    set.find_map(|(path, value)| (path == RUN_SEED).then(|| value.0.clone()))
}

/// Whether a text is a number; a whole one above 2^53, such as a seed, would lose digits as one.
fn is_number(text: &str) -> bool {
    let is_whole = text.chars().all(|c| c.is_ascii_digit() || c == '-');
    let value = text.parse::<f64>().ok().filter(|value| value.is_finite());
    value.is_some_and(|value| !is_whole || value.abs() <= (1_u64 << 53) as f64)
}

/// The number of runs; fields in steps get their strides.
fn count_runs(
    specification: &CampaignSpec,
    fields: &mut [Field],
    faults: &mut Faults,
) -> Option<u64> {
    let steps = fields
        .iter_mut()
        .filter_map(|field| match &mut field.source {
            FieldSource::Steps(values, stride) => Some((&field.path, values.len() as u64, stride)),
            FieldSource::Drawn(..) => None,
        });
    let own = match &specification.plan {
        PlanSpec::Grid => {
            let mut combinations = 1_u64;
            // The last field goes fastest.
            for (_, count, stride) in steps.collect::<Vec<_>>().into_iter().rev() {
                *stride = combinations;
                combinations = combinations.saturating_mul(count);
            }
            combinations
        }
        PlanSpec::Lists | PlanSpec::Table(_) => {
            let steps: Vec<_> = steps.collect();
            let Some((first, count, _)) = steps.first() else {
                faults.0.add(
                    "plan",
                    "no field of `vary` is in steps",
                    "use `List` or `Levels`",
                );
                return None;
            };
            for (path, other, _) in &steps {
                if other != count {
                    let message = format!("{other} values, and `{first}` has {count}");
                    faults
                        .0
                        .add(&entry_path("vary", path), message, "lists go side by side");
                    return None;
                }
            }
            *count
        }
        PlanSpec::Saltelli => {
            return Saltelli::of_campaign(specification).runs(specification, faults);
        }
        _ => return specification.runs,
    };
    if let Some(runs) = specification.runs.filter(|runs| *runs != own) {
        let message = format!("`runs` is {runs}, and the plan has {own} runs");
        faults.0.add("runs", message, "leave it out");
        return None;
    }
    if own == 0 || own > MOST_RUNS {
        faults.0.add(
            "plan",
            format!("{own} runs are not from 1 to {MOST_RUNS}"),
            "",
        );
        return None;
    }
    Some(own)
}

#[cfg(test)]
mod tests {
    use super::super::specification::read_specification;
    use super::*;

    fn plan(head: &str, vary: &str) -> Plan {
        let text = format!(
            "(name: \"a\", scene: \"a.ron\", {head}, vary: {{{vary}}}, \
             metrics: {{\"x_m\": Final(entity: \"a\", channel: \"x_m\")}})"
        );
        let (specification, _) = read_specification("a.ron", &text).unwrap();
        let tables = PlanTables {
            plan: None,
            measured: Vec::new(),
        };
        Plan::new(&specification, tables, &mut Faults::default()).unwrap()
    }

    fn values(plan: &Plan, field: usize) -> Vec<String> {
        (0..plan.runs)
            .map(|index| plan.inputs(index).fields[field].1.clone())
            .collect()
    }

    #[test]
    fn a_grid_has_every_combination() {
        let grid = plan(
            "plan: Grid",
            "\"a\": List([1, 2]), \"b\": Levels(from: 0, to: 1, count: 3)",
        );
        assert_eq!(grid.runs, 6);
        assert_eq!(values(&grid, 0), ["1", "1", "1", "2", "2", "2"]);
        assert_eq!(values(&grid, 1), ["0.0", "0.5", "1.0", "0.0", "0.5", "1.0"]);
    }

    #[test]
    fn inputs_do_not_depend_on_the_number_of_runs() {
        let vary = "\"a\": Uniform(0, 1), \"b\": Choice([Vira, Table(file: \"a, b\")])";
        for way in ["MonteCarlo", "Sobol"] {
            let few = plan(&format!("runs: 4, seed: 3, plan: {way}"), vary);
            let many = plan(&format!("runs: 400, seed: 3, plan: {way}"), vary);
            (0..4).for_each(|index| assert_eq!(few.inputs(index), many.inputs(index)));
            assert_ne!(many.inputs(0), many.inputs(1));
            let other = plan(&format!("runs: 4, seed: 4, plan: {way}"), vary);
            assert_ne!(few.inputs(0), other.inputs(0));
            let chosen = values(&many, 1);
            assert!(chosen.iter().any(|value| value == "Table(file: \"a, b\")"));
        }
    }

    /// One run in each of a hundred parts of either field.
    #[test]
    fn a_latin_hypercube_takes_every_part_once() {
        let vary = "\"a\": Uniform(0, 100), \"b\": Uniform(0, 100)";
        let plan = plan("runs: 100, plan: LatinHypercube", vary);
        for field in 0..2 {
            let numbers = values(&plan, field).into_iter();
            let mut parts: Vec<u32> = numbers.map(|x| x.parse::<f64>().unwrap() as u32).collect();
            parts.sort_unstable();
            assert!(parts.iter().enumerate().all(|(k, part)| k as u32 == *part));
        }
    }

    #[test]
    fn a_seed_that_varies_is_the_seed() {
        let seeds = plan("plan: Lists", "\"run.seed\": List([5, 6])");
        assert_eq!(seeds.inputs(1).overrides(), ["run.seed=6"]);
        let drawn = plan("runs: 2", "\"a\": Uniform(0, 1)");
        assert_ne!(drawn.inputs(0).seed, drawn.inputs(1).seed);
    }
}
