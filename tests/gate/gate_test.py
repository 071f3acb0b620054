#!/usr/bin/env python3
"""The gate is silent where nothing has changed, and tells where one bit has."""
import gzip
import pathlib
import subprocess
import sys
import tempfile

rosin = sys.argv[1]
gate = pathlib.Path(__file__).with_name("gate.py")


def run(*arguments):
    return subprocess.run([sys.executable, gate, *arguments, "--rosin", rosin], capture_output=True, text=True)


with tempfile.TemporaryDirectory() as folder:
    record = pathlib.Path(folder) / "before.json.gz"
    made = run("record", str(record), "--scenes", "3", "--only", "scene-|leine-belt-block|velocity-step-prz")
    print(made.stdout, made.stderr)
    assert made.returncode == 0
    same = run("compare", str(record))
    print(same.stdout, same.stderr)
    assert same.returncode == 0 and "the same bits" in same.stdout
    text = gzip.decompress(record.read_bytes()).decode()
    begin = text.index('"period": "') + len('"period": "')
    end = text.index('"', begin)
    last = text[end - 1]
    record.write_bytes(gzip.compress((text[:end - 1] + ("1" if last != "1" else "2") + text[end:]).encode()))
    changed = run("compare", str(record))
    print(changed.stdout, changed.stderr)
    assert changed.returncode == 1 and "period" in changed.stdout and "1 documents differ" in changed.stdout
