//! `aerobot campaign submit` against stand-ins for Slurm's commands: what is submitted, what is left out, and
//! whether what a job is given runs its shard. Against Slurm itself: `scripts/slurm_on_loopback.sh`.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test fails by panicking"
)]

mod program;

use std::fs;
use std::fs::File;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

use program::{Scratch, aerobot, text};

/// A campaign of eight shards in a folder whose name shells do not take as it is, and commands that stand in for
/// Slurm's: the only ones on the path.
struct Site {
    scratch: Scratch,
    folder: String,
}

/// Says which arguments `sbatch` got, and what it read.
const SBATCH: &str = r#"#!/bin/sh
here=${0%/*}/..
{
    printf '%s\n' "$@"
    while IFS= read -r line; do printf '%s\n' "$line"; done
    echo
} >>"$here/submitted"
echo '41;cluster'
"#;
const SQUEUE: &str = r#"#!/bin/sh
printf '%s\n' "$@" "$SQUEUE_STATES" >"${0%/*}/../asked"
[ -e "${0%/*}/../queue" ] || exit 0
while IFS= read -r line; do printf '%s\n' "$line"; done <"${0%/*}/../queue"
"#;
const SCONTROL: &str = "#!/bin/sh\necho 'MaxArraySize            = 1001'\n";

impl Site {
    fn new() -> Self {
        let scratch = Scratch::folder();
        let scene = fs::read_to_string("scenes/examples/free_fall.ron").unwrap();
        scratch.file("free_fall.ron", &scene);
        let campaign = r#"(
    name: "falls",
    scene: "free_fall.ron",
    runs: 16,
    seed: 7,
    set: {"run.duration_s": 1, "run.integrator": Auto()},
    vary: {"entities.sphere.Body.mass_kg": Uniform(3, 4)},
    metrics: {"height_z_m": Final(entity: "sphere", channel: "z_m")},
)
"#;
        let file = scratch.file("falls.ron", campaign);
        let folder = scratch.path("it's 100 %a");
        let plan = ["campaign", "plan", &file, "--out", &folder, "--shards", "8"];
        assert!(aerobot(&plan).status.success());
        let site = Self { scratch, folder };
        site.stand_in("sbatch", SBATCH);
        site.stand_in("squeue", SQUEUE);
        site.stand_in("scontrol", SCONTROL);
        site
    }

    fn stand_in(&self, name: &str, script: &str) {
        let path = self.scratch.file(&format!("bin/{name}"), script);
        fs::set_permissions(path, fs::Permissions::from_mode(0o755)).unwrap();
    }

    /// With nothing on the path but the stand-ins.
    fn command(&self, program: &str, arguments: &[&str]) -> Output {
        let mut command = Command::new(program);
        command
            .args(arguments)
            .env("PATH", self.scratch.path("bin"));
        command.env("SQUEUE_STATES", "SUSPENDED").output().unwrap()
    }

    fn submit(&self, arguments: &[&str]) -> Output {
        let submit = ["campaign", "submit", &self.folder, "--slurm"];
        self.command(
            env!("CARGO_BIN_EXE_aerobot"),
            &[&submit, arguments].concat(),
        )
    }

    /// What it prints when it has nothing to complain about.
    fn submitted(&self, arguments: &[&str]) -> String {
        let output = self.submit(arguments);
        assert_eq!(text(&output.stderr), "");
        assert_eq!(output.status.code(), Some(0));
        text(&output.stdout)
    }

    /// With an exit code and some words.
    fn refused(&self, arguments: &[&str], code: i32, words: &[&str]) {
        let output = self.submit(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{said}");
        for words in words {
            assert!(said.contains(words), "{said}");
        }
    }

    fn run(&self, shard: u64) {
        let shard = format!("{shard}/8");
        let output = aerobot(&["campaign", "run", &self.folder, "--shard", &shard]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }

    fn part(&self, shard: u64) -> String {
        format!("{}/shards/shard-{shard:05}.part", self.folder)
    }

    /// What `sbatch` got since the last time: a text for each call.
    fn calls(&self) -> Vec<String> {
        let path = self.scratch.path("submitted");
        let calls = fs::read_to_string(&path).unwrap_or_default();
        let _ = fs::remove_file(&path);
        calls.split_terminator("\n\n").map(str::to_owned).collect()
    }
}

/// The value of an option in what `sbatch` got.
fn option<'a>(call: &'a str, name: &str) -> &'a str {
    let start = format!("--{name}=");
    let line = call.lines().find_map(|line| line.strip_prefix(&start));
    line.unwrap_or_else(|| panic!("no {name} in {call}"))
}

/// A shell that is given what a dry run prints submits the same as the program does, and what `sbatch` reads
/// then runs the shard of its place in the array.
#[test]
fn a_dry_run_prints_what_a_submission_does() {
    let site = Site::new();
    site.run(2);
    site.run(5);
    let asked = ["--partition", "day and night", "--time", "1:30:00"];
    let asked = [&asked[..], &["--memory", "2G", "--cpus", "3"]].concat();
    let printed = site.submitted(&[&asked[..], &["--dry-run"]].concat());
    assert!(!Path::new(&format!("{}/slurm", site.folder)).exists());
    assert_eq!(site.calls().len(), 0);
    // The one other command that it needs.
    site.stand_in("mkdir", "#!/bin/sh\n[ \"$1\" = -p ]\n");
    let shell = site.command("/bin/sh", &["-c", &printed]);
    assert!(shell.status.success(), "{}", text(&shell.stderr));
    let by_shell = site.calls();
    let said = site.submitted(&asked);
    assert_eq!(said, "job 41: shards 1,3-4,6-8\n");
    let calls = site.calls();
    assert_eq!(calls, by_shell);
    let [call] = &calls[..] else {
        panic!("{calls:?}")
    };
    for (name, value) in [
        ("array", "1,3-4,6-8"),
        ("job-name", "aerobot-falls"),
        ("chdir", &site.folder),
        ("partition", "day and night"),
        ("time", "1:30:00"),
        ("mem", "2G"),
        ("cpus-per-task", "3"),
        ("open-mode", "append"),
    ] {
        assert_eq!(option(call, name), value);
    }
    let output = format!("{}/slurm/%A_%a.out", site.folder.replace('%', "%%"));
    assert_eq!(option(call, "output"), output);
    assert!(call.contains("--requeue\n") && call.contains("--workers 3"));
    assert!(Path::new(&format!("{}/slurm", site.folder)).is_dir());

    let script = &call[call.find("#!/bin/sh").unwrap()..];
    let job = Command::new("/bin/sh")
        .args(["-c", script])
        .current_dir("/")
        .env("SLURM_ARRAY_TASK_ID", "7")
        .output()
        .unwrap();
    assert!(job.status.success(), "{}", text(&job.stderr));
    assert!(text(&job.stdout).starts_with("shard 7/8: 2 runs"));
    site.submitted(&["--quiet"]);
    assert_eq!(option(&site.calls()[0], "array"), "1,3-4,6,8");
}

#[test]
fn shards_with_jobs_and_at_work_are_left_out() {
    let site = Site::new();
    site.submitted(&[]);
    let call = site.calls().remove(0);
    let tag = option(&call, "comment").strip_suffix(":0").unwrap();
    // Of another campaign of the same name, and of one whose comment is not ours.
    let foreign = "1 aerobot:0123456789abcdef:0123456789abcdef:0\n2 (null)\n";
    let queue = format!("{foreign}3 {tag}:0\n4 {tag}:0\n2 {tag}:5\n");
    site.scratch.file("queue", &queue);
    let held = File::create(site.part(5)).unwrap();
    held.lock().unwrap();
    let said = site.submitted(&[]);
    let left_out =
        "left out: shards 3-4,7 have jobs\nleft out: shards 5 are at work without a job\n";
    assert_eq!(said, format!("{left_out}job 41: shards 1-2,6,8\n"));
    assert_eq!(option(&site.calls()[0], "array"), "1-2,6,8");
    let asked = fs::read_to_string(site.scratch.path("asked")).unwrap();
    assert!(asked.contains("--name=aerobot-falls\n"));
    assert!(!asked.contains("SUSPENDED"));

    let all: String = (1..=8).map(|shard| format!("{shard} {tag}:0\n")).collect();
    site.scratch.file("queue", &all);
    let said = site.submitted(&[]);
    assert!(said.ends_with("nothing to submit\n"), "{said}");
    assert_eq!(site.calls().len(), 0);

    // Another folder of the same campaign has jobs of its own.
    let (folder, other) = (&site.folder, site.scratch.path("other"));
    fs::rename(folder, &other).unwrap();
    let submit = ["campaign", "submit", &other, "--slurm"];
    let output = site.command(env!("CARGO_BIN_EXE_aerobot"), &submit);
    assert!(text(&output.stdout).ends_with("job 41: shards 1-4,6-8\n"));
}

/// Shards beyond the largest index are submitted with what is to be added to theirs.
#[test]
fn long_campaigns_are_divided_into_arrays() {
    let site = Site::new();
    site.stand_in("scontrol", &SCONTROL.replace("1001", "4"));
    site.run(5);
    let said = site.submitted(&[]);
    assert_eq!(
        said,
        "job 41: shards 1-3\njob 41: shards 4,6\njob 41: shards 7-8\n"
    );
    let calls = site.calls();
    let parts = [
        ("1-3", ":0", "auto "),
        ("1,3", ":3", "auto+3 "),
        ("1-2", ":6", "auto+6 "),
    ];
    for (call, (array, offset, shard)) in calls.iter().zip(parts) {
        assert_eq!(option(call, "array"), array);
        assert!(option(call, "comment").ends_with(offset));
        assert!(call.contains(&format!("--shard {shard}")), "{call}");
    }
    site.stand_in("scontrol", &SCONTROL.replace("1001", "0"));
    site.refused(&[], 2, &["without arrays", "--shard K/N"]);
    // The first array is in the queue, the second is refused.
    site.stand_in("scontrol", &SCONTROL.replace("1001", "4"));
    let once = SBATCH.replace("here=", "[ ! -e ${0%/*}/../submitted ] || exit 1\nhere=");
    site.stand_in("sbatch", &once);
    site.refused(&[], 3, &["`sbatch` ended with exit status: 1"]);
    assert_eq!(site.calls().len(), 1);
}

#[test]
fn slurm_refuses_in_its_own_words() {
    let site = Site::new();
    site.stand_in(
        "sbatch",
        "#!/bin/sh\necho 'sbatch: error: invalid partition specified: dusk' >&2\nexit 1\n",
    );
    site.refused(
        &["--partition", "dusk"],
        2,
        &["invalid partition specified: dusk"],
    );
    fs::remove_file(site.scratch.path("bin/sbatch")).unwrap();
    site.refused(&[], 2, &["there is no `sbatch` here", "--dry-run"]);
    site.stand_in(
        "squeue",
        "#!/bin/sh\necho 'squeue: error: Unable to contact' >&2\nexit 1\n",
    );
    site.refused(&[], 2, &["`squeue` ended", "Unable to contact"]);

    // A dry run does without, and says what it does not know.
    fs::remove_file(site.scratch.path("bin/scontrol")).unwrap();
    let output = site.submit(&["--dry-run"]);
    assert_eq!(output.status.code(), Some(0));
    assert!(text(&output.stdout).contains("--array=1-8 "));
    let said = text(&output.stderr);
    assert!(
        said.contains("are not left out") && said.contains("at most 1000"),
        "{said}"
    );

    let nothing = aerobot(&["campaign", "submit", &site.folder]);
    assert_eq!(nothing.status.code(), Some(2));
    assert!(text(&nothing.stderr).contains("--slurm"));
    let nowhere = aerobot(&["campaign", "submit", &site.scratch.path("no"), "--slurm"]);
    assert_eq!(nowhere.status.code(), Some(2));

    // Where everything is finished nobody is asked.
    (1..=8).for_each(|shard| site.run(shard));
    assert_eq!(site.submitted(&[]), "all 8 shards are finished\n");
    assert_eq!(site.submitted(&["--quiet"]), "");
}

/// A second process at a shard is refused at once, or waits for the first.
#[test]
fn a_shard_at_work_is_waited_for() {
    let site = Site::new();
    let held = File::create(site.part(3)).unwrap();
    held.lock().unwrap();
    let run = ["campaign", "run", &site.folder, "--shard", "3/8"];
    let at_once = aerobot(&run);
    assert_eq!(at_once.status.code(), Some(2));
    assert!(text(&at_once.stderr).contains("another process is at work"));
    let mut waiting = Command::new(env!("CARGO_BIN_EXE_aerobot"))
        .args([&run[..], &["--wait", "60", "--quiet"]].concat())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(500));
    assert!(waiting.try_wait().unwrap().is_none());
    assert_eq!(fs::read(site.part(3)).unwrap(), b"");
    drop(held);
    assert!(waiting.wait().unwrap().success());
    assert!(!Path::new(&site.part(3)).exists());
}
