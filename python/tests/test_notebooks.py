"""Each notebook runs, and shows what is stored in it."""

import re
import sys

import nbformat
import pytest

from conftest import ROOT

sys.path.insert(0, str(ROOT / "notebooks"))
import execute  # noqa: E402

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
RELATIVE = 1e-6
LARGEST_PICTURE = 150_000  # bytes


def last_digit(number):
    """What one unit of its last printed digit is: 0.01 of "2.50"."""
    digits, _, exponent = number.lower().partition("e")
    return 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))


def differences(stored, shown):
    """Where two texts differ: in words, or in numbers by more than 10⁻⁶ of them and one unit of the last printed digit.

    A number before "±" may differ by four of its errors. Errors are estimates: each behind "±", and each number of one
    digit with an exponent, may differ tenfold, and what rounding leaves below 10⁻¹¹ by any factor.
    """
    words = [re.sub(r"\s+|-{3,}", " ", re.sub(NUMBER, "#", text)).strip() for text in (stored, shown)]
    if words[0] != words[1]:
        return [f"{words[0]!r} became {words[1]!r}"]
    found = []
    pairs = list(zip(re.finditer(NUMBER, stored), re.finditer(NUMBER, shown), strict=True))
    for k, (one, other) in enumerate(pairs):
        a, b = float(one[0]), float(other[0])
        allowed = 1.000001 * max(RELATIVE * abs(a), last_digit(one[0]), last_digit(other[0]))
        if k + 1 < len(pairs) and re.match(r"\s*±", stored[one.end() :]):
            allowed = max(allowed, 4 * float(pairs[k + 1][0][0]))
        elif re.search(r"±\s*$", stored[: one.start()]) or re.fullmatch(r"\de-\d+", one[0]):
            if a == b or min(a, b) > 0 and (max(a, b) < 1e-11 or max(a, b) <= 10 * min(a, b)):
                continue
            allowed = 0
        if abs(a - b) > allowed:
            found.append(f"{one[0]} became {other[0]}")
    return found


def texts(cell):
    return ["".join(output.get("text", "")) or output.get("data", {}).get("text/plain", "") for output in cell.outputs]


def pictures(cell):
    return [output.data["image/png"] for output in cell.outputs if "image/png" in output.get("data", {})]


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_a_notebook_shows_what_is_stored(file):
    stored, shown = nbformat.read(file, as_version=4), execute.executed(file)
    assert len(stored.cells) == len(shown.cells)
    wrong = []
    for number, (before, after) in enumerate(zip(stored.cells, shown.cells), 1):
        if before.cell_type != "code":
            continue
        assert len(pictures(before)) == len(pictures(after)), f"cell {number}"
        for one, other in zip(texts(before), texts(after), strict=True):
            wrong += [f"cell {number}: {what}" for what in differences(one, other)]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_what_is_stored_is_fit_to_be_read_anywhere(file):
    notebook = nbformat.read(file, as_version=4)
    nbformat.validate(notebook)
    text = file.read_text(encoding="utf-8")
    assert not re.search(r"/(?:home|work|tmp|root|usr)/", text), "a path of a machine"
    assert execute.tidy(nbformat.read(file, as_version=4)) == notebook, "run notebooks/execute.py"
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert sum(len(pictures(cell)) for cell in code) >= 2
    for picture in sum(map(pictures, code), []):
        assert len(picture) * 3 / 4 < LARGEST_PICTURE
    assert notebook.cells[0].source.splitlines()[0].endswith("?"), "a notebook begins with its question"
    assert "What does not agree" in notebook.cells[-1].source


def test_there_are_notebooks_and_a_page_that_lists_them():
    page = (ROOT / "docs/notebooks.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) >= 6
    assert [file.name for file in NOTEBOOKS if f"(../notebooks/{file.name})" not in page] == []


@pytest.mark.parametrize("stored, shown, differ", [
    ("period 12.0010313 s", "period 12.0010313 s", False),
    ("period 12.0010313 s", "period 12.0010413 s", False),  # 8e-7 of it
    ("period 12.0010313 s", "period 12.0010613 s", True),
    ("stick 0.58", "stick 0.59", False),
    ("stick 0.58", "stick 0.60", True),
    ("λ 0.073 ± 0.004", "λ 0.080 ± 0.003", False),
    ("λ 0.073 ± 0.004", "λ 0.093 ± 0.004", True),
    ("x 1 ± 2e-09", "x 1 ± 9e-09", False),
    ("x 1 ± 2e-09", "x 1 ± 9e-08", True),
    ("difference 2e-16 ± 4e-15", "difference -7e-16 ± 9e-15", False),
    ("stable", "unstable", True),
    ("1 and 2", "1", True),
])
def test_outputs_are_compared_by_their_digits(stored, shown, differ):
    assert bool(differences(stored, shown)) == differ
