"""The cases in all engines, side by side.

usage: peers.py FALLWERK MODELS BUILD OUTPUT [--only CASE] [--rounds N] [--no-pile]
Writes OUTPUT/peers.md and OUTPUT/peers.csv.
"""

import argparse
import csv
import json
import math
import os
import platform
import statistics
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import mujoco

import pile
import run_exudyn
import run_mujoco
from common import Case, row

# Processor time of a run from which one is enough [s].
LONG_S = 3.0

TITLES = {
    "a01-pendulum": "Simple pendulum (IFToMM A01), 10 s",
    "a02-four-bars-2": "Two four-bars (IFToMM A02), 20 s",
    "a02-four-bars-40": "40 four-bars (IFToMM A02), 20 s",
    "a03-squeezer": "Andrews' squeezer (IFToMM A03), 0.05 s",
    "a04-bricard": "Bricard's mechanism (IFToMM A04), 10 s",
    "topple-flow": "Toppling column, hinge flows at 3 kN m, 1.9 s",
    "topple-elastic": "Toppling column, hinge stays elastic, 0.2 s",
    "frame4": "Falling frame, 17 bodies on 28 softening hinges, 0.75 s before the ground is met",
    "pile-1000": "Pile of 1000 cubes, 5 s",
}


def rapier(program, case, step, substeps):
    """Rapier runs as a program of its own."""
    known = str(case.known_file) if case.known_file else "-"
    command = [program, str(case.file), known, str(step), str(substeps)]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=900)
    result = json.loads(done.stdout)
    label = f"f64, {substeps} substep{'s' if substeps > 1 else ''}, warm start"
    if case.known_file is None:
        return row(case, "Rapier", label, step, result["cpu_s"], note=f"penetration {1e3 * result['penetration_m']:.2f} mm")
    conservative = case.name in ("a01-pendulum", "a02-four-bars-2", "a02-four-bars-40", "a04-bricard", "topple-elastic")
    return row(case, "Rapier", label, step, result["cpu_s"], case.error_m(result["places"]), result["energy_j"] if conservative else None)


# names of the cases in `fallwerk bench mbs`
OWN = {
    "a01-pendulum": "pendulum (A01)",
    "a02-four-bars-2": "2 four-bars",
    "a02-four-bars-40": "40 four-bars",
    "a03-squeezer": "squeezer",
    "a04-bricard": "Bricard",
    "topple-flow": "toppling, flowing",
    "topple-elastic": "toppling, elastic",
    "frame4": "falling frame",
}


def own(program, case):
    """Fallwerk's rows, by the tolerance of a step, as functions."""
    tolerances = ("1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-10")
    # at the end of the four-bars' many singular poses nothing is gained by the last
    tolerances = tolerances[:-1] if case.name.startswith("a02") else tolerances
    return [lambda t=t: own_row(program, case, t) for t in tolerances if case.name in OWN]


def own_row(program, case, tolerance):
    command = [program, "bench", "mbs", "--json", "--tolerances", tolerance, "--only", OWN[case.name]]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"Fallwerk, tolerance {tolerance}: {done.stderr.strip()}")
    [r] = json.loads(done.stdout)
    return {
        "case": case.name,
        "engine": "Fallwerk",
        "method": f"tolerance {tolerance}, {sum(r['steps'])} steps",
        "step": r["simulated_s"] / max(r["steps"][0], 1),
        "cpu_s_per_s": r["run_s"] / r["simulated_s"],
        "error_m": r["error_m"],
        "energy_j": r["energy_j"],
        "note": "",
    }


def in_turn(case, runs, rounds):
    """Rows of all runs, with their median times over rounds in which each has its turn: the speed of a shared machine changes by half within seconds. Long runs have one turn."""
    found, failed = [[] for _ in runs], set()
    for _ in range(rounds):
        for i, run in enumerate(runs):
            if i in failed or (found[i] and sum(r["cpu_s_per_s"] for r in found[i]) * case.end_s > LONG_S):
                continue
            try:
                row = run()
                found[i] += [row] if row else []
            except Exception as error:  # an engine that gives up is a result
                failed.add(i)
                print(f"{case.name}: {type(error).__name__}: {str(error)[:300]}", file=sys.stderr)
    for rows in found:
        if rows:
            yield {**rows[-1], "cpu_s_per_s": statistics.median(r["cpu_s_per_s"] for r in rows)}


def plan(case, tools, with_pile):
    """What is run, as functions."""
    name, fallwerk, peer = case.name, tools["fallwerk"], tools["rapier"]
    mj = lambda method, step, of=case, **more: lambda: run_mujoco.smooth(fallwerk, of, method, step, tools["hinge"], **more)
    ex = lambda step, **more: lambda: run_exudyn.smooth(case, step, **more)
    rp = lambda step, substeps=1: lambda: rapier(peer, case, step, substeps)
    if name == "a01-pendulum":
        turned = run_mujoco.as_revolute(case, tools["build"])
        yield from [mj("RK4", h, of=turned) for h in (2e-2, 1e-2, 5e-3, 2e-3)]
        yield mj("implicitfast", 1e-3, of=turned)
        yield from [ex(h, planar=True) for h in (1e-2, 2e-3, 5e-4)]
        yield from [rp(h) for h in (1e-3, 2e-4)]
    elif name == "a02-four-bars-2":
        yield from [mj("RK4", h) for h in (1e-2, 2e-3, 1e-3, 2e-4)]
        yield from [ex(h, planar=True) for h in (1e-2, 2e-3, 5e-4)]
        yield from [rp(h) for h in (1e-3, 2e-4)]
    elif name == "a02-four-bars-40":
        yield from [mj("RK4", h) for h in (1e-2, 2e-3, 1e-3)]
        yield mj("Euler", 1e-3)
        yield from [ex(h, planar=True) for h in (1e-2, 2e-3)]
        yield rp(1e-3)
    elif name == "a03-squeezer":
        yield from [mj("RK4", h) for h in (1e-4, 5e-5, 2e-5)]
        yield from [ex(h, planar=True) for h in (1e-4, 2e-5, 5e-6)]
        yield from [rp(h) for h in (1e-5, 2e-6)]
    elif name == "a04-bricard":
        yield from [mj("RK4", h) for h in (1e-2, 5e-3, 2e-3, 1e-3)]
        yield from [ex(h) for h in (1e-2, 2e-3)]
        yield from [rp(h) for h in (1e-3, 2e-4)]
    elif name in ("topple-flow", "topple-elastic"):
        yield from [mj("RK4", h) for h in (5e-3, 1e-3, 2e-4)]
        yield from [mj("implicitfast", h) for h in (5e-3, 1e-3, 2e-4)]
        yield mj("implicitfast", 1e-3, native=True)
        yield mj("RK4", 1e-3, native=True)
        yield from [ex(h) for h in (5e-3, 1e-3, 2e-4)]
        yield from [rp(h) for h in (1e-3, 2e-4)]
        yield rp(1e-3, 4)
    elif name == "frame4":
        yield from [mj("RK4", h) for h in (5e-3, 2.5e-3, 2e-3, 1e-3)]
        yield from [mj("implicitfast", h) for h in (1e-3, 2e-4)]
        yield from [rp(h) for h in (1e-3, 5e-4, 2.5e-4, 5e-5)]
    elif with_pile:
        yield from [lambda h=h: pile.fallwerk(fallwerk, case, h) for h in (5e-3, 2e-3)]
        yield from [lambda h=h: rapier(peer, case, h, 4) for h in (1 / 60, 5e-3)]
        yield lambda: run_mujoco.pile(fallwerk, case, 2e-3, mujoco.mjtSolver.mjSOL_CG)


def machine():
    """Cores and name of the processor."""
    name = platform.processor()
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []:
        if line.startswith("model name"):
            name = line.split(":", 1)[1].strip()
            break
    return f"{os.cpu_count()} cores, {name}"


def shown(value, form):
    return "" if value is None else form.format(value)


def own_time(rows, error):
    """Fallwerk's time at this error, on the line through its rows that none beats in both; `None` if it never was so close."""
    front = []
    for e, t in sorted((r["error_m"], r["cpu_s_per_s"]) for r in rows if r["engine"] == "Fallwerk" and r["error_m"]):
        if not front or t < front[-1][1]:
            front.append((e, t))
    if error is None or not front or error < front[0][0]:
        return None
    for (e0, t0), (e1, t1) in zip(front, front[1:]):
        if error <= e1:
            share = math.log(error / e0) / math.log(e1 / e0)
            return t0 * (t1 / t0) ** share
    return front[-1][1]


def times(rows, r):
    own = own_time(rows, r["error_m"]) if r["engine"] != "Fallwerk" else None
    if own is None:
        return ""
    ratio = r["cpu_s_per_s"] / own
    return f"{ratio:.0f}" if ratio >= 10 else f"{ratio:.1f}"


def markdown(rows):
    versions = f"MuJoCo {version('mujoco')}, Exudyn {version('exudyn')}, Rapier 0.36.0"
    text = f"Machine: {machine()}. One thread each. {versions}.\n"
    for name, title in TITLES.items():
        chosen = [r for r in rows if r["case"] == name]
        if not chosen:
            continue
        text += f"\n### {title}\n\n| engine | method | step [ms] | CPU ms per simulated s | largest error [m] | times Fallwerk's | energy drift [J] | |\n|---|---|---:|---:|---:|---:|---:|---|\n"
        for r in chosen:
            cells = [r["engine"], r["method"], shown(r["step"] and 1e3 * r["step"], "{:.4g}"), shown(1e3 * r["cpu_s_per_s"], "{:.4g}")]
            cells += [shown(r["error_m"], "{:.2e}"), times(chosen, r), shown(r["energy_j"], "{:.1e}"), r["note"]]
            text += "| " + " | ".join(cells) + " |\n"
    return text


def save(folder, rows):
    """The table so far."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "peers.md").write_text(markdown(rows))
    with open(folder / "peers.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser()
    for name in ("fallwerk", "models", "build", "output"):
        parser.add_argument(name)
    parser.add_argument("--only", default="")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--no-pile", action="store_true")
    a = parser.parse_args()
    tools = {"fallwerk": a.fallwerk, "build": a.build, "rapier": str(Path(a.build) / "target/release/peer-rapier")}
    tools["hinge"] = run_mujoco.library(a.build)
    rows = []
    for name in (n for n in TITLES if a.only in n):
        case = Case(a.models, name)
        runs = [*own(a.fallwerk, case), *plan(case, tools, not a.no_pile)]
        for found in in_turn(case, runs, a.rounds):
            rows.append(found)
            print(f"{name}: {found['engine']}, {found['method']}, {found['step']}: {found['cpu_s_per_s']:.5f} {found['error_m']} {found['note']}", file=sys.stderr)
        save(Path(a.output), rows)


if __name__ == "__main__":
    main()
