"""What all tests of the package have in common."""

import json
import os
import subprocess
from pathlib import Path

import matplotlib
import pytest

matplotlib.use("Agg")
ROOT = Path(__file__).resolve().parents[2]
COMMAND = os.environ["ROSIN_COMMAND"]

SLIDER = {
    "law": {"type": "coulomb", "mu_s": 0.4, "mu_d": 0.3},
    "oscillator": {"type": "slider", "mass": 1, "stiffness": 1},
    "drive": {"speed": 0.1, "normal_load": 1},
    "run": {"duration": 20, "start": "rest"},
}
LARGE_PLANE = ROOT / "examples/bristol-board-plane.toml"


@pytest.fixture
def command(tmp_path):
    """Performs a command line; the document that it prints, and the folder of its files."""

    def perform(*words):
        folder = tmp_path / "of-command"
        line = [COMMAND, *map(str, words), "--json", "--no-pictures", "--out", str(folder)]
        return json.loads(subprocess.run(line, check=True, capture_output=True, text=True).stdout), folder

    return perform


@pytest.fixture
def large_map():
    """A scene whose map takes minutes."""
    import rosin

    return rosin.load(LARGE_PLANE).set("map.x.points", 400).set("map.y.points", 400)
