#!/usr/bin/env python3
"""Stops every verb at random moments and holds what it says then to its full answer.

    tests/interrupted/interrupted.py --rosin build/release/rosin [--moments 20] [--seed 1] [VERB …]

A number of a document that is not complete is null, the same as in the full one, or within its stated error of it; a share
or an average within five standard errors. What was recorded until then is the beginning of the full record.
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
EXAMPLES = os.path.join(HERE, "..", "..", "examples")
IRREGULAR = """
[law]
type = "hyperbolic"
mu_s = 1
delta = 3
[oscillator]
mass = 1
stiffness = 1
damping = 0.02
[drive]
speed = 0.3
normal_load = 1
force = { mean = 0, harmonics = [{ amplitude = 0.5, angular_frequency = 2 }] }
[basin]
returns = 100
x = { start = "displacement", from = -2, to = 3, points = 13 }
y = { start = "velocity", from = -2, to = 2, points = 13 }
"""

# name: words of the command; a scene of the examples or a text
QUESTIONS = {
    "run": ["run", "coulomb-stick-slip.toml", "--set", "run.duration=20000", "--set", "run.samples=20000", "--set", "solver.type=events"],
    "run of a structure": ["run", "two-blocks-on-a-belt.toml"],
    "basin": ["basin", IRREGULAR],
    "refined basin": ["basin", IRREGULAR, "--set", "basin.refine=true"],
    "sweep": ["sweep", "forced-belt-sweep.toml", "--set", "sweep.points=20"],
    "lyapunov": ["lyapunov", "belt-chaos.toml"],
    "branch": ["branch", "two-motions.toml"],
    "map": ["map", "bristol-board-plane.toml", "--set", "map.x.points=16", "--set", "map.y.points=12"],
    "fit": ["fit", "fit-laws.toml"],
    "lab": ["lab", "slide-hold-slide", "lab-slide-hold-slide.toml"],
    "cycle": ["cycle", "bristol-board-cycle.toml", "--tolerance", "1e-11"],
    "study": ["study", "stick-slip-study.toml", "--set", "study.cases=100"],
    "compare": ["compare", "compare-laws.toml"],
    "stress": ["stress", "--seed", "5", "--scenes", "60"],
}


class Asked:
    """One command, in a folder of its own for each call."""

    def __init__(self, rosin, words, folder):
        self.rosin, self.folder = os.path.abspath(rosin), folder
        self.words = []
        for word in words:
            if "\n" in word:
                path = os.path.join(folder, "scene.toml")
                with open(path, "w") as file:
                    file.write(word)
                word = path
            elif word.endswith(".toml"):
                word = os.path.join(EXAMPLES, word)
            self.words.append(word)

    def answer(self, name, limit=None):
        out = os.path.join(self.folder, name)
        words = [self.rosin, *self.words, "--json", "--out", out, "--threads", "1"]
        if "stress" not in self.words:
            words.append("--no-pictures")
        if limit is not None:
            words += ["--time-limit", f"{limit:.6f}"]
        begin = time.monotonic()
        done = subprocess.run(words, capture_output=True, text=True)
        try:
            document = json.loads(done.stdout)
        except json.JSONDecodeError:
            document = {"unreadable": done.stdout[:200], "said": done.stderr[-300:]}
        return done.returncode, document, time.monotonic() - begin


def close(a, b, error=0.0):
    return abs(a - b) <= error + 1e-9 * max(abs(a), abs(b)) + 1e-300


def prefix(part, whole, faults, where):
    if len(part) > len(whole):
        faults.append(f"{where}: {len(part)} of {len(whole)} values")
    for i, (a, b) in enumerate(zip(part, whole)):
        if isinstance(a, list) and isinstance(b, list):
            prefix(a, b, faults, f"{where}[{i}]")
        elif a is not None and b is not None and not isinstance(a, str) and not close(a, b):
            faults.append(f"{where}[{i}]: {a}, whole {b}")
            return


def same(part, whole, faults, where):
    """Every number of the part is null or that of the whole."""
    if isinstance(part, dict) and isinstance(whole, dict):
        for key in part:
            if key in whole:
                same(part[key], whole[key], faults, f"{where}.{key}")
    elif isinstance(part, list) and isinstance(whole, list):
        for i, (a, b) in enumerate(zip(part, whole)):
            same(a, b, faults, f"{where}[{i}]")
    elif isinstance(part, (int, float)) and isinstance(whole, (int, float)) and not close(part, whole):
        faults.append(f"{where}: {part}, whole {whole}")


def check_run(part, whole, faults):
    prefix(part.get("time", []), whole["time"], faults, "time")
    for name, values in part.get("columns", {}).items():
        error = part["error"].get(name) or 0
        for i, (a, b) in enumerate(zip(values, whole["columns"][name])):
            if not close(a, b, error + (whole["error"].get(name) or 0)) and part["error"].get(name) is not None:
                faults.append(f"{name}[{i}]: {a} ± {error}, whole {b}")
                break
    for name, value in part.get("metrics", {}).items():
        error = part["error"].get(name)
        if value is None or error is None or name not in whole["metrics"]:
            continue
        bound = whole["metrics"][name]
        if name.endswith("_max") and value > bound + error + 1e-9 * abs(bound):
            faults.append(f"{name}: {value} above the whole {bound}")
        if name.endswith("_min") and value < bound - error - 1e-9 * abs(bound):
            faults.append(f"{name}: {value} below the whole {bound}")


def check_basin(part, whole, faults):
    def shares(document):
        return {(a["kind"], round((a.get("metrics") or {}).get("period") or 0, 3)): a for a in document.get("attractors", [])}

    full = shares(whole)
    for key, attractor in shares(part).items():
        if attractor.get("share") is None:
            continue
        error = attractor["standard_error"]
        if not error < 0.5:
            faults.append(f"share of {key} ± {error}")
        right = full[key]["share"] if key in full else 0
        if abs(attractor["share"] - right) > 5 * error:
            faults.append(f"share of {key}: {attractor['share']:.3f} ± {error:.3f}, whole {right:.3f}")


def check_lyapunov(part, whole, faults):
    for i, (a, b) in enumerate(zip(part.get("exponents") or [], whole["exponents"])):
        error = part["standard_error"][i]
        if isinstance(a, str) or isinstance(b, str) or a is None or error is None:
            continue
        if abs(a - b) > 5 * math.hypot(error, whole["standard_error"][i] or 0):
            faults.append(f"exponent {i}: {a} ± {error}, whole {b}")


def check_branch(part, whole, faults):
    events = [(e["kind"], e["value"], e.get("error") or 0) for e in whole.get("events", [])]
    for event in part.get("events", []):
        if not any(kind == event["kind"] and close(value, event["value"], 2 * (error + (event.get("error") or 0)))
                   for kind, value, error in events):
            faults.append(f"event {event['kind']} at {event['value']}")


def check_stress(part, whole, faults):
    if part.get("passed") and part.get("complete") is False:
        faults.append("passed, though not complete")
    for key in ("certified", "wrong", "not_finite", "crashed", "none_exists", "scenes"):
        if part.get(key, 0) > whole[key]:
            faults.append(f"{key}: {part[key]}, whole {whole[key]}")


CHECKS = {"run": check_run, "basin": check_basin, "lyapunov": check_lyapunov, "branch": check_branch, "stress": check_stress}
NEVER_COMPARED = ("cost", "seconds", "outcome", "outcome_detail", "notes", "version", "error", "slowest")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rosin", default="build/release/rosin")
    parser.add_argument("--moments", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("verbs", nargs="*")
    given = parser.parse_args()
    dice = random.Random(given.seed)
    failed = False
    for name, words in QUESTIONS.items():
        if given.verbs and name not in given.verbs:
            continue
        with tempfile.TemporaryDirectory() as folder:
            asked = Asked(given.rosin, words, folder)
            status, whole, seconds = asked.answer("whole")
            if "unreadable" in whole:
                print(f"{name}: no full answer: {whole}")
                failed = True
                continue
            kept = nothing = complete = 0
            faults = []
            for moment in range(given.moments):
                limit = seconds * dice.uniform(0.02, 1)
                code, part, _ = asked.answer(f"part-{moment}", limit)
                here = []
                if "unreadable" in part:
                    here.append(f"unreadable: {part}")
                elif code == 0 or part.get("outcome") == whole.get("outcome") and "complete" not in part:
                    complete += 1
                    part = {key: value for key, value in part.items() if key not in NEVER_COMPARED}
                    same(part, whole, here, "whole")
                elif len(part) <= 4:  # verb, version, outcome: nothing is kept
                    nothing += 1
                else:
                    kept += 1
                    check = CHECKS.get(words[0])
                    if check:
                        check(part, whole, here)
                    else:
                        same({k: v for k, v in part.items() if k not in NEVER_COMPARED}, whole, here, "part")
                faults += [f"at {limit:.3f} of {seconds:.3f} s: {fault}" for fault in here[:3]]
            print(f"{name}: {given.moments} moments of {seconds:.2f} s: {kept} in part, {nothing} without numbers, "
                  f"{complete} complete; {len(faults)} faults", flush=True)
            for fault in faults:
                print("  ", fault)
            failed = failed or bool(faults)
    return failed


if __name__ == "__main__":
    sys.exit(main())
