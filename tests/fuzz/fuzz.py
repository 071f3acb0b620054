#!/usr/bin/env python3
"""Hostile input for the rosin command: examples mutated, every verb, and what no execution may do.

    tests/fuzz/fuzz.py --rosin build/release/rosin --runs 1000 --seed 1 [--first K] [--keep FOLDER]

Run K of a seed is always the same, so that a finding is repeated by its number: --first K --runs 1. A finding is an
execution that ended by a signal, with a status other than 0, 1, 2 and 130, or by the script's own clock although
--time-limit was given; a JSON document that does not parse or holds a NaN; status 0 or 1 without a document; a report
that is not whole or not small; an import that is no TOML; a refusal (status 2) that names no place: no file, key or
option; and output on standard error that is none of rosin's sentences.
"""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import tomllib
except ImportError:  # before Python 3.11
    tomllib = None

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXTREMES = ["0", "-1", "1e-300", "1e300", "-1e300", "inf", "-inf", "nan", "1e-12", "1e15", "0.1", "3", "1000000",
            "99999999999", "9223372036854775807", "true", "''", "'x'", "'5 MPa'", "'1 furlong'", "[]", "{}", "[1, 2]",
            "[[0, 1e-6], [20, 1e-5]]", "{ mean = 1, harmonics = [{ amplitude = 1, angular_frequency = 3 }] }",
            "{ ramp = { from = 0, rate = 1 } }", "{ noise = { rms = 1, band = [1, 10] } }", "1979-05-27",
            "{ table = 'none.csv' }", "'a\\u0000b'" .replace("'", '"')]
SMALL = {"map.x.points": (2, 5), "map.y.points": (2, 4), "run.samples": (1, 50), "study.cases": (1, 4),
         "curve.points": (2, 40), "lab.samples": (64, 200), "sweep.points": (2, 5), "basin.x.points": (2, 4),
         "basin.y.points": (2, 4)}  # where a scene has the table, so that runs stay short
EXPERIMENTS = ["inclined-plane", "impulse", "velocity-step", "slide-hold-slide", "spring-pulled", "reciprocation",
               "ring-down", "frequency-response", "inverse"]
VERBS = ["curve", "stability", "run", "cycle", "map", "sweep", "branch", "basin", "lyapunov", "compare", "lab", "frf",
         "fit", "study", "laws", "plot"]
OF_OTHERS = ["merge", "report", "export", "import"]  # what the command or another program has written
# A refusal begins with the file (and mostly line and key), the option, or what was named on the command line.
PLACE = re.compile(r"^(rosin: |\d+ of \d+ points |.*\.(toml|csv|nc|partial|py|m|in)\b|.*\.toml\b|--[a-z]|[^:]*/|\.: |law '|unknown (friction law|experiment|command))")
SECONDS = 4


def chosen_verb(dice, scene):
    text = scene.read_text()
    tables = set(re.findall(r"^\[+([a-z]+)", text, re.M))
    fitting = [v for v in VERBS if v in tables]
    if scene.name.startswith("lab-"):
        fitting = ["lab"]
    fitting += ["curve"] if "law" in tables and dice.random() < 0.2 else []
    fitting += ["stability", "cycle", "cycle"] if {"law", "oscillator", "drive"} <= tables else []
    return dice.choice(fitting) if fitting and dice.random() < 0.93 else dice.choice(VERBS)


def mutated(dice, text):
    """One to four small changes, or a large one."""
    lines = text.split("\n")
    for _ in range(dice.choice([0, 1, 1, 1, 1, 2, 2, 3])):
        keys = [i for i, line in enumerate(lines) if re.match(r"\s*[\w.\-]+\s*=", line)]
        kind = dice.random()
        if kind < 0.72 and keys:  # a value
            numeric = [i for i in keys if re.search(r"=.*\d", lines[i]) and not lines[i].startswith("title")]
            i = dice.choice(numeric if numeric and dice.random() < 0.95 else keys)
            key, value = lines[i].split("=", 1)
            numbers = list(re.finditer(r"[-+]?\d+\.?\d*(e[-+]?\d+)?", value))
            if numbers and dice.random() < 0.93:
                m = dice.choice(numbers)
                how = dice.random()
                if how < 0.1:
                    number = dice.choice(EXTREMES[:15])
                elif "." not in m.group() and "e" not in m.group() and how < 0.6:  # a count stays one
                    number = str(max(1, int(int(m.group()) * 10 ** dice.uniform(-1.5, 1))))
                else:
                    number = "%.3g" % (float(m.group()) * 10 ** dice.uniform(*dice.choice([(-1, 1), (-2, 2), (-6, 6)])))
                value = value[:m.start()] + number + value[m.end():]
            else:
                value = " " + dice.choice(EXTREMES)
            lines[i] = key + "=" + value
        elif kind < 0.75 and keys:
            del lines[dice.choice(keys)]
        elif kind < 0.77 and keys:
            i = dice.choice(keys)
            lines.insert(dice.randrange(len(lines)), lines[i])
        elif kind < 0.79 and keys:  # a misspelt key
            i = dice.choice(keys)
            key, value = lines[i].split("=", 1)
            at = dice.randrange(max(1, len(key.strip())))
            lines[i] = key[:at] + dice.choice("abcxyz_-.") + key[at + 1:] + "=" + value
        elif kind < 0.81:
            headers = [i for i, line in enumerate(lines) if line.startswith("[")]
            if headers:
                i = dice.choice(headers)
                lines[i] = dice.choice(["", "[" + lines[i] + "]", lines[i][:-1], "[lab]", lines[i].replace("]", ".x]")])
        elif kind < 0.83:
            depth = dice.choice([5, 90, 110, 3000, 100000])
            lines.insert(dice.randrange(len(lines)), dice.choice(
                ["deep = " + "[" * depth + "]" * depth, "a." * depth + "b = 1", "deep = " + "{a=" * depth + "1" + "}" * depth]))
        elif kind < 0.85 and keys:
            lines[dice.choice(keys)] = dice.choice(["title = \"'t Hooft ]]> & <b>\"", "title = '\\'", "law = 3", "= 1", "[[["])
        elif kind < 0.96:  # another law
            law = dice.choice(LAWS)
            within = ""
            kept = []
            for line in lines:
                within = line.strip() if line.startswith("[") else within
                if within == "[law]" and not line.startswith(("[", "type", "lambda")):
                    continue  # its own parameters mean nothing to another law
                kept.append(f'type = "{law}"' if within == "[law]" and line.startswith("type") else line)
            lines = kept
        elif kind < 0.98:  # bytes
            whole = bytearray("\n".join(lines).encode())
            for _ in range(dice.randrange(1, 6)):
                if whole:
                    whole[dice.randrange(len(whole))] = dice.randrange(256)
            lines = whole.decode("latin-1").split("\n")
    return "\n".join(lines)


LAWS = ["coulomb", "stribeck", "ageing", "slip", "prz", "spinodal", "lugre", "dahl", "two-state-ageing", "two-state-slip",
        "kato-tullis", "nagata", "bowden-tabor", "flash-heating", "slip-weakening", "static-growth", "thermal", "film",
        "hyperbolic", "two-exponential", "tabulated"]


def damaged(dice, data):
    data = bytearray(data)
    kind = dice.random()
    if kind < 0.3 and data:
        del data[dice.randrange(len(data)):]
    elif kind < 0.9:
        for _ in range(dice.choice([1, 2, 8, 64])):
            if data:
                data[dice.randrange(len(data))] = dice.choice([0, 1, 0x2C, 0x7F, 0xFF, dice.randrange(256)])
    else:
        data = bytearray(dice.choice([b"", b"\n", b"x\n", b"a,b\n1,2\n", b"0,1\n" * 3, b"\x89HDF\r\n\x1a\n" + bytes(100)]))
    return bytes(data)


def prepare(dice, folder):
    """A folder with a scene and its data. Returns the arguments of the command."""
    scenes = sorted((ROOT / "examples").glob("*.toml"))
    scene = dice.choice(scenes)
    verb = chosen_verb(dice, scene)
    for data in list((ROOT / "examples").glob("*.csv")) + list((ROOT / "tests/records").glob("*.nc")):
        content = data.read_bytes()
        (folder / data.name).write_bytes(damaged(dice, content) if dice.random() < 0.3 else content)
    text = scene.read_text()
    if scene.stem == "frf-record":  # the record of another example: a short one stands in for it
        name = dice.choice(["record.csv", "damaged.nc", "fill-values.nc"])
        text = re.sub(r"file\s*=.*", f'file = "{name}"', text)
        wave = [(k / 200, 1 + 0.1 * ((k * 37) % 11 - 5), 2 + 0.1 * ((k * 53) % 13 - 6)) for k in range(4000)]
        rows = ["time (s),slip_rate (m/s),friction_force (N)"] + ["%r,%r,%r" % row for row in wave]
        record = "\n".join(rows).encode()
        (folder / "record.csv").write_bytes(damaged(dice, record) if dice.random() < 0.5 else record)
    (folder / "scene.toml").write_bytes(mutated(dice, text).encode("utf-8", "surrogateescape"))
    if dice.random() < 0.15:  # what an earlier run, or somebody else, has left in the results folder
        results = folder / "out" / "scene"
        results.mkdir(parents=True)
        for name in dice.sample(["map.partial", "manifest.json", "result.json", verb + ".manifest.json", verb + ".json",
                                 verb + ".csv", verb + ".gp"], 3):
            how = dice.random()
            if how < 0.2:
                (results / name).symlink_to(folder / "scene.toml")
            elif how < 0.3:
                (results / name).mkdir()
            else:
                (results / name).write_bytes(damaged(dice, dice.choice(
                    [b"rosin map, 3 bytes of key\nkey\n" + bytes(100), b'{"scripts": {"run.gp": 3}}', b'{"overrides": 3}',
                     b'{"tolerance": [], "scene_resolved": {}, "scripts": []}', b"[" * 10000, b"{}"])))
    arguments = [verb]
    if verb == "lab":
        same = [e for e in EXPERIMENTS if scene.stem == "lab-" + e]
        arguments.append(same[0] if same and dice.random() < 0.9 else dice.choice(EXPERIMENTS))
    if verb == "laws":
        arguments += dice.choice([[], ["spinodal"], ["spinodall"]])
    else:
        arguments.append("scene.toml" if dice.random() < 0.98 else dice.choice(["none.toml", "/dev/zero", ".", "/etc/passwd"]))
    sets = []
    for path, (low, high) in SMALL.items():
        if "[" + path.split(".")[0] + "]" in text and dice.random() < 0.97:
            sets.append(f"{path}={dice.randint(low, high)}")
    if dice.random() < 0.1:
        keys = re.findall(r"^\s*([\w]+)\s*=", text, re.M) or ["x"]
        sets.append(f"{dice.choice(['law', 'oscillator', 'drive', 'run', 'map', 'lab', 'frf'])}.{dice.choice(keys)}="
                    f"{dice.choice(EXTREMES)}")
    if verb not in ("laws", "plot"):
        for value in sets:
            arguments += ["--set", value]
        if dice.random() < 0.7:
            arguments.append(f"--tolerance={dice.choice(['1e-2', '1e-3', '1e-4', '1e-6', '1e-8'] * 5 + ['1e-13', '0', 'nan'])}")
        arguments += ["--threads", str(dice.choice([1, 1, 2, 3]))]
        if dice.random() < 0.1:
            arguments.append("--explain")
    if verb == "compare" and dice.random() < 0.3:
        arguments.append("--design")
    if verb != "plot":
        arguments.append("--json")
    if dice.random() < 0.02:
        arguments.append(dice.choice(["--exactt", "--time-limit=0", "extra", "--out=/proc/none", "--set"]))
    return arguments + ["--time-limit", str(SECONDS)]


def prepare_files(dice, folder, rosin, environment):
    """A folder with journals, results or another program's input, some of them damaged. Returns the arguments."""
    verb = dice.choice(OF_OTHERS)
    if verb == "import":
        source = dice.choice(sorted((ROOT / "examples/import").iterdir()))
        text = source.read_bytes()
        if dice.random() < 0.8:
            text = mutated(dice, text.decode()).encode("utf-8", "surrogateescape")
        (folder / source.name).write_bytes(damaged(dice, text) if dice.random() < 0.3 else text)
        return [verb, source.name] + (["--as", dice.choice(["rsfmodel", "qdyn", "eqcycle", "none"])] if dice.random() < 0.2 else [])
    results = folder / "out/scene"
    plane = ["scene.toml", "--exact", "--tolerance=1e-2", "--no-pictures", "--set", "map.x.points=33", "--set", "map.y.points=2"]
    if verb == "merge":
        scene, asked = "bristol-board-plane", [["map", *plane, "--shard", f"{k}/2"] for k in (1, 2)]
    else:
        scene, first = dice.choice([("coulomb-stick-slip", "run"), ("coulomb-stick-slip", "cycle"), ("brake-two-modes", "stability"),
                                    ("velocity-step", "run"), ("two-blocks-on-a-belt", "run"), ("ageing-or-slip", "compare"),
                                    ("frf-load-family", "frf"), ("fit-curve", "fit"), ("leine-belt-block", "cycle")])
        asked = [[one, "scene.toml", "--tolerance=1e-3", "--no-pictures"] for one in (first, "curve")]
    for data in (ROOT / "examples").glob("*.csv"):
        shutil.copy(data, folder)
    shutil.copy(ROOT / f"examples/{scene}.toml", folder / "scene.toml")
    for words in asked[:dice.choice([1, 2, 2, 2])]:
        subprocess.run([rosin, *words], cwd=folder, capture_output=True, timeout=60, env=environment)
    results.mkdir(parents=True, exist_ok=True)
    files = sorted(results.iterdir())
    for file in dice.sample(files, dice.choice([0, 1, 1, 2, min(4, len(files))]) if len(files) > 1 else len(files)):
        how = dice.random()
        content = file.read_bytes()
        file.unlink()
        if how < 0.1:
            file.mkdir()
        elif how < 0.2:
            file.symlink_to(folder / "scene.toml")
        elif how < 0.9:
            if file.suffix == ".json" and dice.random() < 0.6:  # still a document, of which something is another
                content = changed(dice, content)
            else:
                content = damaged(dice, content)
            file.write_bytes(content)
    if verb == "merge":
        return [verb, *plane, *dice.choice([[], [], ["--forecast"], ["--from", "out/scene"], ["--from", "none"], ["--set", "law.lambda=2"]])]
    if verb == "export":
        return [verb, "out/scene", "--as", dice.choice(["rsfmodel", "qdyn", "eqcycle", "none"])]
    return [verb, "out/scene"]


def changed(dice, content):
    """A document with one to three of its values of another kind."""
    document = json.loads(content)
    for _ in range(dice.randint(1, 3)):
        at = document
        while isinstance(at, (dict, list)) and at:
            key = dice.choice(list(at)) if isinstance(at, dict) else dice.randrange(len(at))
            inner = at[key]
            if not isinstance(inner, (dict, list)) or not inner or dice.random() < 0.3:
                at[key] = dice.choice([None, 3, -1e300, "x", "</script><b>", True, [], {}, [1, 2], [[1, 2]], {"a": 1}, "1" * 5000])
                break
            at = inner
    return json.dumps(document).encode()


def no_constants(name):
    raise ValueError(f"{name} in JSON")


def finding(arguments, folder, rosin, environment):
    """What is wrong with one execution, or nothing; and its status."""
    try:
        done = subprocess.run([rosin] + arguments, cwd=folder, capture_output=True, timeout=4 * SECONDS + 12,
                              env=environment, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return "no end within the script's own clock", None
    status, error = done.returncode, done.stderr.decode("utf-8", "replace")
    if status < 0:
        return f"ended by signal {-status}", status
    if status not in (0, 1, 2, 130):
        return f"status {status}: {error[:300]}", status
    if "sanitizer" in error.lower() or "runtime error" in error:
        return error[:2000], status
    lines = [line for line in error.split("\n") if not line.startswith(("plan: ", "note: "))]
    if status == 2:
        if not PLACE.match(lines[0]):
            return f"a refusal that names no place: {error[:300]}", status
        return ("a refusal with a document" if done.stdout else None), status
    if "broken off" in error:
        return "the work did not end in order", status
    if status == 0 and arguments[0] == "report":
        page = (folder / "out/scene/report.html").read_bytes()
        if not page.rstrip().endswith(b"</html>") or len(page) > 1_000_000:
            return f"a report of {len(page)} bytes, which is not whole or not small", status
    if status == 0 and arguments[0] == "import" and tomllib:
        try:
            tomllib.loads(done.stdout.decode())
        except ValueError as problem:
            return f"TOML: {problem}", status
    if "--json" in arguments:
        if not done.stdout:
            known = lines[0].startswith("rosin: ")  # a file that could not be written, no memory
            return (None if status == 1 and known else f"status {status} without a document: {error[:300]}"), status
        try:
            json.loads(done.stdout, parse_constant=no_constants)
        except ValueError as problem:
            return f"JSON: {problem}", status
    return None, status


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rosin", default=str(ROOT / "build/release/rosin"))
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first run")
    parser.add_argument("--keep", help="folder that takes the inputs of findings")
    asked = parser.parse_args()
    rosin = str(pathlib.Path(asked.rosin).resolve())
    environment = {**os.environ, "PATH": "/nowhere"}  # pictures are gnuplot's matter, and slow
    findings, statuses = 0, {}
    for k in range(asked.first, asked.first + asked.runs):
        dice = random.Random(asked.seed * 1_000_003 + k)
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            arguments = prepare_files(dice, folder, rosin, environment) if dice.random() < 0.2 else prepare(dice, folder)
            problem, status = finding(arguments, folder, rosin, environment)
            statuses[status] = statuses.get(status, 0) + 1
            if problem:
                findings += 1
                print(f"run {k} of seed {asked.seed}: {problem.strip()}\n  rosin {' '.join(arguments)}"[:1500], flush=True)
                if asked.keep:
                    kept = pathlib.Path(asked.keep) / f"{asked.seed}-{k}"
                    shutil.copytree(folder, kept, dirs_exist_ok=True)
                    (kept / "arguments").write_text("\n".join(arguments) + "\n")
    counts = ", ".join(f"{n} with status {s}" for s, n in sorted(statuses.items(), key=str))
    print(f"{asked.runs} executions ({counts}), {findings} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
