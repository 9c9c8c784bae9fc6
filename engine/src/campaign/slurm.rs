//! Slurm, through its own commands: `sbatch`, `squeue`, `scontrol`.
//!
//! Jobs are known by their comment, `aerobot:FINGERPRINT:PLACE:OFFSET`: the campaign, its folder, and what is added
//! to an index in the array for the number of the shard.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::process::{Command, Stdio};

use super::CampaignError;
use super::submission::{
    Invocation, JobArray, OUTPUT, Order, Resources, Scheduler, WAIT_S, ranges, shell_word,
};

/// The workload manager Slurm.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slurm;

impl Scheduler for Slurm {
    fn largest_index(&self) -> Result<u64, CampaignError> {
        let answer = answer_of(Command::new("scontrol").args(["show", "config"]), "")?;
        largest_index_of(&answer).ok_or_else(|| {
            let message = "`scontrol show config` does not say `MaxArraySize`";
            CampaignError::refused(message, "")
        })
    }

    fn queued(&self, order: &Order) -> Result<BTreeSet<u64>, CampaignError> {
        let mut command = Command::new("squeue");
        // What a user likes to see by default would hide jobs.
        for (name, _) in std::env::vars_os() {
            if name.as_encoded_bytes().starts_with(b"SQUEUE_") {
                command.env_remove(name);
            }
        }
        command.args(["--all", "--array", "--noheader", "--format=%K %k"]);
        let answer = answer_of(command.arg(format!("--name={}", order.name)), "")?;
        let shards = answer.lines().filter_map(|line| shard_of(line, &order.tag));
        Ok(shards.collect())
    }

    fn invocation(&self, order: &Order, array: &JobArray) -> Invocation {
        let Resources {
            partition,
            time,
            memory,
            cpus,
        } = &order.resources;
        let mut words: Vec<String> = ["sbatch", "--parsable"].map(str::to_owned).into();
        words.push(format!("--job-name={}", order.name));
        words.push(format!("--comment={}:{}", order.tag, array.offset));
        words.push(format!("--array={}", ranges(&array.indices)));
        words.push(format!("--chdir={}", order.folder));
        // Slurm puts numbers for `%A` and `%a`, and `%` for `%%`.
        let folder = order.folder.replace('%', "%%");
        words.push(format!("--output={folder}/{OUTPUT}/%A_%a.out"));
        words.extend(["--open-mode=append", "--requeue", "--ntasks=1"].map(str::to_owned));
        words.push(format!("--cpus-per-task={cpus}"));
        for (option, value) in [("partition", partition), ("time", time), ("mem", memory)] {
            words.extend(value.as_ref().map(|value| format!("--{option}={value}")));
        }
        let shard = match array.offset {
            0 => "auto".to_owned(),
            offset => format!("auto+{offset}"),
        };
        let (program, folder) = (shell_word(&order.program), shell_word(&order.folder));
        let input = format!(
            "#!/bin/sh\nexec {program} campaign run {folder} --shard {shard} --workers {cpus} --wait {WAIT_S}\n"
        );
        Invocation { words, input }
    }

    fn submit(&self, order: &Order, array: &JobArray) -> Result<String, CampaignError> {
        if order.folder.contains('\\') {
            let message = format!("`{}`: Slurm takes no folder with a backslash", order.folder);
            return Err(CampaignError::refused(message, "give it another name"));
        }
        let Invocation { words, input } = self.invocation(order, array);
        let answer = answer_of(Command::new(&words[0]).args(&words[1..]), &input)?;
        let job = answer.trim().split(';').next().unwrap_or_default();
        Ok(job.to_owned())
    }
}

/// What a command prints, given some input.
fn answer_of(command: &mut Command, input: &str) -> Result<String, CampaignError> {
    let name = command.get_program().to_string_lossy().into_owned();
    let command = command.stdin(Stdio::piped());
    let output = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let output = output.and_then(|mut child| {
        if let Some(mut pipe) = child.stdin.take() {
            // One that ends without reading says why in its own words.
            let _ = pipe.write_all(input.as_bytes());
        }
        child.wait_with_output()
    });
    match output {
        Ok(output) if output.status.success() => {
            Ok(String::from_utf8_lossy(&output.stdout).into_owned())
        }
        Ok(output) => {
            let said = String::from_utf8_lossy(&output.stderr);
            let message = format!("`{name}` ended with {}: {}", output.status, said.trim());
            Err(CampaignError::refused(message, ""))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let message = format!("there is no `{name}` here");
            let help =
                "Slurm is asked by its own commands; `--dry-run` prints what would be submitted";
            Err(CampaignError::refused(message, help))
        }
        Err(error) => {
            let message = format!("cannot run `{name}`: {error}");
            Err(CampaignError::refused(message, ""))
        }
    }
}

/// The largest index of an array, one less than `MaxArraySize`, of `scontrol show config`.
fn largest_index_of(configuration: &str) -> Option<u64> {
    configuration.lines().find_map(|line| {
        let (name, value) = line.split_once('=')?;
        let size = value.trim().parse::<u64>().ok();
        size.filter(|_| name.trim() == "MaxArraySize")
            .map(|size| size.saturating_sub(1))
    })
}

/// The shard of a line of the queue, `INDEX COMMENT`, if it is one of ours.
fn shard_of(line: &str, tag: &str) -> Option<u64> {
    let (index, comment) = line.trim().split_once(' ')?;
    let offset = comment.trim().strip_prefix(tag)?.strip_prefix(':')?;
    index.parse::<u64>().ok()?.checked_add(offset.parse().ok()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_read() {
        let configuration =
            "MailProg   = /bin/mail\nMaxArraySize            = 1001\nMaxJobCount = 10000\n";
        assert_eq!(largest_index_of(configuration), Some(1000));
        assert_eq!(largest_index_of("MaxArraySize = 0"), Some(0));
        assert_eq!(largest_index_of("MaxJobCount = 10000"), None);
        assert_eq!(shard_of("7 aerobot:a:b:0", "aerobot:a:b"), Some(7));
        assert_eq!(
            shard_of("7    aerobot:a:b:1000 ", "aerobot:a:b"),
            Some(1007)
        );
        for foreign in [
            "7 aerobot:a:c:0",
            "N/A aerobot:a:b:0",
            "7 (null)",
            "",
            "7 aerobot:a:bc:0",
        ] {
            assert_eq!(shard_of(foreign, "aerobot:a:b"), None, "{foreign}");
        }
    }
}
