#!/usr/bin/env python3
"""Processor time of each compiled file and of each test, and the tables of CONTRIBUTING.md that state it.

costs.py build LOG FOLDER        configures and builds FOLDER anew without a cache; each compilation leaves a line in LOG
costs.py compile LOG COMMAND…    runs one command for it (CMAKE_CXX_COMPILER_LAUNCHER)
costs.py tests LOG FOLDER        runs the tests of FOLDER one after the other
costs.py write BUILD TESTS       writes the tables between the markers from both logs; the last column of a row is kept
"""

import collections
import datetime
import json
import os
import platform
import re
import resource
import subprocess
import sys
from pathlib import Path

root = Path(__file__).resolve().parent.parent


def compile(log: str, command: list[str]) -> int:
    status = subprocess.run(command).returncode
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    if status == 0 and "-c" in command:
        line = {"file": name_of(command[command.index("-c") + 1]), "target": target_of(command),
                "seconds": used.ru_utime, "kilobytes": used.ru_maxrss}
        with open(log, "a", encoding="utf-8") as stream:  # one write: lines of other compilations stay whole
            stream.write(json.dumps(line) + "\n")
    return status


def name_of(source: str) -> str:
    path = Path(source).resolve()
    return str(path.relative_to(root)) if path.is_relative_to(root) else path.name


def target_of(command: list[str]) -> str:
    """Of CMakeFiles/TARGET.dir/… behind -o."""
    output = command[command.index("-o") + 1] if "-o" in command else ""
    found = re.search(r"CMakeFiles/([^/]+)\.dir/", output)
    return found[1] if found else ""


def build(log: Path, folder: Path) -> int:
    log.unlink(missing_ok=True)
    launcher = f"{sys.executable};{Path(__file__).resolve()};compile;{log.resolve()}"
    configure = ["cmake", "--preset", "release", "-S", root, "-B", folder, "--fresh", "-DCCACHE=OFF",
                 "-DROSIN_PYTHON_PACKAGE=ON", f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}"]
    subprocess.run(configure, check=True, cwd=root)
    return subprocess.run(["cmake", "--build", folder, "--clean-first", "--parallel", str(os.cpu_count())]).returncode


def tests(log: Path, folder: Path) -> int:
    return subprocess.run(["ctest", "--test-dir", folder, "--parallel", "1", "--output-log", log]).returncode


def rows_of_build(log: Path) -> tuple[str, list[tuple[str, str]]]:
    entries = [json.loads(line) for line in log.read_text(encoding="utf-8").splitlines()]
    by_target, by_file, number = collections.Counter(), collections.Counter(), 0
    for entry in entries:
        by_target[entry["target"]] += entry["seconds"]
        by_file[entry["file"]] += entry["seconds"]
        number += 1
    command = ("rosin", "rosin_app", "rosin_bench", "bench_rivals", "rosin_command")
    parts = ", ".join(f"`{target}` {seconds:.0f}" for target, seconds in by_target.most_common() if seconds >= 1)
    laws = sum(entry["seconds"] for entry in entries if entry["file"].startswith("laws/"))
    most = max(entry["kilobytes"] for entry in entries) / 1e6
    text = (f"Everything takes {sum(by_target.values()):.0f} s of one processor in {number} compilations, the command "
            f"{sum(by_target[target] for target in command):.0f} s ({conditions()}; -O2, no cache, user time of the compiler); "
            f"no file takes more than {most:.1f} GB. Targets, in seconds: {parts}. Files of laws take {laws:.0f} s. "
            "The longest:")
    return text, [(f"`{file}`", f"{seconds:.1f}") for file, seconds in by_file.most_common(12)]


def rows_of_tests(log: Path) -> tuple[str, list[tuple[str, str]]]:
    line = re.compile(r"Test +#\d+: (.+?) \.*[ *]+(\w+).* ([\d.]+) sec$")
    found = [match for match in map(line.search, log.read_text(encoding="utf-8").splitlines()) if match]
    if not found:
        raise SystemExit(f"{log} has no lines of ctest such as 'Test #1: name ...   Passed    0.12 sec'")
    seconds = collections.Counter({match[1]: float(match[3]) for match in found})
    longest = seconds.most_common(12)
    text = (f"The {len(seconds)} tests take {sum(seconds.values()):.0f} s one after the other ({conditions()}), "
            f"{sum(value for _, value in longest):.0f} s of it in {len(longest)}:")
    return text, [(name, f"{value:.0f}" if value >= 10 else f"{value:.1f}") for name, value in longest]


def conditions() -> str:
    compiler = subprocess.run(["c++", "-dumpfullversion"], capture_output=True, text=True).stdout.strip()
    processor = re.search(r"^model name\s*: (.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    day = datetime.date.today()
    return f"{processor[1] if processor else platform.machine()}, c++ {compiler}, {day.day} {day:%B %Y}"


def replaced(page: str, name: str, head: str, text: str, rows: list[tuple[str, str]]) -> str:
    """The page with a new table between its markers; reasons stay with their rows."""
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    if page.count(begin) != 1 or page.count(end) != 1:
        raise SystemExit(f"CONTRIBUTING.md does not have the markers {begin.strip()} and {end} once each")
    before, rest = page.split(begin)
    old, after = rest.split(end)
    reasons = {cells[0].strip(): cells[-1].strip() for cells in
               (row.strip().strip("|").split("|") for row in old.splitlines() if row.startswith("|")) if len(cells) > 2}
    table = "\n".join(f"| {first} | {second} | {reasons.get(first, '')} |" for first, second in rows)
    return f"{before}{begin}{text}\n\n| {head} | s | why so long |\n|---|---|---|\n{table}\n{end}{after}"


def write(of_build: Path, of_tests: Path) -> int:
    path = root / "CONTRIBUTING.md"
    page = path.read_text(encoding="utf-8")
    page = replaced(page, "compilations", "file", *rows_of_build(of_build))
    page = replaced(page, "tests", "test", *rows_of_tests(of_tests))
    path.write_text(page, encoding="utf-8")
    return 0


def main(words: list[str]) -> int:
    match words:
        case ["compile", log, *command] if command:
            return compile(log, command)
        case ["build", log, folder]:
            return build(Path(log), Path(folder))
        case ["tests", log, folder]:
            return tests(Path(log).resolve(), Path(folder))
        case ["write", of_build, of_tests]:
            return write(Path(of_build), Path(of_tests))
    raise SystemExit(__doc__)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
