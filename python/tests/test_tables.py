"""Datasets of all verbs: coordinates, units, and numbers that are known otherwise."""

import math

import numpy
import pytest
import rosin
import xarray

from conftest import ROOT, SLIDER

SMALL = {"map.x.points": 2, "map.y.points": 2}
FEW = {"branch.values": [], "branch.to": 1.3}


def asked(verb, example, changes, *words, **options):
    scene = rosin.load(ROOT / f"examples/{example}.toml")
    for path, value in changes.items():
        scene = scene.set(path, value)
    return getattr(scene, verb)(*words, **options)


ANSWERS = [
    ("frf", "frf-load-family", {}, (), {}),
    ("fit", "step-with-trend", {}, (), {}),
    ("compare", "compare-laws", {}, (), {}),
    ("compare", "ageing-or-slip", {}, (), {}),
    ("compare", "information-on-lambda", SMALL, (), {"design": True}),
    ("compare", "which-law-plays-the-cello", SMALL, (), {}),
    ("branch", "two-motions", FEW, (), {}),
    ("lyapunov", "belt-chaos", {"lyapunov.duration": 60}, (), {}),
    ("stability", "brake-two-modes", {"stability.scan.points": 5}, (), {}),
    ("lab", "lab-slide-hold-slide", {}, ("slide-hold-slide",), {}),
    ("study", "stick-slip-study", {"study.cases": 4}, (), {}),
]


@pytest.mark.parametrize("verb, example, changes, words, options", ANSWERS, ids=[f"{one[0]} {one[1]}" for one in ANSWERS])
def test_datasets_have_units_and_are_kept_as_netcdf(tmp_path, verb, example, changes, words, options):
    result = asked(verb, example, changes, *words, **options)
    for name, data in {"main": result.dataset, **result.tables}.items():
        assert data.attrs["title"] == result.raw["title"]
        for one in data.variables.values():
            assert one.dtype.kind != "f" or ("units" in one.attrs and one.attrs["long_name"])
        data.to_netcdf(tmp_path / f"{name}.nc")
        with xarray.open_dataset(tmp_path / f"{name}.nc", decode_times=False) as stored:
            assert stored.equals(data)


def test_a_family_of_responses():
    result = asked("frf", "frf-load-family", {})
    data = result.dataset
    assert data.normal_load.values.tolist() == [3, 16, 26, 37, 47] and data.normal_load.attrs["units"] == "N"
    assert data.magnitude.dims == ("normal_load", "frequency")
    member = result.raw["family"]["members"][3]["tangential"]
    assert data["real"].sel(normal_load=37).values.tolist() == [real for real, _ in member]
    # At high frequency only the contact spring is seen: k_t/omega.
    assert data.magnitude.sel(normal_load=47, frequency=2000).item() == pytest.approx(2e5 / (2 * math.pi * 2000), rel=0.03)


def test_fitted_parameters_and_their_data():
    result = asked("fit", "step-with-trend", {})
    data = result.dataset
    assert data["law.L"].attrs["units"] == result.units["law.L"] == "m"
    for name, truth in (("law.a", 0.008), ("law.b", 0.005), ("law.L", 12e-6), ("data.1.clock_offset", 0.04)):
        assert data[name].item() == pytest.approx(truth, abs=3 * data[f"{name}_error"].item())
        low, high = data[f"{name}_interval"].values
        assert low < data[name].item() < high
    assert numpy.diag(data.correlation) == pytest.approx(1)
    curve = result.tables["curve-1"]
    assert curve.time.attrs["units"] == "s"
    assert (curve.data - curve.fit).values == pytest.approx(curve.residual.values, abs=1e-15)


def test_members_of_a_comparison():
    steps = asked("compare", "compare-laws", {}).dataset
    assert steps.member.values.tolist() == ["ageing", "slip", "Perrin-Rice-Zheng"]
    # One steady curve: mu0 at the first speed, mu0 + (a - b) ln 10 at the end of the second stretch.
    before, after = (steps.friction_coefficient.sel(time=time, method="nearest") for time in (10, 39.9))
    assert before.values == pytest.approx(0.6, abs=1e-9)
    assert after.values == pytest.approx(0.6 - 0.005 * math.log(10), abs=1e-4)
    cycles = asked("compare", "ageing-or-slip", {})
    assert cycles.dataset.time.dims == ("member", "sample")
    for member, series in cycles.raw["series"].items():
        one = cycles.dataset.sel(member=member).dropna("sample")
        assert one.slip_rate.values.tolist() == series["slip_rate"]


def test_planes_of_members_and_designs():
    quick = {"map.x.from": 4, "map.x.to": 6, "map.y.from": 1e-5, "map.y.to": 2e-5, "compare.protocol": "map"}
    planes = asked("compare", "ageing-or-slip", SMALL | quick)
    data = planes.dataset
    assert data.stick_fraction.dims == ("member", "speed", "normal_load")
    about = {"units": "N", "long_name": "normal load", "scale": "log", "path": "drive.normal_load", "regular_values": 2}
    assert data.normal_load.attrs == about
    assert data.stick_fraction.sel(member="slip")[1, 1].item() == planes.raw["planes"]["slip"]["metrics"]["stick_fraction"][1][1]
    design = asked("compare", "information-on-lambda", SMALL, design=True).dataset
    # Of independent metrics information adds up.
    together = design.discriminability_stick_fraction + design.discriminability_loop_area_normalised
    assert design.discriminability.values == pytest.approx(together.values, rel=1e-12, nan_ok=True)


def test_branches_with_their_events():
    result = asked("branch", "two-motions", FEW)
    hopf = result.tables["events"].isel(event=0)
    assert hopf.kind.item() == "hopf" and hopf["drive.speed"].attrs["units"] == "m/s"
    assert hopf["drive.speed"].item() == pytest.approx(0.5 * math.log(10), abs=3 * hopf["drive.speed_error"].item() + 1e-14)
    steady = result.dataset.isel(row=result.dataset.branch.values == -1)
    assert (steady.stable.values == (steady["drive.speed"].values > 0.5 * math.log(10))).all()


def test_modes_along_a_scan():
    minimal = rosin.Scene({
        "law": {"type": "coulomb", "mu_s": 5, "mu_d": 0.5},
        "oscillator": {"type": "mode-coupling", "mass": 1, "contact": {"stiffness": 4 / 3},
                       "springs": [{"stiffness": 2 / 3 * (2 - 3**0.5), "angle": "150 degree"},
                                   {"stiffness": 2 / 3 * (2 + 3**0.5), "angle": "30 degree"}]},
        "drive": {"speed": 1, "normal_load": 1},
        "stability": {"scan": {"parameter": "law.mu_d", "from": 0, "to": 0.6, "points": 4}},
    }).stability().dataset
    for mu in minimal.mu_d.values:  # Hoffmann et al. (2002): omega^2 = 2 -+ sqrt(1 - 4 mu/3)
        closed = [math.sqrt(2 - sign * math.sqrt(1 - 4 * mu / 3)) / (2 * math.pi) for sign in (1, -1)]
        assert sorted(minimal.frequency.sel(mu_d=mu).values) == pytest.approx(closed, rel=1e-12)


def test_tables_of_an_experiment_beside_its_record():
    result = asked("lab", "lab-slide-hold-slide", {}, "slide-hold-slide")
    peaks = result.tables["peaks"]
    assert peaks.hold_time.attrs["units"] == "s" and list(result.tables) == ["peaks"]
    assert (numpy.diff(peaks.peak) > 0).all()  # contacts strengthen with the time at rest
    assert list(rosin.Scene(SLIDER).run().tables) == ["stick-slip"]


def test_tables_are_kept_with_their_folder(tmp_path):
    first = asked("fit", "step-with-trend", {}, out=tmp_path / "kept")
    (tmp_path / "kept/fit-curve-1.csv").unlink()
    assert "curve-1" in first.tables


def test_printed_numbers_beside_found_ones():
    table = rosin.beside([
        ("period (s)", "12", 12.00103129, 5e-9),
        ("load (N)", "185", 187.607836, 4e-6),
        ("drop (%)", "10 … 11", 10.2, 0.01),
        ("axis (mm/s)", "0.09 ± 0.01", 0.0845, 1e-6),
        ("limit", 1, 0.9975, 1e-4),
        ("cases", 268, 252.0, 27),
    ])
    differences = ["0.0 ± 0.5", "2.6 ± 0.5", "0.0 ± 0.5", "-0.01 ± 0.01", "-0.0025 ± 1e-04", "-16 ± 30"]
    assert [row[3] for row in table.rows] == differences
    assert table.rows[0][2] == "12.001031290 ± 5e-09"
    assert repr(table).splitlines()[1].split() == ["period", "(s)", "12", "12.001031290", "±", "5e-09", "0.0", "±", "0.5"]
    assert "<td>10 … 11</td>" in table._repr_html_()
    with pytest.raises(rosin.InputError, match="printed number 'about 12': one number, 'number ± error'"):
        rosin.beside([("period", "about 12", 12.0, 0.1)])
    [row] = rosin.beside([("period", "12.0", xarray.DataArray(12.5), None)]).rows
    assert row == ("period", "12.0", "12.5, of unknown error", "0.5, of unknown error")


TABLES = [
    ("run", "coulomb-stick-slip", {}, (), ["run", "stick-slip"]),
    ("cycle", "bristol-board-cycle", {}, (), ["cycle"]),
    ("lab", "lab-slide-hold-slide", {}, ("slide-hold-slide",), ["lab", "lab-peaks"]),
    ("frf", "frf-load-family", {}, (), ["frf", "frf-5"]),
    ("fit", "step-with-trend", {}, (), ["fit-curve-1", "fit-residuals-1"]),
    ("branch", "two-motions", FEW, (), ["branch"]),
    ("lyapunov", "belt-chaos", {"lyapunov.duration": 60}, (), ["lyapunov"]),
]


@pytest.mark.parametrize("verb, example, changes, words, files", TABLES, ids=[one[0] for one in TABLES])
def test_the_command_writes_tables_as_netcdf_too(tmp_path, verb, example, changes, words, files):
    asked(verb, example, changes, *words, out=tmp_path, netcdf=True)
    for name in files:
        with xarray.open_dataset(tmp_path / f"{name}.nc", decode_times=False) as data:
            header, *rows = (tmp_path / f"{name}.csv").read_text().splitlines()
            assert data.attrs["title"] and data.attrs["version"].startswith("rosin ") and "[law]" in data.attrs["scene"]
            headings = header.split(",")
            for place, heading in enumerate(headings):
                if headings.index(heading) < place:
                    continue  # told before
                title, _, unit = heading.removesuffix(")").partition(" (")
                column = data[title.replace(" ", "_").replace("/", "_")]
                assert column.attrs["units"] == (unit or "1") and column.attrs["long_name"]
                written = numpy.array([row.split(",")[place] for row in rows], dtype=float)
                numpy.testing.assert_array_equal(column.values, written)


def test_columns_of_words_and_errors_of_columns(tmp_path):
    result = asked("cycle", "bristol-board-cycle", {}, out=tmp_path, netcdf=True)
    branch = asked("branch", "two-motions", FEW, out=tmp_path, netcdf=True)
    with xarray.open_dataset(tmp_path / "branch-events.nc", decode_times=False) as events:
        assert events.kind.values.tolist() == branch.tables["events"].kind.values.tolist() == ["hopf"]
    with xarray.open_dataset(tmp_path / "cycle.nc", decode_times=False) as cycle:
        assert set(cycle.dims) == {"time"} and cycle.sizes == result.dataset.sizes


@pytest.mark.parametrize("verb, example, changes, words, files", TABLES, ids=[one[0] for one in TABLES])
def test_a_result_goes_through_a_folder(tmp_path, verb, example, changes, words, files):
    result = asked(verb, example, changes, *words, out=tmp_path)
    read = rosin.Result.read(tmp_path, verb)
    assert read.raw == result.raw and read.metrics == result.metrics and read.units == result.units
    assert read.complete == result.complete and read.dataset.identical(result.dataset)
    assert read.tables.keys() == result.tables.keys()
    assert all(table.identical(result.tables[name]) for name, table in read.tables.items())
    assert rosin.Result.read(tmp_path).raw == result.raw
    with pytest.raises(rosin.InputError, match=f"basin.json: no such result; the folder has {verb}"):
        rosin.Result.read(tmp_path, "basin")


def test_a_plane_of_one_axis_is_a_sweep():
    scene = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map", {
        "x": {"parameter": "drive.normal_load", "from": 1e-5, "to": 1e-2, "points": 3}, "metrics": ["stick_fraction"]})
    result = scene.map()
    assert result.verb == "sweep"
    assert result.dataset.stick_fraction_up.dims == ("normal_load",)


def test_units_of_single_numbers():
    cycle = asked("cycle", "coulomb-stick-slip", {})
    assert (cycle.units["period"], cycle.units["slip_rate_max"], cycle.units["stick_fraction"]) == ("s", "m/s", "1")
    run = rosin.Scene(SLIDER).run()
    assert run.units["displacement_max"] == run.units["displacement"] == "m"
    string = asked("run", "bowed-string", {})
    assert (string.units["first_slip"], string.units["period"]) == ("s", "1")  # a period over that of the open string


def test_errors_of_averages_are_errors():
    block = asked("run", "elastic-block", {})
    assert not [name for name in block.metrics if name.endswith("_error")]
    assert 0 < block.error["apparent_friction"] < 0.1 * block.metrics["apparent_friction"]
    assert (block.units["centre_x_amplitude"], block.units["centre_y_period"]) == ("m", "s")


def test_a_scan_has_the_unit_of_its_parameter():
    for path, unit in (("law.mu_s", "1"), ("oscillator.pull_stiffness", "N/m")):
        scan = {"parameter": path, "from": 0.5, "to": 1, "points": 2}
        data = asked("stability", "two-blocks-on-a-belt", {"stability": {"scan": scan}}).dataset
        assert data[path.split(".")[1]].attrs["units"] == unit


def test_axes_of_one_name_have_their_whole_paths():
    axes = {name: {"parameter": path, "from": 0.5, "to": 1, "points": 2}
            for name, path in (("x", "law.mu_s"), ("y", "oscillator.contacts.1.law.mu_s"))}
    plane = asked("map", "two-blocks-on-a-belt", {"map": {**axes, "metrics": ["growth_rate"]}}).dataset
    assert plane.growth_rate.dims == ("oscillator_contacts_1_law_mu_s", "law_mu_s")
