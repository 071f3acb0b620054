"""What README, docs/python.md and examples/python show is true."""

import contextlib
import io
import re
import runpy

import pytest

from conftest import ROOT


def printed(call):
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        call()
    return stream.getvalue()


def check(quoted, output):
    """Each quoted line stands in the output; "…" stands for anything."""
    for line in quoted.splitlines():
        pattern = ".*".join(map(re.escape, line.split("…")))
        assert re.search(pattern, output), f"not printed: {line}\nbut: {output}"


@pytest.fixture
def workplace(tmp_path, monkeypatch):
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("page, least", [("README.md", 1), ("docs/python.md", 6)])
def test_snippets_run(workplace, page, least):
    page = (ROOT / page).read_text(encoding="utf-8")
    names, output, count = {}, None, 0
    for language, block in re.findall(r"^```(\w+)\n(.*?)^```", page, re.MULTILINE | re.DOTALL):
        if language == "python":
            output, count = printed(lambda: exec(block, names)), count + 1
        elif language == "text" and output is not None:
            check(block, output)
        else:
            output = None  # of the command, which has its own tests
    assert count >= least


@pytest.mark.parametrize("example", sorted(ROOT.glob("examples/python/*.py")), ids=lambda path: path.name)
def test_examples_run(workplace, example):
    assert printed(lambda: runpy.run_path(str(example)))
