//! `aerobot campaign submit`.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use aerobot_engine::campaign::CampaignError;
use aerobot_engine::campaign::definition::Campaign;
use aerobot_engine::campaign::slurm::Slurm;
use aerobot_engine::campaign::submission::{
    JobArray, OUTPUT, Order, Resources, Scheduler, Shares, arrays, ranges, shell_word,
};
use clap::Args;

use super::{complain, say};

/// The largest index of an array where nothing says otherwise: Slurm's own default.
const USUAL_LARGEST_INDEX: u64 = 1000;

#[derive(Args)]
pub(super) struct SubmitArguments {
    /// The folder of a planned campaign, where all machines can read and write it.
    folder: PathBuf,
    #[command(flatten)]
    scheduler: SchedulerArguments,
    /// The partition; the scheduler's default unless given.
    #[arg(long, value_name = "P")]
    partition: Option<String>,
    /// Limit on the wall time of a shard, as the scheduler writes it.
    #[arg(long, value_name = "T")]
    time: Option<String>,
    /// Memory of a shard, as the scheduler writes it.
    #[arg(long, value_name = "SIZE")]
    memory: Option<String>,
    /// Processors, and threads, of a shard.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4096))]
    cpus: u32,
    /// Print what would be submitted, and submit nothing.
    #[arg(long)]
    dry_run: bool,
    /// Print nothing but errors.
    #[arg(long)]
    quiet: bool,
}

/// Which scheduler: a flag for each.
#[derive(Args)]
#[group(required = true, multiple = false)]
struct SchedulerArguments {
    /// Submit to Slurm.
    #[arg(long)]
    slurm: bool,
}

impl SchedulerArguments {
    fn scheduler(&self) -> &'static dyn Scheduler {
        let Self { slurm: _ } = self;
        &Slurm
    }
}

impl SubmitArguments {
    /// An answer of the scheduler; for a dry run, which serves where there is no scheduler too, a guess.
    fn or_guess<T>(
        &self,
        answer: Result<T, CampaignError>,
        guess: T,
        consequence: &str,
    ) -> Result<T, CampaignError> {
        match answer {
            Err(error) if self.dry_run => {
                complain(format_args!("{error}\n  = note: {consequence}"));
                Ok(guess)
            }
            answer => answer,
        }
    }
}

pub(super) fn submit(arguments: &SubmitArguments) -> Result<ExitCode, CampaignError> {
    let campaign = Campaign::open(&arguments.folder)?;
    let scheduler = arguments.scheduler.scheduler();
    let program = std::env::current_exe().map_err(|error| {
        CampaignError::refused(
            format_args!("cannot tell where this program is: {error}"),
            "",
        )
    })?;
    let resources = Resources {
        partition: arguments.partition.clone(),
        time: arguments.time.clone(),
        memory: arguments.memory.clone(),
        cpus: arguments.cpus,
    };
    let order = Order::new(&campaign, &program, resources)?;
    let tell = |line: String| {
        if !arguments.quiet {
            say(line);
        }
    };
    let everything_missing = Shares::new(&campaign, &BTreeSet::new())?;
    if everything_missing.finished == campaign.manifest.shards {
        tell(format!(
            "all {} shards are finished",
            campaign.manifest.shards
        ));
        return Ok(ExitCode::SUCCESS);
    }
    let answer = scheduler.queued(&order);
    let consequence = "shards that have jobs are not left out";
    let queued = arguments.or_guess(answer, BTreeSet::new(), consequence)?;
    let shares = Shares::new(&campaign, &queued)?;
    let left_out = [
        (&shares.queued, "have jobs"),
        (&shares.held, "are at work without a job"),
    ];
    if !arguments.dry_run {
        for (shards, state) in left_out.iter().filter(|(shards, _)| !shards.is_empty()) {
            tell(format!("left out: shards {} {state}", ranges(shards)));
        }
    }
    if shares.missing.is_empty() {
        tell("nothing to submit".to_owned());
        return Ok(ExitCode::SUCCESS);
    }
    let answer = scheduler.largest_index();
    let consequence = "indices are taken to be at most 1000";
    let largest_index = arguments.or_guess(answer, USUAL_LARGEST_INDEX, consequence)?;
    let arrays = arrays(&shares.missing, largest_index)?;
    if arguments.dry_run {
        print(scheduler, &order, &arrays);
        return Ok(ExitCode::SUCCESS);
    }
    submit_all(scheduler, &order, &campaign, &arrays, &tell)?;
    Ok(ExitCode::SUCCESS)
}

/// What would be done, as a shell does it.
fn print(scheduler: &dyn Scheduler, order: &Order, arrays: &[JobArray]) {
    let output = format!("{}/{OUTPUT}", order.folder);
    say(format_args!("mkdir -p {}", shell_word(&output)));
    for array in arrays {
        let invocation = scheduler.invocation(order, array);
        let words = invocation.words.iter().map(|word| shell_word(word));
        let command = words.collect::<Vec<_>>().join(" ");
        say(format_args!(
            "{command} <<'SCRIPT'\n{}SCRIPT",
            invocation.input
        ));
    }
}

fn submit_all(
    scheduler: &dyn Scheduler,
    order: &Order,
    campaign: &Campaign,
    arrays: &[JobArray],
    tell: &dyn Fn(String),
) -> Result<(), CampaignError> {
    let output = campaign.folder.join(OUTPUT);
    fs::create_dir_all(&output).map_err(|error| {
        let message = format!("cannot write `{}`: {error}", output.display());
        CampaignError::refused(message, "")
    })?;
    for (number, array) in arrays.iter().enumerate() {
        let shards: Vec<u64> = array.indices.iter().map(|i| i + array.offset).collect();
        let job = scheduler
            .submit(order, array)
            .map_err(|error| CampaignError {
                begun: number > 0,
                ..error
            })?;
        tell(format!("job {job}: shards {}", ranges(&shards)));
    }
    Ok(())
}
