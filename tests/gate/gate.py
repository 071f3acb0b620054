#!/usr/bin/env python3
"""Same bits, or explained: every number, step and evaluation of examples, cases and drawn scenes, before and after.

    tests/gate/gate.py record BEFORE.json.gz --rosin build/release/rosin
    tests/gate/gate.py compare BEFORE.json.gz --rosin build/release/rosin

A refactoring must leave all of it as it was. `record` asks each verb of each example, each question of each case, and
the question of each of 300 scenes of `rosin stress --draw`, and keeps the JSON documents with every number as the text
that was printed, which reads back to the same bits. `compare` asks again what the record holds, and ends with status 1
where a document differs: it shows the first numbers that do, and how far apart they are. Times are left out. Records are
of one machine and compiler: make them before the change, keep them outside the repository.
"""
import argparse
import concurrent.futures
import gzip
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
VOLATILE = re.compile(r"(.*_)?seconds|date|version")


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


def questions_of_drawn_scenes(folder):
    for scene in sorted(folder.glob("scene-*.toml"), key=lambda path: int(path.stem[6:])):
        verb = re.match(r"# rosin (\w+) FILE", scene.read_text()).group(1)
        yield scene.name, [verb], []


def without_times(document):
    if isinstance(document, dict):
        return {k: without_times(v) for k, v in document.items() if not VOLATILE.fullmatch(k)}
    if isinstance(document, list):
        return [without_times(v) for v in document]
    return document


def ask(rosin, folders, question):
    name, verb, options = question
    scene = next(folder / name for folder in folders if (folder / name).exists())
    with tempfile.TemporaryDirectory() as out:
        words = verb[:2] if verb[0] == "lab" else verb[:1]
        ran = subprocess.run([rosin, *words, scene, *verb[len(words):], *options, "--json", "--quiet", "--no-pictures",
                              "--threads", "1", "--time-limit", str(LONGEST), "--out", out],
                             capture_output=True, text=True, cwd=out)
    if "time limit" in ran.stderr or "time limit" in ran.stdout[:5000]:
        return None
    try:
        document = without_times(json.loads(ran.stdout, parse_float=str, parse_int=str))
    except ValueError:
        document = {"refused": re.sub(r"\S*/", "", ran.stderr)}  # no paths of this machine
    return {"status": ran.returncode, "document": document}


def ask_all(arguments, questions, folders):
    def one(question):
        key = " ".join([*question[1], question[0], *question[2]])
        return key, {"question": question, "answer": ask(arguments.rosin, folders, question)}
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
        questions = [*questions_of_examples(), *questions_of_cases(),
                     *questions_of_drawn_scenes(drawn(arguments, folder, arguments.seed, arguments.scenes))]
        if arguments.only:
            questions = [q for q in questions if re.search(arguments.only, q[0])]
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
        after = ask_all(arguments, [tuple(e["question"]) for e in entries.values()], [ROOT, pathlib.Path(folder)])
    changed = 0
    for key, entry in entries.items():
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
    parser.add_argument("--only", help="of a record: questions of scenes whose names this pattern finds")
    arguments = parser.parse_args()
    if arguments.what == "record":
        record(arguments)
    else:
        sys.exit(1 if compare(arguments) else 0)


main()
