#!/usr/bin/env python3
"""Same bits, or explained: every number, step, evaluation and file of examples, cases and drawn scenes, before and after.

    tests/gate/gate.py record BEFORE.json.gz --rosin build/release/rosin
    tests/gate/gate.py compare BEFORE.json.gz --rosin build/release/rosin

A refactoring must leave all of it as it was. `record` asks each example and case its own questions, every verb that any
oscillator may be asked (a verb that the scene has no table for gets one, three values wide), the question of each of 300
scenes of `rosin stress --draw`, and `rosin stress contacts`. It keeps the JSON documents with every number as the text
that was printed, which reads back to the same bits, and a digest of each file that was written. `compare` asks again what
the record holds, and ends with status 1 where a document or a file differs: it shows the first numbers that do, and how
far apart they are. Times are left out. Records are of one machine and compiler: make them before the change, keep them
outside the repository.
"""
import argparse
import concurrent.futures
import gzip
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
SMALL = {"map": ["map.x.points=6", "map.y.points=5"], "study": ["study.cases=20"]}  # where a scene has the table
LONGEST = 60  # s; what takes longer is left out, because where it ends depends on the machine
SHORTEST = 6  # s, the same for a question that the scene does not ask itself
VOLATILE = re.compile(r"(.*_)?seconds|date|version")
NUMBER = re.compile(r"[-+]?[0-9][0-9.eE+-]*")
FIRST_COORDINATE = {"chain": "displacement_1", "structure": "displacement_1", "plane-slider": "displacement_1",
                    "pin-on-disk": "pin_displacement"}  # where it is not "displacement"


def questions_of_examples():
    for scene in sorted((ROOT / "examples").glob("*.toml")):
        tables = set(tomllib.loads(scene.read_text()))
        verbs = [[v] for v in ("run", "map", "frf", "fit", "study", "compare") if v in tables]
        if scene.stem.startswith("lab-"):
            verbs = [["lab", scene.stem[4:]]]
        if "law" in tables:
            verbs.append(["curve"])
        if {"law", "oscillator", "drive"} <= tables:
            verbs += [["stability"], ["cycle"]]
        if {"compare", "map"} <= tables:
            verbs.append(["compare", "--design"])
        sets = [s for table, values in SMALL.items() if table in tables for s in values]
        for verb in verbs:
            yield f"examples/{scene.name}", verb, [part for s in sets for part in ("--set", s)]


def questions_of_cases():
    asked = set()
    for scene in sorted((ROOT / "cases").glob("*/*.toml")):
        verify = tomllib.loads(scene.read_text())["verify"]
        tolerance = ["--tolerance", str(verify["tolerance"])] if "tolerance" in verify else []
        for question in verify["questions"]:
            if "verb" not in question:
                continue
            sets = [part for s in question.get("set", []) for part in ("--set", s)]
            key = (str(scene), question["verb"], *sets)
            if key not in asked:
                asked.add(key)
                yield str(scene.relative_to(ROOT)), question["verb"].split(), sets + tolerance


def around(value):
    """0.9 and 1.1 times a number of a scene, with its unit; nothing for what is no number, or is 0."""
    found = NUMBER.match(str(value)) if isinstance(value, (int, float, str)) else None
    if not found or float(found.group()) == 0:
        return None
    ends = [f"{share * float(found.group()):.6g}{str(value)[found.end():]}" for share in (0.9, 1.1)]
    return [f'"{end}"' if isinstance(value, str) else end for end in ends]


def questions_of_every_verb():
    """What any oscillator may be asked, of the scenes that have one: tables that they lack are made for it."""
    for scene in [*sorted((ROOT / "examples").glob("*.toml")), *sorted((ROOT / "cases").glob("*/*.toml"))]:
        content = tomllib.loads(scene.read_text())
        if not {"law", "oscillator", "drive"} <= set(content):
            continue
        name, drive, oscillator = str(scene.relative_to(ROOT)), content["drive"], content["oscillator"]
        parameter = next((key for key in ("speed", "normal_load") if around(drive.get(key))), None)
        low, high = around(drive[parameter]) if parameter else (None, None)
        span = f'from = {low}, to = {high}, points = 3, scale = "linear"'
        axis = f'{{ parameter = "drive.{parameter}", {span} }}'
        coordinate = FIRST_COORDINATE.get(oscillator.get("type"), "displacement")
        start = [f'basin.{x}={{ start = "{place}", from = -0.1, to = 0.1, points = 2 }}'
                 for x, place in (("x", coordinate), ("y", coordinate.replace("displacement", "velocity")))]
        made = {"run": ["run.duration=10", "run.samples=20"], "stability": [], "cycle": [], "basin": start,
                "lyapunov": ["lyapunov.duration=30", "lyapunov.transient=10"],
                "frf": ["frf.frequencies=[0.1, 1, 10]"], "lab spring-pulled": []}
        if parameter:
            member = f'{{ name = "b", set = {{ "drive.{parameter}" = {high} }} }}'
            made |= {"map": [f"map.x={axis}"],
                     "sweep": [f"sweep={axis}"],
                     "branch": [f'branch={{ parameter = "drive.{parameter}", from = {low}, to = {high} }}'],
                     "compare": [*made["run"], f'compare={{ protocol = "run", members = [{{ name = "a" }}, {member}] }}']}
        for verb, sets in made.items():
            if verb in content and sets:
                continue  # its own question, or one that a case asks
            yield name, verb.split(), [*(part for s in sets for part in ("--set", s)), "--tolerance", "1e-5",
                                 "--time-limit", str(SHORTEST)]


def questions_of_own_tables():
    """Of an example that has the table of a verb that follows branches, attractors and exponents."""
    for scene in sorted((ROOT / "examples").glob("*.toml")):
        for verb in {"sweep", "branch", "basin", "lyapunov"} & set(tomllib.loads(scene.read_text())):
            yield f"examples/{scene.name}", [verb], []


def questions_of_drawn_scenes(folder):
    for scene in sorted(folder.glob("scene-*.toml"), key=lambda path: int(path.stem[6:])):
        verb = re.match(r"# rosin (\w+) FILE", scene.read_text()).group(1)
        yield scene.name, [verb], []


CONTACTS = [("stress contacts", ["stress", "contacts"], ["--scenes", "40", "--seed", str(seed)]) for seed in (1, 2)]


def without_times(document):
    if isinstance(document, dict):
        return {k: without_times(v) for k, v in document.items() if not VOLATILE.fullmatch(k)}
    if isinstance(document, list):
        return [without_times(v) for v in document]
    return document


def ask(rosin, folders, question, patience):
    name, verb, options = question
    scene = next((folder / name for folder in folders if (folder / name).exists()), None)
    with tempfile.TemporaryDirectory() as out:
        words = verb[:2] if verb[0] in ("lab", "stress") else verb[:1]
        target = [] if verb[0] == "stress" else [scene]
        limit = float(options[options.index("--time-limit") + 1]) if "--time-limit" in options else LONGEST
        ran = subprocess.run([rosin, *words, *target, *verb[len(words):], *without_limit(options), "--json", "--quiet",
                              *([] if verb[0] == "stress" else ["--no-pictures"]), "--threads", "1",
                              "--time-limit", str(patience * limit), "--out", out], capture_output=True, text=True, cwd=out)
        files = {file.name: digest(file) for file in sorted(pathlib.Path(out).iterdir()) if file.is_file()}
    if "time limit" in ran.stderr or "time limit" in ran.stdout[:5000]:
        return None
    try:
        document = without_times(json.loads(ran.stdout, parse_float=str, parse_int=str))
    except ValueError:
        document = {"refused": re.sub(r"\S*/", "", ran.stderr)}  # no paths of this machine
    return {"status": ran.returncode, "document": document, "files": files}


def without_limit(options):
    at = options.index("--time-limit") if "--time-limit" in options else len(options)
    return options[:at] + options[at + 2:]


def digest(file):
    """Of a file's bytes; of a document or manifest without the times, paths and version in it."""
    content = file.read_bytes()
    if file.suffix == ".json":
        document = without_times(json.loads(content, parse_float=str, parse_int=str))
        content = re.sub(r'"/\S*/', '"', json.dumps(document)).encode()
    return hashlib.sha256(content).hexdigest()[:16]


def ask_all(arguments, questions, folders, patience=1):
    def one(question):
        key = " ".join([*question[1], question[0], *question[2]])
        return key, {"question": question, "answer": ask(arguments.rosin, folders, question, patience)}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        answers = {}
        for count, (key, entry) in enumerate(pool.map(one, questions), 1):
            answers[key] = entry
            if sys.stderr.isatty():
                print(f"\r{count} of {len(questions)}", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print(file=sys.stderr)
    return answers


def drawn(arguments, folder, seed, scenes):
    subprocess.run([arguments.rosin, "stress", "--draw", "--seed", str(seed), "--scenes", str(scenes), "--out", folder,
                    "--quiet"], check=True)
    return pathlib.Path(folder)


def differences(old, new, path=""):
    """Of two documents: (path, old, new) wherever they are not the same text."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(k for k in new if k not in old)]:
            yield from differences(old.get(key), new.get(key), f"{path}.{key}".lstrip("."))
    elif isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, (a, b) in enumerate(zip(old, new)):
            yield from differences(a, b, f"{path}[{i}]")
    elif old != new:
        yield path, old, new


def count_numbers(document):
    if isinstance(document, dict):
        return sum(count_numbers(v) for v in document.values())
    if isinstance(document, list):
        return sum(count_numbers(v) for v in document)
    return isinstance(document, str) and bool(re.fullmatch(r"[-+0-9.eE]+", document))


def apart(old, new):
    try:
        a, b = float(old), float(new)
        return f"relative difference {abs(a - b) / max(abs(a), abs(b)):.1e}"
    except (TypeError, ValueError, ZeroDivisionError):
        return "not two numbers"


def record(arguments):
    with tempfile.TemporaryDirectory() as folder:
        questions = [*questions_of_examples(), *questions_of_own_tables(), *questions_of_cases(),
                     *questions_of_every_verb(), *CONTACTS,
                     *questions_of_drawn_scenes(drawn(arguments, folder, arguments.seed, arguments.scenes))]
        if arguments.only:
            questions = [q for q in questions if re.search(arguments.only, " ".join([*q[1], q[0]]))]
        answers = ask_all(arguments, questions, [ROOT, pathlib.Path(folder)])
    content = {"seed": arguments.seed, "scenes": arguments.scenes, "answers": answers}
    arguments.record.write_bytes(gzip.compress(json.dumps(content).encode()))
    numbers = sum(count_numbers(e["answer"]) for e in answers.values())
    left_out = [key for key, e in answers.items() if e["answer"] is None]
    print(f"{len(answers)} questions, {numbers} numbers recorded; {len(left_out)} took over {LONGEST} s")


def compare(arguments):
    before = json.loads(gzip.decompress(arguments.record.read_bytes()))
    entries = {k: e for k, e in before["answers"].items() if e["answer"] is not None}
    with tempfile.TemporaryDirectory() as folder:
        drawn(arguments, folder, before["seed"], before["scenes"])
        after = ask_all(arguments, [tuple(e["question"]) for e in entries.values()], [ROOT, pathlib.Path(folder)],
                        patience=4)
    changed = 0
    for key, entry in entries.items():
        if after[key]["answer"] is None:
            print(f"rosin {key}: more than its time limit, which it kept before")
            continue
        found = list(differences(entry["answer"], after[key]["answer"]))
        if not found:
            continue
        changed += 1
        print(f"rosin {key}: {len(found)} differences")
        for path, old, new in found[:3]:
            print(f"  {path}: {str(old)[:80]} -> {str(new)[:80]} ({apart(old, new)})")
    numbers = sum(count_numbers(e["answer"]) for e in entries.values())
    print(f"{len(entries)} questions, {numbers} numbers: " +
          ("the same bits" if not changed else f"{changed} documents differ"))
    return changed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["record", "compare"])
    parser.add_argument("record", type=pathlib.Path)
    parser.add_argument("--rosin", type=lambda text: str(pathlib.Path(text).resolve()), required=True)
    parser.add_argument("--seed", type=int, default=1, help="of the drawn scenes")
    parser.add_argument("--scenes", type=int, default=300, help="number of drawn scenes")
    parser.add_argument("--only", help="of a record: questions, as 'cycle examples/name.toml', in which this pattern is found")
    arguments = parser.parse_args()
    if arguments.what == "record":
        record(arguments)
    else:
        sys.exit(1 if compare(arguments) else 0)


if __name__ == "__main__":
    main()
