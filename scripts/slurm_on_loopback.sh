#!/bin/bash
# A campaign of eight shards on a Slurm of two nodes, both on this machine, one of which is lost in the middle; its
# results are then compared, byte by byte, with those of one process.
#
#   scripts/slurm_on_loopback.sh [kill|silence|none] [--install]
#
#   kill      the node dies: its slurmd, its slurmstepd and what they run get SIGKILL (the default)
#   silence   the node is only thought dead: it is stopped, and what it runs wakes up when Slurm has begun its shard anew
#   none      no node is lost
#   --install apt-get installs `slurm-wlm` and `munge` if they are missing; otherwise nothing is installed
#
# AEROBOT=PATH is the program, `target/release/aerobot` unless given. It needs root, since slurmd does, and Debian's
# `slurm-wlm` and `munge`, but no systemd. Everything is in a folder of its own below TMPDIR, which is removed
# at the end unless KEEP=1, and every process that was started is ended. PORT=17000 is the first of three ports.
# Exit code 0 if every check holds, 1 if one fails, 2 if it cannot be run here.
set -u -o pipefail

way=kill
install=no
for argument in "$@"; do
    case $argument in
    kill | silence | none) way=$argument ;;
    --install) install=yes ;;
    *)
        sed -n '2,/^set/{/^#/s/^# \{0,1\}//p}' "$0"
        exit 2
        ;;
    esac
done

root=$(cd "$(dirname "$0")/.." && pwd)
aerobot=$(realpath -m "${AEROBOT:-$root/target/release/aerobot}")
port=${PORT:-17000}
shards=8
shard_s=4
commands="slurmctld slurmd munged sbatch squeue scontrol sinfo scancel"

cannot() {
    echo "cannot run: $*" >&2
    exit 2
}
missing() {
    local command
    for command in $commands; do
        PATH=$PATH:/usr/sbin command -v "$command" >/dev/null || echo "$command"
    done
}

[ "$(id -u)" = 0 ] || cannot "slurmd needs root"
if [ -n "$(missing)" ] && [ $install = yes ]; then
    apt-get install --yes --no-install-recommends slurm-wlm munge || cannot "apt-get failed"
fi
[ -z "$(missing)" ] || cannot "there is no" $(missing) "here: apt-get install slurm-wlm munge, or --install"
[ -x "$aerobot" ] || cannot "there is no $aerobot: cargo build --release, or AEROBOT=PATH"
PATH=$PATH:/usr/sbin

started=$SECONDS
scratch=$(mktemp -d "${TMPDIR:-/tmp}/slurm-on-loopback.XXXXXX") || exit 2
chmod 755 "$scratch"
# Every process of a job has this in its environment: so they are told from those of others.
export SLURM_CONF=$scratch/slurm.conf
failures=0

# Processes of jobs of this Slurm, on one node if that is given.
tasks() {
    local found
    found=$(grep -lszxF "SLURM_CONF=$SLURM_CONF" /proc/[0-9]*/environ)
    [ -z "$found" ] || grep -lszx "SLURMD_NODENAME=${1:-w[12]}" $found | tr -cd '0-9\n'
}
# The slurmstepd above each of these processes.
steps() {
    local pid parent
    for pid in "$@"; do
        parent=$(awk '/^PPid:/ { print $2 }' "/proc/$pid/status" 2>/dev/null)
        [ -n "$parent" ] && [ "$(cat "/proc/$parent/comm" 2>/dev/null)" = slurmstepd ] && echo "$parent"
    done
}
pid_of() { cat "$scratch/$1.pid" 2>/dev/null; }
is_alive() { [ -n "$1" ] && kill -0 "$1" 2>/dev/null && ! grep -q '^State:.Z' "/proc/$1/status" 2>/dev/null; }
end() {
    local pid=$1 tries
    is_alive "$pid" || return 0
    kill -CONT "$pid"
    kill -TERM "$pid"
    for tries in $(seq 50); do
        is_alive "$pid" || return 0
        sleep 0.1
    done
    kill -KILL "$pid"
}
clean() {
    trap '' INT TERM HUP
    local name pids
    pids=$(tasks)
    pids="$(steps $pids) $pids"
    [ -z "${pids// /}" ] || kill -KILL $pids 2>/dev/null
    for name in w1 w2 slurmctld munged; do end "$(pid_of $name)"; done
    if [ "${KEEP:-0}" = 1 ]; then echo "kept: $scratch"; else rm -rf "$scratch"; fi
}
trap clean EXIT
trap 'exit 1' INT TERM HUP

check() {
    local what=$1
    shift
    if "$@"; then
        printf '%4d s  ok      %s\n' $((SECONDS - started)) "$what"
    else
        printf '%4d s  FAILED  %s\n' $((SECONDS - started)) "$what"
        failures=$((failures + 1))
    fi
}
has() { grep -qF -- "$2" "$1"; }
# Waits for a condition at most so many seconds.
within() {
    local until=$((SECONDS + $1))
    shift
    until "$@"; do
        [ $SECONDS -lt $until ] || return 1
        sleep 0.2
    done
}
# What nothing goes on without.
need() {
    local before=$failures
    check "$@"
    [ $failures = "$before" ] && return
    tail -n 5 "$scratch"/*.log >&2
    exit 1
}

cat >"$SLURM_CONF" <<CONF
ClusterName=loopback
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$scratch/munge.socket,cred_expire=5
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool.%n
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/%n.pid
SlurmctldLogFile=$scratch/slurmctld.log
SlurmdLogFile=$scratch/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=1,sched_interval=2
SlurmdTimeout=10
ReturnToService=2
# Fewer indices than shards: the campaign needs two arrays.
MaxArraySize=6
NodeName=w1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1
NodeName=w2 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1
PartitionName=loopback Nodes=w1,w2 Default=YES MaxTime=INFINITE State=UP
CONF
mkdir "$scratch/state" "$scratch/spool.w1" "$scratch/spool.w2"
(umask 077 && head -c 1024 /dev/urandom >"$scratch/munge.key")
munged --key-file="$scratch/munge.key" --socket="$scratch/munge.socket" --pid-file="$scratch/munged.pid" \
    --log-file="$scratch/munged.log" --seed-file="$scratch/munge.seed" || cannot "munged does not start"
slurmctld -f "$SLURM_CONF" || cannot "slurmctld does not start"
slurmd -f "$SLURM_CONF" -N w1 || cannot "slurmd does not start"
slurmd -f "$SLURM_CONF" -N w2 || cannot "slurmd does not start"
are_idle() { [ "$(sinfo --noheader --Node --format=%t 2>/dev/null | grep -cx idle)" = 2 ]; }
need "slurmctld, and slurmd for w1 and w2, are up: $(sbatch --version)" within 30 are_idle

# As many runs as make a shard take some seconds here.
campaign_of() {
    cat <<RON
(
    name: "lengths",
    scene: "$root/scenes/paper/comparison_900m.ron",
    plan: MonteCarlo,
    runs: $1,
    seed: 11,
    set: {"run.integrator": Auto()},
    vary: {"entities.tether.Tether.length_m": Uniform(50, 1000)},
    metrics: {"swing_largest_rad": Largest(entity: "gondola", channel: "swing_rad")},
    envelopes: {"gondola_swing_rad": (entity: "gondola", channel: "swing_rad", every_s: 1)},
    keep: (extremes_of: ["swing_largest_rad"]),
)
RON
}
campaign_of 60 >"$scratch/few.ron"
rate=$("$aerobot" campaign run "$scratch/few.ron" --out "$scratch/few" --workers 1 |
    sed -n 's/.*, \([0-9]*\) per second$/\1/p')
[ -n "$rate" ] || cannot "$aerobot does not run a campaign"
runs=$((rate * shard_s * shards))
campaign_of $runs >"$scratch/lengths.ron"
# A folder whose name has what shells and Slurm could take for something else.
folder="$scratch/it's 100 %a"
"$aerobot" campaign plan "$scratch/lengths.ron" --out "$folder" --shards $shards >/dev/null || exit 1
part() { printf '%s/shards/shard-%05d.part' "$folder" "$1"; }
journal() { printf '%s/shards/shard-%05d.journal' "$folder" "$1"; }
finished() { find "$folder/shards" -name '*.journal' | wc -l; }
submit() { "$aerobot" campaign submit "$folder" --slurm "$@" >"$scratch/said" 2>&1; }

check "$runs runs in $shards shards, submitted" submit
check "  as two arrays, since indices are below MaxArraySize=6" \
    sh -c "[ \"\$(cut -d: -f2 '$scratch/said')\" = '$(printf ' shards 1-5\n shards 6-8')' ]"
check "submitted again at once: exit 0" submit
check "  and no shard has a second job" has "$scratch/said" "nothing to submit"

# One job is taken away, as by a user or a limit: the queue ends without its shard.
last=$(squeue --noheader --array --states=PD --format='%i %K %k' | awk '$2 == 3 && /:5$/ { print $1 }')
check "the job of shard 8 ($last) is cancelled before it runs" scancel "$last"

# The shard on a node, and how many of its runs are finished.
shard_on() {
    squeue --noheader --nodes="$1" --states=R --format='%K %k' 2>/dev/null |
        awk 'NR == 1 { n = split($2, parts, ":"); print $1 + parts[n] }'
}
is_in_the_middle() {
    local lines
    lost=$(shard_on w1)
    [ -n "$lost" ] && [ "$(finished)" -ge 2 ] && [ -e "$(part "$lost")" ] || return 1
    lines=$(wc -l <"$(part "$lost")")
    [ "$lines" -gt 5 ] && [ "$lines" -lt $((rate * shard_s / 2)) ]
}
state_of() { sinfo --noheader --nodes="$1" --format=%T; }
is_down() { [[ $(state_of w1) == down* ]]; }
lose() {
    local pids daemon
    daemon=$(pid_of w1)
    pids=$(tasks w1)
    if [ $way = silence ]; then
        kill -STOP "$daemon" $pids
        asleep=$pids
    else
        kill -KILL "$daemon" $(steps $pids) $pids
        cp "$(part "$lost")" "$scratch/left_behind"
    fi
}
starts_with() { cmp -s -n "$(stat -c %s "$2")" "$1" "$2"; }
if [ $way != none ]; then
    need "a shard is in the middle of its runs on w1, and another finished" within 120 is_in_the_middle
    check "  w1 is lost ($way) with shard $lost in work" lose
    check "  Slurm takes w1 for down" within 60 is_down
fi
has_moved() { [ "$(shard_on w2)" = "$lost" ]; }
lines_in() { wc -l <"$(part "$lost")"; }
if [ $way = silence ]; then
    lines=$(lines_in)
    need "  shard $lost is begun anew on w2" within 60 has_moved
    sleep 3
    check "  and waits there, since a process of w1 holds its journal" has_moved
    check "    to which nothing is added" [ "$(lines_in)" = "$lines" ]
    check "  what w1 runs wakes up" kill -CONT $asleep
fi

queue_is_empty() { [ -z "$(squeue --noheader)" ]; }
need "the queue is empty" within 150 queue_is_empty
need "  and all shards but one are finished" [ "$(finished)" = $((shards - 1)) ]
cat "$folder/slurm/"* >"$scratch/printed"
if [ $way = kill ]; then
    check "  shard $lost went on after the $(($(wc -l <"$scratch/left_behind") - 1)) runs that the dead node had finished" \
        starts_with "$(journal "$lost")" "$scratch/left_behind"
fi
if [ $way = silence ]; then
    check "  shard $lost was finished on w1, and the job on w2 found it so" \
        sh -c "[ \"\$(grep -c '^shard $lost/$shards:' '$scratch/printed')\" = 2 ] && grep -q '^shard $lost/$shards: [0-9]* runs\$' '$scratch/printed'"
    check "  no run of it was done twice" \
        [ "$(wc -l <"$(journal "$lost")")" = "$(cut -f1 "$(journal "$lost")" | sort -u | wc -l)" ]
fi

submit --dry-run
check "a dry run names the array of what is missing" has "$scratch/said" "--array=3 "
check "submitted again" submit
check "  the missing shard only" grep -q ': shards 8$' "$scratch/said"
all_are_finished() { [ "$(finished)" = $shards ]; }
need "  and all shards are finished" within 60 all_are_finished
check "nothing is left to submit" submit
check "  and it says so" has "$scratch/said" "all $shards shards are finished"
check "jobs have left what they print in the folder" has "$scratch/printed" "shard 1/$shards:"
need "the shards are merged" "$aerobot" campaign merge "$folder" --quiet

check "the same campaign in one process" \
    "$aerobot" campaign run "$scratch/lengths.ron" --out "$scratch/alone" --workers 1 --quiet
# Not the journals, how long anything took, into how many shards it was divided, and what jobs print.
results() { (cd "$1" && find . -type f ! -path './shards/*' ! -path './slurm/*' ! -name timing.json ! -name manifest.json | sort); }
check "  has the same files" [ "$(results "$folder")" = "$(results "$scratch/alone")" ]
while read -r file; do
    check "  $file: $(stat -c %s "$scratch/alone/$file") bytes, all equal" \
        cmp -s "$folder/$file" "$scratch/alone/$file"
done < <(results "$scratch/alone")

if [ $failures != 0 ]; then
    echo "$failures checks failed"
    exit 1
fi
echo "all checks hold"
