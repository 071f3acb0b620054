"""The numbers are those of the command, to the last bit."""

import gc
import math
import pickle
import tomllib

import pytest
import rosin
import xarray

from conftest import ROOT, SLIDER

SMALL = {"map.x.points": 5, "map.y.points": 4}
ASKED = [
    ("run", "slide-hold-slide", {}),
    ("run", "coulomb-stick-slip", {}),
    ("cycle", "bristol-board-cycle", {}),
    ("stability", "load-step", {}),
    ("curve", "velocity-step", {}),
    ("frf", "frf-squeal", {}),
    ("map", "bristol-board-plane", SMALL),
    ("sweep", "forced-belt-sweep", {"sweep.points": 3, "sweep.keep": 4, "sweep.transient": 20}),
    ("basin", "which-motion", {"basin.x.points": 5, "basin.y.points": 4}),
]


def without_cost(document):
    return {key: one for key, one in document.items() if key != "cost"}


@pytest.mark.parametrize("verb, example, changes", ASKED, ids=[f"{verb} {example}" for verb, example, _ in ASKED])
def test_documents_and_datasets_are_the_commands(command, verb, example, changes):
    file = ROOT / f"examples/{example}.toml"
    scene = rosin.load(file)
    for path, value in changes.items():
        scene = scene.set(path, value)
    result = getattr(scene, verb)()
    document, folder = command(verb, file, *(f"--set={path}={value}" for path, value in changes.items()))
    assert without_cost(result.raw) == without_cost(document)
    assert result.complete and result.outcome == "reached the end"
    stored = folder / f"{verb}.nc"
    if stored.exists():
        with xarray.open_dataset(stored) as plane:
            assert plane.identical(result.dataset)
    for name, values in document.get("columns", {}).items():
        assert result.dataset[name].values.tolist() == values
        assert result.dataset[name].attrs["units"] == document["units"][name]


def test_an_experiment_of_the_laboratory(command):
    file = ROOT / "examples/lab-velocity-step.toml"
    result = rosin.load(file).lab("velocity-step")
    document, _ = command("lab", "velocity-step", file)
    assert result.raw == document
    # A jump by e-folds of slip rate is a ln(10) of the ageing law, a = 0.01.
    assert result.metrics["direct_jump"] == pytest.approx(0.01 * math.log(10), abs=2 * result.error["direct_jump"])
    assert result.units["decay_length"] == "m"


def test_a_table_has_units_names_and_errors():
    data = rosin.Scene(SLIDER).run().dataset
    assert data.displacement.dims == ("time",)
    assert data.time.attrs == {"units": "s", "long_name": "time"}
    assert data.slip_rate.attrs == {"units": "m/s", "long_name": "slip rate"}
    assert data.slip_rate_error.attrs == {"units": "m/s", "long_name": "absolute error of slip rate"}
    # It sticks until the spring carries mu_s N = 0.4 N, at 4 s.
    assert data.displacement.sel(time=3.9, method="nearest").item() == pytest.approx(0.39, abs=0.005)
    assert data.friction_coefficient.max().item() == pytest.approx(0.4, abs=1e-3)
    assert (data.slip_rate.sel(time=slice(0, 3.99)) == 0).all() and (data.slip_rate.sel(time=slice(4.02, 4.5)) > 0).all()


def test_a_scene_of_python_is_that_of_a_file(tmp_path, command):
    scene = rosin.Scene(SLIDER).set("drive.speed", "10 cm/s").set("title", 'Quotes " and \\ and µ')
    file = tmp_path / "same.toml"
    file.write_text(scene.toml, encoding="utf-8")
    assert scene.run().raw == command("run", file)[0] == rosin.load(file).run().raw


def test_files_are_kept_where_asked(tmp_path):
    kept = rosin.Scene(SLIDER).run(out=tmp_path / "kept")
    assert (tmp_path / "kept/result.json").exists() and (tmp_path / "kept/run.csv").exists()
    assert not list((tmp_path / "kept").glob("*.svg"))
    temporary = rosin.Scene(SLIDER).run()
    folder = temporary.folder
    assert (folder / "run.csv").exists()
    assert temporary.dataset.identical(kept.dataset)
    del temporary
    assert not folder.exists()


def test_fitted_parameters_are_metrics(monkeypatch):
    file = ROOT / "examples/fit-curve.toml"
    monkeypatch.chdir(file.parent)  # where a scene of Python looks for the table that it names
    result = rosin.Scene(tomllib.loads(file.read_text())).fit()
    assert result.raw["parameters"] == rosin.load(file).fit().raw["parameters"]
    assert result.metrics == {name: one["value"] for name, one in result.raw["parameters"].items()}
    assert result.error.keys() == result.metrics.keys()


def test_the_folder_of_a_result_may_be_called_by_its_numbers(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = rosin.Scene(SLIDER).run(out="speed-{drive.speed}")
    assert result.folder == tmp_path / "speed-0.1" and (result.folder / "run.csv").exists()
    assert result.dataset.sizes["time"] == 1001


def test_a_result_passes_between_processes_with_its_tables():
    result = rosin.Scene(SLIDER).run()
    passed = pickle.dumps(result)
    expected = result.dataset
    del result  # and its files
    gc.collect()
    passed = pickle.loads(passed)
    assert not passed.folder.exists()
    assert passed.dataset.identical(expected) and list(passed.tables) == ["stick-slip"]
