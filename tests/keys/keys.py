#!/usr/bin/env python3
"""Every key of a scene is used, refused or noted, whatever the verb.

    tests/keys/keys.py --rosin build/release/rosin [QUESTION…]

Asks each question of small scenes once, then with each key of the scene changed, and with each further key that the
verb knows: the keys are those that it lists where it refuses a misspelt one. Where the document stays as it was, to the
last digit, and neither a refusal nor a note names the key, the key is passed over in silence: status 1. Keys that
rightly change nothing in a scene stand in its lines `# silent: KEY: reason`.
"""
import argparse
import concurrent.futures
import copy
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
VOLATILE = re.compile(r"(.*_)?seconds|date|version|title|notes|scene_resolved")

# What a key is tried with that the scene has not: the first that the verb takes as being of the right kind.
VALUES = [0.37, 2, 3, 50, "0.37", False, True, [0.3, 0.4], [1, 2], ["0.3"], {"mean": 0.2}, "rest", "steady", {}]


def as_toml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(k)} = {as_toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)


def without_times(document):
    if isinstance(document, dict):
        return {k: without_times(v) for k, v in document.items() if not VOLATILE.fullmatch(k)}
    if isinstance(document, list):
        return [without_times(v) for v in document]
    return document


class Asker:
    def __init__(self, rosin, words, scene):
        self.rosin, self.words, self.scene = rosin, words, scene

    def ask(self, scene):
        """Status, document without times, everything that was said."""
        text = "".join(f"{json.dumps(name)} = {as_toml(value)}\n" for name, value in scene.items())
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "scene.toml"
            path.write_text(text)
            for file in HERE.glob("*.csv"):
                (path.parent / file.name).write_bytes(file.read_bytes())
            line = [self.rosin, *self.words, str(path), "--json", "--no-pictures", "--out", folder + "/out", "--time-limit", "30"]
            ran = subprocess.run(line, capture_output=True, text=True)
        said = ran.stderr
        document = json.loads(ran.stdout) if ran.stdout else None
        if document:
            said += "".join(f"note: {one}\n" for one in document.get("notes", []) if isinstance(one, str))
        return ran.returncode, without_times(document), said


def tables_of(value, path=()):
    """Paths of a scene's tables, and of those in lists."""
    if isinstance(value, dict):
        yield path
        for key, inner in value.items():
            yield from tables_of(inner, (*path, key))
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from tables_of(inner, (*path, i))


def leaves_of(value, path=()):
    if isinstance(value, dict) and value:
        for key, inner in value.items():
            yield from leaves_of(inner, (*path, key))
    elif isinstance(value, list) and value and isinstance(value[0], dict):
        for i, inner in enumerate(value):
            yield from leaves_of(inner, (*path, i))
    else:
        yield path, value


def changed(scene, path, value):
    scene = copy.deepcopy(scene)
    at = scene
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return scene


def other_values(value):
    if isinstance(value, bool):
        return [not value]
    if isinstance(value, int):
        return [value + 1, value * 2, value - 1]
    if isinstance(value, float):
        return [value * 1.07, value * 0.93]
    if isinstance(value, str) and re.match(r"[0-9.e+-]+ ", value):
        return [re.sub(r"^[0-9.e+-]+", lambda number: str(1.07 * float(number.group())), value)]
    if isinstance(value, list) and value and isinstance(value[0], (int, float)):
        return [[one * 1.07 + 0.01 for one in value]]
    return []


def named(path):
    """As messages write it: entries of lists are numbered from 1."""
    return ".".join(str(key + 1) if isinstance(key, int) else key for key in path)


def is_noted(path, said):
    words = [named(path), named([key for key in path if not isinstance(key, int)])]
    words += [word.rsplit(".", 1)[0] for word in words if "." in word]
    return any(line.startswith("note:") and any(re.search(rf"(?<![\w.]){re.escape(word)}(?![\w])", line) for word in words)
               for line in said.splitlines())


def passed_over(asker, base, path, values):
    """Whether none of the values that the verb takes changes anything, or is noted. None where it takes none."""
    taken = None
    for value in values:
        status, document, said = asker.ask(changed(asker.scene, path, value))
        if status == 2:
            choices = re.search(r"is not known; known here: (.*)", said)
            if choices and isinstance(value, str):
                return all_pass_over(asker, base, path, choices.group(1).strip().split(", "))
            continue
        if document != base or is_noted(path, said):
            return False
        taken = True
    return taken


def all_pass_over(asker, base, path, choices):
    """Whether the verb takes every choice, and none changes anything."""
    for choice in choices:
        status, document, said = asker.ask(changed(asker.scene, path, choice))
        if status == 2 or document != base or is_noted(path, said):
            return False
    return True


def known_keys(asker, table):
    """The keys that a table may have, from the refusal of one that it cannot."""
    _, _, said = asker.ask(changed(asker.scene, (*table, "qqqqqqqq"), 1))
    known = re.search(r"unknown (?:key|table) 'qqqqqqqq'.*; known here: (.*)", said)
    return known.group(1).strip().split(", ") if known else []


def check(rosin, name, words, scene, silent):
    asker = Asker(rosin, words, scene)
    status, base, said = asker.ask(scene)
    if status not in (0, 1) or base is None:
        return [f"{name}: status {status}: {said.strip()}"]
    found = []
    varied = {str(value) for path, value in leaves_of(scene) if path[-1] in ("parameter", "parameters")}
    verbs = {"curve", "run", "cycle", "map", "stability", "branch", "sweep", "basin", "lyapunov", "frf", "fit", "compare",
             "lab", "study", "verify", "title"}

    def report(path, values, scene):
        asker = Asker(rosin, words, scene)
        if named(path) in varied or any(re.fullmatch(pattern, named(path)) for pattern in silent):
            return
        inner = known_keys(Asker(rosin, words, changed(scene, path, {})), path) if {} in values else []
        for key in inner:
            report((*path, key), VALUES, changed(scene, path, {}))
        if not inner and passed_over(asker, base, path, [one for one in values if one != {}]):
            found.append(f"{name}: {named(path)} is passed over in silence")

    for path, value in leaves_of(scene):
        if path[0] in verbs and path[0] != words[0]:
            continue
        report(path, other_values(value) or [one for one in VALUES if isinstance(one, type(value))], scene)
    for table in list(tables_of(scene)):
        for key in known_keys(asker, table):
            path = (*table, key)
            if len(path) == 1:
                continue  # whole tables: those of other verbs
            at = scene
            for one in table:
                at = at[one]
            if key not in at:
                report(path, VALUES, scene)
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rosin", default=str(ROOT / "build/release/rosin"))
    parser.add_argument("questions", nargs="*")
    options = parser.parse_args()
    work = []
    for file in sorted(HERE.glob("*.toml")):
        text = file.read_text()
        words = re.match(r"# rosin ([\w -]+)\n", text).group(1).split()
        if not options.questions or file.stem in options.questions:
            silent = re.findall(r"^# silent: (\S+): ", text, re.MULTILINE)
            work.append((options.rosin, file.stem, words, tomllib.loads(text), silent))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        found = [line for lines in pool.map(lambda one: check(*one), work) for line in lines]
    print(*found, sep="\n")
    print(f"{len(work)} questions, {len(found)} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
