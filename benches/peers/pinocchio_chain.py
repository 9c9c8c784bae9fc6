#!/usr/bin/env python3
"""Forward dynamics of a hanging chain in Pinocchio 2.7 and in aerobot, side by side.

The chain: n rods of 10 m and 0.05 kg joined by spherical joints, the first one to
a fixed point, 10 kg at the tip, gravity 8.87 m/s2; every rod within 0.3 rad of the
vertical, turning at up to 0.1 rad/s. What is compared is nanoseconds per joint of
one computation of all accelerations.

    python3 pinocchio_chain.py                    both, and the table of docs/cost.md
    python3 pinocchio_chain.py --pinocchio-only   Pinocchio alone, docs/cost.md untouched
    python3 pinocchio_chain.py --ours-only F      our lines from the file F, no Pinocchio run

Needed: Python's standard library with venv, and a C++ compiler. The script makes a
virtual environment, downloads Pinocchio's, Boost's and Eigen's headers with it and
compiles pinocchio_chain.cpp. See README.md beside this file for what differs
between the two models.
"""

import argparse
import hashlib
import math
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

PINOCCHIO_VERSION = "2.7.0"
PACKAGES = [f"pin=={PINOCCHIO_VERSION}", "cmeel-boost==1.83.0", "cmeel-eigen==3.4.1"]
# Only the headers are used, so the wheels may be those of any one Python version.
WHEELS_FOR = "3.11"
FLAGS = ["-std=c++14", "-O3", "-march=native", "-DNDEBUG"]
LINKS = [20, 100, 1000, 10000]
RESIDUAL_LINKS = [20, 50, 100, 500, 1000, 10000]
CPU_SECONDS, POSES = 1.0, 10

SCRIPT = Path(__file__).resolve()
SOURCE = SCRIPT.with_suffix(".cpp")
ROOT = SCRIPT.parents[2] if len(SCRIPT.parents) > 2 else SCRIPT.parent
MARK_BEGIN = "<!-- chain table: begin -->"
MARK_END = "<!-- chain table: end -->"
CARGO = ["cargo", "bench", "--bench", "links", "--", "--peer"]


class PeerError(Exception):
    """A failure to be shown to the user as one message."""


def call(command, hint="", **more):
    """Standard output of a command that must succeed."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, **more)
    except OSError as e:
        raise PeerError(f"could not run '{' '.join(command)}': {e}{hint}") from None
    if done.returncode != 0:
        raise PeerError(f"'{' '.join(command)}' failed (exit status {done.returncode})\n"
                        + (done.stderr or done.stdout).strip()[-2000:] + hint)
    return done.stdout


# ------------------------------------------------------------ Pinocchio's side

def headers(folder):
    """The folder of Pinocchio's, Boost's and Eigen's headers, fetched if needed."""
    wheels = folder / "wheels"
    complete = wheels / "complete"
    if not complete.exists() or complete.read_text() != " ".join(PACKAGES):
        print(f"# preparing {folder}", file=sys.stderr)
        hint = "\n(a network connection to PyPI and Python's venv module are needed)"
        call([sys.executable, "-m", "venv", str(folder)], hint)
        python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
        call([str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--upgrade", "--no-deps",
              "--only-binary=:all:", "--python-version", WHEELS_FOR, "--target", str(wheels)] + PACKAGES, hint)
        complete.write_text(" ".join(PACKAGES))
    return wheels / "cmeel.prefix" / "include"


def build(folder, compiler):
    """The compiled program; made again when its source or the compiler changes."""
    include = headers(folder)
    command = shlex.split(compiler) + FLAGS + ["-isystem", str(include), "-isystem", str(include / "eigen3"), str(SOURCE)]
    hint = "\n(a C++ compiler is needed: --compiler, or the environment's CXX)"
    version = call(shlex.split(compiler) + ["--version"], hint).splitlines()[0]
    mark = hashlib.sha256("\n".join([version, *command, SOURCE.read_text()]).encode()).hexdigest()[:16]
    program = folder / f"pinocchio_chain-{mark}"
    if not program.exists():
        print("# compiling pinocchio_chain.cpp (two minutes)", file=sys.stderr)
        unfinished = folder / f"pinocchio_chain-{os.getpid()}"
        call(command + ["-o", str(unfinished)], hint)
        unfinished.replace(program)
    print(f"# {version}, {' '.join(FLAGS)}", flush=True)
    return program


def time_pinocchio(program, links, radius):
    out = call([str(program), "time", str(links), repr(radius), str(CPU_SECONDS)])
    return parse(out, "pinocchio", "pinocchio_chain")[links]


# --------------------------------------------------------------------- results

def parse(text, word, source):
    """Lines `word,n,nanoseconds` -> {n: nanoseconds}"""
    found = {}
    for number, row in enumerate(text.splitlines(), 1):
        if not row.startswith(word + ","):
            continue
        cells = [c.strip() for c in row.split(",")]
        try:
            found[int(cells[1])] = float(cells[2])
        except (ValueError, IndexError):
            if cells[1:2] and cells[1].isalpha():
                continue                       # a header line
            raise PeerError(f"{source}, line {number}: expected '{word},n,nanoseconds', got {row!r}") from None
    if not found:
        raise PeerError(f"{source}: no line starts with '{word},'")
    return found


def parse_file(name, word):
    try:
        return parse(Path(name).read_text(), word, name)
    except OSError as e:
        raise PeerError(f"cannot read {name}: {e}") from None


def number(x):
    return "—" if x is None else f"{x:.3g}" if x < 1000 else f"{x:.0f}"


def table(theirs, ours):
    rows = ["| n | Pinocchio 2.7 ns per joint | aerobot ns per link | ratio |", "|---:|---:|---:|---:|"]
    for n in sorted(set(theirs) | set(ours)):
        a, b = theirs.get(n), ours.get(n)
        rows.append(f"| {n} | {number(a)} | {number(b)} | {number(a / b if a and b else None)} |")
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


def keep_least(best, new):
    for n, value in new.items():
        best[n] = min(value, best.get(n, math.inf))


def sizes(text):
    try:
        found = [int(x) for x in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"expected whole numbers with commas between, got {text!r}") from None
    if any(n < 1 for n in found):
        raise argparse.ArgumentTypeError("every n must be at least 1")
    return found


def main():
    p = argparse.ArgumentParser(description="A chain of links in Pinocchio and in aerobot: nanoseconds per joint.")
    p.add_argument("--links", type=sizes, default=LINKS, metavar="N,N,...",
                   help="Pinocchio's numbers of links (default: %(default)s)")
    p.add_argument("--repeats", type=int, default=5, help="least of so many (default: 5)")
    p.add_argument("--pinocchio-only", action="store_true", help="Pinocchio alone; docs/cost.md is not touched")
    p.add_argument("--ours-only", metavar="FILE", help="read our 'link,' lines from FILE; Pinocchio is not run")
    p.add_argument("--pinocchio-from", metavar="FILE",
                   help="read 'pinocchio,' lines of an earlier run from FILE; Pinocchio is not run")
    p.add_argument("--residual-links", type=sizes, default=RESIDUAL_LINKS, metavar="N,N,...",
                   help="numbers of links for the residuals (default: %(default)s)")
    p.add_argument("--no-residuals", action="store_true", help="times only")
    p.add_argument("--radius", type=float, default=0.01, metavar="M", help="the rods' radius in metres (default: %(default)s)")
    p.add_argument("--compiler", default=os.environ.get("CXX", "g++"), help="C++ compiler (default: CXX, or g++)")
    p.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()) / f"pinocchio-peer-{PINOCCHIO_VERSION}",
                   help="folder of the virtual environment and the compiled program (default: %(default)s)")
    p.add_argument("--root", type=Path, default=ROOT, help="repository root (default: %(default)s)")
    p.add_argument("--readme", type=Path, help="file with the markers (default: docs/cost.md)")
    p.add_argument("--no-readme", action="store_true", help="print the table, write nothing")
    o = p.parse_args()

    if o.repeats < 1 or not o.radius > 0:
        raise PeerError("--repeats must be at least 1 and --radius positive")
    if o.pinocchio_only and (o.ours_only or o.pinocchio_from):
        raise PeerError("--pinocchio-only goes with neither --ours-only nor --pinocchio-from")
    use_pinocchio = not (o.ours_only or o.pinocchio_from)
    use_ours = not (o.ours_only or o.pinocchio_only)
    theirs = parse_file(o.pinocchio_from, "pinocchio") if o.pinocchio_from else {}
    ours = parse_file(o.ours_only, "link") if o.ours_only else {}
    program = build(o.folder, o.compiler) if use_pinocchio else None

    for repeat in range(o.repeats if use_pinocchio or use_ours else 0):
        if use_ours:
            print(f"# repeat {repeat + 1} of {o.repeats}: ours", file=sys.stderr)
            keep_least(ours, parse(call(CARGO, cwd=o.root), "link", "cargo bench"))
        if use_pinocchio:
            print(f"# repeat {repeat + 1} of {o.repeats}: Pinocchio", file=sys.stderr)
            keep_least(theirs, {n: time_pinocchio(program, n, o.radius) for n in o.links})

    if theirs:
        print("pinocchio,n,ns_per_joint")
        for n in sorted(theirs):
            print(f"pinocchio,{n},{theirs[n]:.4g}")
    if use_pinocchio and not o.no_residuals:
        print("residual,n,double_precision_check,extended_precision_check,acceleration_error")
        for n in o.residual_links:
            print(call([str(program), "residual", str(n), repr(o.radius), str(POSES)]).strip(), flush=True)
    text = table(theirs, ours)
    print(text)
    if not (o.pinocchio_only or o.no_readme):
        readme = o.readme or o.root / "docs" / "cost.md"
        write_readme(readme, text)
        print(f"# table written to {readme}", file=sys.stderr)


if __name__ == "__main__":
    try:
        main()
    except PeerError as error:
        sys.exit(f"pinocchio_chain.py: {error}")
    except KeyboardInterrupt:
        sys.exit("pinocchio_chain.py: interrupted")
