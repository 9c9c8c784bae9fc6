#!/usr/bin/env python3
"""CPU time of a hanging 1 km line in MoorDyn 2.7 and in aerobot, side by side.

The case: a 1 km line (EA 11.5 kN, 0.237 g/m, 0.458 mm) fixed at its top, a
4 kg sphere of 0.1 m at its lower end, gravity 8.87 m/s2, a fluid of density
1 kg/m3 moving uniformly with (4, 3, 0) m/s; at rest at first, straight,
tilted by 0.3 rad towards +x.

    python3 moordyn_line.py                  both, and the table of docs/cost.md
    python3 moordyn_line.py --moordyn-only   MoorDyn alone, docs/cost.md untouched
    python3 moordyn_line.py --ours-only F    our lines from the file F, no MoorDyn run
    python3 moordyn_line.py --find-steps     MoorDyn's largest stable steps again

Only the standard library is needed to start: the script makes a virtual
environment, installs moordyn and numpy in it and starts itself again there.
See README.md beside this file for what differs between the two models.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MOORDYN_VERSION = "2.7.2"
SEGMENTS = [10, 20, 50, 100, 200, 500, 1000]
# Largest steps (s) for which MoorDyn's RK4 stays bounded over 20 s. At 0.9 of them
# the end point is right to 1 mm from N = 50 on; at N = 10 and 20 it is off by about
# 1 m, which 0.021 and 0.0105 s would mend (--find-steps finds and uses such steps).
LARGEST_STEP = {10: 2.8e-2, 20: 1.4e-2, 50: 4.7e-3, 100: 2.3e-3,
                200: 1.06e-3, 500: 4.3e-4, 1000: 2.1e-4}
SHARE_OF_LARGEST = 0.9

LENGTH, EA, LINE_DENSITY, DIAMETER = 1000.0, 11500.0, 2.37e-4, 0.458e-3
CD_NORMAL, CD_TANGENT, DAMPING_RATIO = 1.0, 0.03, 0.1
MASS, SPHERE_DIAMETER, SPHERE_CD = 4.0, 0.1, 0.47
FLUID_DENSITY, GRAVITY, WIND = 1.0, 8.87, (4.0, 3.0, 0.0)
TILT = 0.3
# MoorDyn's currents stop at its free surface z = 0 and its seabed is at
# -WtrDpth: the line hangs from 1 km below the one to 3 km above the other.
TOP_Z, WATER_DEPTH = -1000.0, 5000.0

SCRIPT = Path(__file__).resolve()
ROOT = SCRIPT.parents[2] if len(SCRIPT.parents) > 2 else SCRIPT.parent
MARK_BEGIN = "<!-- peer table: begin -->"
MARK_END = "<!-- peer table: end -->"
CARGO = ["cargo", "bench", "--bench", "stiff_tethers", "--", "--peer"]


class PeerError(Exception):
    """A failure to be shown to the user as one message."""


# ---------------------------------------------------------------- environment

def venv_python(folder):
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def has_moordyn(python):
    code = ("import importlib.metadata as m, moordyn, numpy;"
            "print(m.version('moordyn'))")
    done = subprocess.run([str(python), "-c", code], capture_output=True, text=True)
    return done.returncode == 0 and done.stdout.strip() == MOORDYN_VERSION


def ensure_environment(folder):
    """Run inside a virtual environment that has MoorDyn, making it if needed."""
    python = venv_python(folder)
    inside = Path(sys.prefix).resolve() == folder.resolve()
    if inside:
        if not has_moordyn(sys.executable):
            raise PeerError(f"{folder}: moordyn {MOORDYN_VERSION} is missing; delete the folder and run again")
        return
    if not python.exists() or not has_moordyn(python):
        print(f"# preparing {folder}", file=sys.stderr)
        for command in ([sys.executable, "-m", "venv", str(folder)],
                        [str(python), "-m", "pip", "install", "--quiet",
                         "--disable-pip-version-check", f"moordyn=={MOORDYN_VERSION}", "numpy"]):
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode != 0:
                raise PeerError("could not prepare the virtual environment\n  "
                                + " ".join(command) + "\n" + (done.stderr or done.stdout).strip()
                                + "\n(a network connection to PyPI and Python's venv module are needed)")
        if not has_moordyn(python):
            raise PeerError(f"moordyn {MOORDYN_VERSION} was installed in {folder} but cannot be imported")
    sys.stdout.flush()
    arguments = [str(python), str(SCRIPT)] + sys.argv[1:]
    if os.name == "nt":
        sys.exit(subprocess.run(arguments).returncode)
    os.execv(str(python), arguments)


# -------------------------------------------------------------- MoorDyn's side

def start_length(segments):
    """Length of the line with each segment stretched by the weight it carries."""
    rest = LENGTH / segments
    per_node = LINE_DENSITY * rest
    total = 0.0
    for i in range(segments):
        # half of the last segment is lumped into the sphere's node
        below = MASS + per_node * (segments - i - 0.5)
        total += rest * (1.0 + below * GRAVITY * math.cos(TILT) / EA)
    return total


def write_case(folder, segments, step, flow=True):
    reach = start_length(segments)
    end = (reach * math.sin(TILT), 0.0, TOP_Z - reach * math.cos(TILT))
    cda = SPHERE_CD * math.pi * SPHERE_DIAMETER ** 2 / 4
    text = f"""--------------------- MoorDyn Input File -------------------------------------
1 km line in uniform flow
---------------------- LINE TYPES --------------------------------------------
Name   Diam      MassDen   EA      BA/-zeta          EI    Cd           Ca   CdAx          CaAx
(-)    (m)       (kg/m)    (N)     (N-s/-)           (N-m2) (-)         (-)  (-)           (-)
line   {DIAMETER!r}  {LINE_DENSITY!r}  {EA!r}  {-DAMPING_RATIO!r}  0.0  {CD_NORMAL!r}  0.0  {CD_TANGENT!r}  0.0
---------------------- POINTS ------------------------------------------------
ID  Attachment  X    Y    Z    Mass  Volume  CdA  Ca
(#) (-)         (m)  (m)  (m)  (kg)  (m^3)   (m^2) (-)
1   Fixed       0.0  0.0  {TOP_Z!r}  0.0  0.0  0.0  0.0
2   Free        {end[0]!r}  {end[1]!r}  {end[2]!r}  {MASS!r}  0.0  {cda!r}  0.0
---------------------- LINES -------------------------------------------------
ID  LineType  AttachA  AttachB  UnstrLen  NumSegs  LineOutputs
(#) (-)       (-)      (-)      (m)       (-)      (-)
1   line      1        2        {LENGTH!r}  {segments}  -
---------------------- OPTIONS -----------------------------------------------
2            writeUnits
0            writeLog
1            disableOutput
1            disableOutTime
RK4          tScheme
{step!r}     dtM
1.0e6        CFL
{GRAVITY!r}  g
{FLUID_DENSITY!r}  WtrDnsty
{WATER_DEPTH!r}    WtrDpth
0            WaveKin
{int(flow)}            Currents
0.0          TmaxIC
0            ICgenDynamic
--------------------- need this line -----------------------------------------
"""
    (folder / "lines.txt").write_text(text)
    rows = "\n".join(f"{z} {WIND[0]} {WIND[1]} {WIND[2]}" for z in (-WATER_DEPTH, -WATER_DEPTH / 2, 0.0))
    (folder / "current_profile.txt").write_text(
        "steady current\nz ux uy uz\n(m) (m/s) (m/s) (m/s)\n" + rows + "\n")


def simulate(request):
    """One MoorDyn run; called in a process of its own. Returns a dictionary."""
    import cmoordyn
    import moordyn
    segments, step = request["segments"], request["step"]
    end_time = request.get("end_time", math.inf)
    min_time, min_cpu = request.get("min_time", math.inf), request.get("min_cpu", math.inf)
    max_cpu = request.get("max_cpu", math.inf)
    with tempfile.TemporaryDirectory(prefix="moordyn-line-") as name:
        folder = Path(name)
        flow = request.get("flow", True)
        write_case(folder, segments, step, flow)
        system = moordyn.Create(str(folder / "lines.txt"))
        if not system:
            raise PeerError("MoorDyn could not read its input file")
        moordyn.SetVerbosity(system, moordyn.LEVEL_ERR)
        # no initial-condition generation: the line starts as it was written
        if moordyn.Init_NoIC(system, [], []) != 0:
            raise PeerError("MoorDyn could not be initialised")
        used = cmoordyn.get_dt(system)        # moordyn.GetDt drops the value
        if not math.isclose(used, step, rel_tol=1e-9):
            raise PeerError(f"MoorDyn uses the step {used} s instead of {step} s")
        wind = WIND if flow else (0.0, 0.0, 0.0)
        for z in (TOP_Z, TOP_Z - LENGTH / 2, TOP_Z - 1.1 * LENGTH):
            felt = moordyn.GetWavesKin(moordyn.GetWaves(system), 10.0, 20.0, z)[0]
            if max(abs(felt[i] - wind[i]) for i in range(3)) > 1e-12:
                raise PeerError(f"MoorDyn's flow at {z} m is {list(felt)} instead of {list(wind)}")
        line = moordyn.GetLine(system, 1)
        nodes = moordyn.GetLineNumberNodes(line)
        start = [list(moordyn.GetLineNodePos(line, i)) for i in range(nodes)]
        top, last = start[0], start[-1]
        bend = max(math.dist(p, [a + (b - a) * i / (nodes - 1) for a, b in zip(top, last)])
                   for i, p in enumerate(start))
        # outer steps of a whole number of inner ones, close to 0.1 s
        inner = max(1, round(0.1 / step))
        outer = inner * step * (1 - 1e-10)
        t, cpu, stable = 0.0, 0.0, True
        reach = 1.2 * LENGTH
        while t < end_time and not (t >= min_time and cpu >= min_cpu) and cpu < max_cpu:
            dt = min(outer, end_time - t)
            before = time.process_time()
            try:
                moordyn.Step(system, [], [], t, dt)
            except Exception:                 # MoorDyn's own check for NaN
                stable = False
                break
            cpu += time.process_time() - before
            t = end_time if dt < outer else t + dt
            probes = range(0, nodes, max(1, nodes // 20)) if request.get("quick") else range(nodes)
            for i in [*probes, nodes - 1]:
                p = moordyn.GetLineNodePos(line, i)
                if not all(map(math.isfinite, p)) or math.dist(p, top) > reach:
                    stable = False
                    break
            if not stable:
                break
        end = None
        if stable:
            p = moordyn.GetLineNodePos(line, nodes - 1)
            end = [p[0], p[1], p[2] - TOP_Z]
        moordyn.Close(system)
    return {"segments": segments, "step": step, "simulated": t, "cpu": cpu, "stable": stable,
            "end": end, "bend": bend, "start_end": [last[0], last[1], last[2] - TOP_Z]}


def run(request):
    """`simulate` in a fresh process, so that MoorDyn's output and crashes stay there."""
    done = subprocess.run([sys.executable, str(SCRIPT), "--worker", json.dumps(request)],
                          capture_output=True, text=True)
    for text in reversed(done.stdout.splitlines()):
        if text.startswith("result "):
            return json.loads(text[7:])
    if request.get("may_fail"):
        return {"stable": False}
    raise PeerError(f"the MoorDyn run with {request['segments']} segments failed (exit status "
                    f"{done.returncode})\n" + (done.stderr or done.stdout).strip()[-2000:])


def time_moordyn(segments, step, flow=True):
    """CPU seconds per simulated second, by steps only."""
    r = run({"segments": segments, "step": step, "min_time": 2.0, "min_cpu": 0.3,
             "max_cpu": 3.0, "end_time": 60.0, "quick": True, "flow": flow})
    if not r["stable"]:
        raise PeerError(f"MoorDyn diverged with {segments} segments at a step of {step:.3g} s; try --find-steps")
    return r["cpu"] / r["simulated"]


def largest_steps(segments, guess):
    """The largest step that stays bounded over 20 s, and the largest whose end
    point is then also within 1 mm of that at a third of the first step tried."""
    runs = {}

    def end(step):
        if step not in runs:
            runs[step] = run({"segments": segments, "step": step, "end_time": 20.0,
                              "quick": True, "may_fail": True}).get("end")
            print(f"#   N={segments} step {step:.4g} s: {runs[step] or 'unstable'}", file=sys.stderr)
        return runs[step]

    def bisect(good, step):
        low = high = None
        for _ in range(12):
            if good(step):
                low, step = step, step * 1.25
            else:
                high, step = step, step / 1.25
            if low and high:
                break
        else:
            raise PeerError(f"no stable step found with {segments} segments near {guess:.3g} s")
        while high / low > 1.01:
            middle = math.sqrt(low * high)
            low, high = (middle, high) if good(middle) else (low, middle)
        return low

    reference = end(guess / 3)
    if not reference:
        raise PeerError(f"no stable step found with {segments} segments near {guess:.3g} s")
    bounded = bisect(lambda h: end(h) is not None, guess)
    accurate = bisect(lambda h: end(h) is not None and math.dist(end(h), reference) < 1e-3, bounded)
    return bounded, accurate


# ------------------------------------------------------------------- our side

def parse_ours(text, source):
    """`peer,N,steps,cpu_us_per_simulated_s,end_error_m` -> {N: (steps, cpu s, error m)}"""
    found = {}
    for number, row in enumerate(text.splitlines(), 1):
        if not row.startswith("peer,"):
            continue
        cells = [c.strip() for c in row.split(",")]
        try:
            _, n, steps, cpu, error = cells
            if n == "N":
                continue                       # a header line
            found[int(n)] = (int(float(steps)), float(cpu) * 1e-6, float(error))
        except ValueError:
            raise PeerError(f"{source}, line {number}: expected "
                            f"'peer,N,steps,cpu_us_per_simulated_s,end_error_m', got {row!r}") from None
    if not found:
        raise PeerError(f"{source}: no line starts with 'peer,'")
    return found


def run_ours(root):
    try:
        done = subprocess.run(CARGO, cwd=root, capture_output=True, text=True)
    except OSError as e:
        raise PeerError(f"could not run '{' '.join(CARGO)}' in {root}: {e}") from None
    if done.returncode != 0:
        raise PeerError(f"'{' '.join(CARGO)}' in {root} failed (exit status {done.returncode})\n"
                        + done.stderr.strip()[-2000:])
    return parse_ours(done.stdout, "cargo bench")


# --------------------------------------------------------------------- results

def exponent(costs):
    """Slope of log cost against log N from 100 to 1000, or None."""
    points = [(math.log(n), math.log(c)) for n, c in costs.items() if 100 <= n <= 1000 and c > 0]
    if len(points) < 2:
        return None
    mx = sum(x for x, _ in points) / len(points)
    my = sum(y for _, y in points) / len(points)
    return sum((x - mx) * (y - my) for x, y in points) / sum((x - mx) ** 2 for x, _ in points)


def duration(seconds):
    if seconds is None:
        return "—"
    if seconds < 1e-3:
        return f"{seconds * 1e6:.3g} µs"
    if seconds < 1:
        return f"{seconds * 1e3:.3g} ms"
    return f"{seconds:.3g} s"


def table(theirs, ours):
    rows = ["| N | MoorDyn 2.7 CPU per simulated s | aerobot CPU per simulated s | ratio | steps in 60 s | end point error (m) |",
            "|---:|---:|---:|---:|---:|---:|"]
    for n in sorted(set(theirs) | set(ours)):
        a = theirs.get(n)
        steps, b, error = ours.get(n, (None, None, None))
        ratio = f"{a / b:.3g}" if a and b else "—"
        rows.append(f"| {n} | {duration(a)} | {duration(b)} | {ratio} | "
                    f"{'—' if steps is None else steps} | {'—' if error is None else format(error, '.1e')} |")
    return "\n".join(rows)


def write_readme(path, text):
    try:
        whole = path.read_text(encoding="utf-8")
    except OSError as e:
        raise PeerError(f"cannot read {path}: {e}") from None
    if whole.count(MARK_BEGIN) != 1 or whole.count(MARK_END) != 1 or whole.index(MARK_BEGIN) > whole.index(MARK_END):
        raise PeerError(f"{path}: needs exactly one '{MARK_BEGIN}' followed by one '{MARK_END}'; nothing written")
    head, rest = whole.split(MARK_BEGIN)
    tail = rest.split(MARK_END)[1]
    path.write_text(f"{head}{MARK_BEGIN}\n{text}\n{MARK_END}{tail}", encoding="utf-8")


def keep_least(best, new, key):
    for n, value in new.items():
        if n not in best or key(value) < key(best[n]):
            best[n] = value


def main():
    p = argparse.ArgumentParser(description="A 1 km line in MoorDyn and in aerobot: CPU time against N.")
    p.add_argument("--segments", type=lambda s: [int(x) for x in s.split(",")], default=SEGMENTS,
                   metavar="N,N,...", help="MoorDyn's numbers of segments (default: %(default)s)")
    p.add_argument("--repeats", type=int, default=5, help="least of so many (default: 5)")
    p.add_argument("--moordyn-only", action="store_true", help="MoorDyn alone; docs/cost.md is not touched")
    p.add_argument("--ours-only", metavar="FILE", help="read our 'peer,' lines from FILE; MoorDyn is not run")
    p.add_argument("--moordyn-from", metavar="FILE", help="read 'moordyn,' lines of an earlier run from FILE; MoorDyn is not run")
    p.add_argument("--find-steps", action="store_true", help="find MoorDyn's largest stable steps again (minutes), and use them")
    p.add_argument("--still", action="store_true",
                   help="time MoorDyn without the flow, which spares it the look-up of the current profile (with --moordyn-only)")
    p.add_argument("--end-positions", type=int, default=200, metavar="N",
                   help="print MoorDyn's end position at 60 s for up to N segments (default: 200; 0: none)")
    p.add_argument("--venv", type=Path, default=Path(tempfile.gettempdir()) / f"moordyn-peer-{MOORDYN_VERSION}",
                   help="folder of the virtual environment (default: %(default)s)")
    p.add_argument("--root", type=Path, default=ROOT, help="repository root (default: %(default)s)")
    p.add_argument("--readme", type=Path, help="file with the markers (default: docs/cost.md)")
    p.add_argument("--no-readme", action="store_true", help="print the table, write nothing")
    p.add_argument("--worker", help=argparse.SUPPRESS)
    o = p.parse_args()

    if o.worker:
        print("result " + json.dumps(simulate(json.loads(o.worker))), flush=True)
        return
    if o.repeats < 1 or any(n < 2 for n in o.segments):
        raise PeerError("--repeats must be at least 1 and every N at least 2")
    if o.moordyn_only and (o.ours_only or o.moordyn_from):
        raise PeerError("--moordyn-only goes with neither --ours-only nor --moordyn-from")
    if o.still and not o.moordyn_only:
        raise PeerError("--still goes with --moordyn-only: it is not the same case")
    readme = o.readme or o.root / "docs" / "cost.md"
    use_moordyn = not (o.ours_only or o.moordyn_from)
    if use_moordyn:
        ensure_environment(o.venv)

    theirs, ours, steps = {}, {}, {}
    if o.moordyn_from:
        for row in Path(o.moordyn_from).read_text().splitlines():
            if row.startswith("moordyn,") and not row.startswith("moordyn,N"):
                _, n, step, cpu = row.split(",")[:4]
                theirs[int(n)], steps[int(n)] = float(cpu), float(step)
    if o.ours_only:
        try:
            ours = parse_ours(Path(o.ours_only).read_text(), o.ours_only)
        except OSError as e:
            raise PeerError(f"cannot read {o.ours_only}: {e}") from None
    if use_moordyn:
        for n in o.segments:
            # away from the table: the step falls about as 1/N
            near = min(LARGEST_STEP, key=lambda k: abs(math.log(k / n)))
            largest = LARGEST_STEP.get(n, LARGEST_STEP[near] * near / n)
            if o.find_steps or n not in LARGEST_STEP:
                bounded, largest = largest_steps(n, largest)
                print(f"# N={n}: largest step {bounded:.4g} s (bounded over 20 s), "
                      f"{largest:.4g} s, used (end point right to 1 mm as well)", flush=True)
            steps[n] = SHARE_OF_LARGEST * largest
    if not o.ours_only:
        for repeat in range(o.repeats):
            if not o.moordyn_only:
                print(f"# repeat {repeat + 1} of {o.repeats}: ours", file=sys.stderr)
                keep_least(ours, run_ours(o.root), lambda v: v[1])
            if use_moordyn:
                print(f"# repeat {repeat + 1} of {o.repeats}: MoorDyn", file=sys.stderr)
                keep_least(theirs, {n: time_moordyn(n, steps[n], not o.still) for n in o.segments}, lambda v: v)

    if theirs:
        print("moordyn,N,step_s,cpu_s_per_simulated_s")
        for n in sorted(theirs):
            print(f"moordyn,{n},{steps[n]:.6g},{theirs[n]:.6g}")
    if use_moordyn:
        for n in o.segments:
            if n <= o.end_positions:
                r = run({"segments": n, "step": steps[n], "end_time": 60.0, "quick": True})
                if not r["stable"]:
                    raise PeerError(f"MoorDyn diverged within 60 s with {n} segments at {steps[n]:.3g} s; try --find-steps")
                half = run({"segments": n, "step": steps[n] / 2, "end_time": 60.0, "quick": True})
                shift = math.dist(r["end"], half["end"]) if half["stable"] else math.nan
                print(f"# MoorDyn N={n}: end at 60 s ({r['end'][0]:.4f}, {r['end'][1]:.4f}, {r['end'][2]:.4f}) m, "
                      f"{shift:.1e} m from that at half the step; start ({r['start_end'][0]:.4f}, {r['start_end'][1]:.4f}, {r['start_end'][2]:.4f}) m, "
                      f"{r['bend']:.1e} m off a straight, evenly spaced line")
    for name, costs in (("MoorDyn", theirs), ("aerobot", {n: v[1] for n, v in ours.items()})):
        e = exponent(costs)
        if e is not None:
            used = [n for n in costs if 100 <= n <= 1000]
            print(f"{name}: cost grows as N^{e:.2f} from N = {min(used)} to {max(used)}")
    if o.moordyn_only:
        return
    text = table(theirs, ours)
    print(text)
    if not o.no_readme:
        write_readme(readme, text)
        print(f"# table written to {readme}", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except PeerError as error:
        sys.exit(f"moordyn_line.py: {error}")
    except KeyboardInterrupt:
        sys.exit("moordyn_line.py: interrupted")
