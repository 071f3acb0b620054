"""Scenes: reading, building, changing."""

import subprocess
import tomllib

import numpy
import pytest
import rosin
from rosin import toml

from conftest import COMMAND, LARGE_PLANE, SLIDER


def test_a_scene_never_changes():
    scene = rosin.Scene(SLIDER)
    faster = scene.set("drive.speed", "20 cm/s")
    assert (scene.get("drive.speed"), faster.get("drive.speed")) == (0.1, "20 cm/s")
    scene.get("law")["type"] = "none"
    assert scene.get("law.type") == "coulomb"
    assert faster.set("drive.speed", 0.2).run().raw == faster.run().raw


def test_a_scene_is_its_file_as_it_was(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(rosin.Scene(SLIDER).toml)
    scene = rosin.load(file)
    file.write_text(rosin.Scene(SLIDER).set("drive.speed", 0.2).toml)
    assert scene.get("drive.speed") == 0.1
    assert scene.run().raw == rosin.Scene(SLIDER).run().raw != rosin.load(file).run().raw


def test_a_file_may_begin_with_a_mark_of_its_encoding(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text(rosin.Scene(SLIDER).toml, encoding="utf-8-sig")
    assert rosin.load(file).run().raw == rosin.Scene(SLIDER).run().raw


def test_entries_of_lists_are_numbered_from_1():
    scene = rosin.load(LARGE_PLANE)
    assert scene.get("map.metrics.1") == "stick_fraction"
    changed = scene.set("map.metrics.2", "period")
    assert changed.get("map.metrics") == ["stick_fraction", "period"]
    assert "period" in changed.set("map.x.points", 2).set("map.y.points", 2).map().dataset
    for path in ("map.metrics.0", "map.metrics.3", "map.metrics.x"):
        with pytest.raises(rosin.InputError, match="a list of 2; an entry of it has a number from 1"):
            scene.set(path, "period")
        with pytest.raises(KeyError):
            scene.get(path)


def test_what_is_left_to_its_default_is_not_there():
    with pytest.raises(KeyError, match="drive.force"):
        rosin.Scene(SLIDER).get("drive.force")


def test_values_are_written_as_they_are_read():
    content = {
        "flag": True,
        "numbers": [1, -2.5e-300, 0.1 + 0.2, float("inf")],
        'a "key" with\nmore': {"inner.key": {"text": 'tab\t, quote ", \\, \x7f and µ'}},
        "empty": {},
        "array": numpy.linspace(0, 1, 3),
        "number": numpy.float64(1) / 3,
    }
    read = tomllib.loads(toml.document(content))
    assert read == content | {"array": [0, 0.5, 1], "number": 1 / 3}


@pytest.mark.parametrize("value", [None, object(), {1, 2}, 1j])
def test_a_value_that_no_scene_holds_is_refused(value):
    with pytest.raises(rosin.InputError, match="a scene holds booleans") as error:
        rosin.Scene(SLIDER).set("drive.speed", value)
    assert error.value.place == "drive.speed"


def test_every_verb_with_a_scene_is_a_method():
    help = subprocess.run([COMMAND, "help"], capture_output=True, text=True, check=True).stdout
    listed = help[help.index("Subcommands:") :].splitlines()[1:]
    verbs = {line.split()[0] for line in listed if line.startswith("  ") and line.strip() and not line.startswith("   ")}
    assert {"run", "map", "lab", "laws"} <= verbs
    assert verbs - {"laws", "new", "import", "export", "verify", "stress", "bench", "plot", "report", "help"} == {
        verb for verb in verbs if callable(getattr(rosin.Scene, verb, None))}
    assert "exact" in rosin.Scene.map.__signature__.parameters
    assert "velocity-step" in rosin.Scene.lab.__doc__


def test_cards_of_laws():
    cards = {law.name: law for law in rosin.laws()}
    a = cards["ageing"].parameters[1]
    assert (a.name, a.unit, a.default, a.minimum, a.maximum) == ("a", "1", 0.01, 1e-4, 0.5)
    assert "bristol-board" in [preset.name for preset in cards["spinodal"].presets]


def test_cards_of_normal_laws():
    cards = {law.name: law for law in rosin.normal_laws()}
    assert not {law.name for law in rosin.laws()} & set(cards)
    power = {parameter.name: parameter for parameter in cards["power"].parameters}
    assert (power["exponent"].default, power["exponent"].minimum, power["exponent"].maximum) == (1, 1, 10)
    assert power["coefficient"].default is None and power["adhesion"].default is False
    assert power["bound_exponent"].default == "exponent"
    assert "stiffness" in {parameter.name for parameter in cards["linear"].parameters}


def test_a_law_as_text():
    scene = rosin.Scene(SLIDER).set("law", {"type": "formula", "formula": {
        "title": "Constant",
        "friction": "mu0*tanh(v/v0)",
        "parameters": {"mu0": {"default": 0.4, "unit": "1", "minimum": 0, "maximum": 5, "meaning": "coefficient"},
                       "v0": {"default": "1 mm/s", "unit": "m/s", "minimum": 1e-9, "maximum": 1, "meaning": "width"}}}})
    assert scene.stability().metrics["friction_coefficient"] == pytest.approx(0.4 * numpy.tanh(100))


def test_arrays_with_units_are_quantities(tmp_path):
    import xarray

    scene = rosin.Scene(SLIDER)
    for value in (xarray.DataArray(20.0, attrs={"units": "cm/s"}), xarray.DataArray(0.2), numpy.array(0.2)):
        assert scene.set("drive.speed", value).run().raw == scene.set("drive.speed", 0.2).run().raw
    with pytest.raises(rosin.InputError, match="is in N, but needed is m/s"):
        scene.set("drive.speed", xarray.DataArray(1.0, attrs={"units": "N"})).run()
    times = scene.set("run.times", xarray.DataArray([0.0, 1e3], attrs={"units": "ms"})).run().dataset.time
    assert times.values.tolist() == scene.set("run.times", range(2)).run().dataset.time.values.tolist() == [0, 1]
    record = tmp_path / "speed.csv"
    record.write_text("0,0.1\n1,0.2\n")
    assert scene.set("drive.speed", {"table": record}).run().complete


def test_names_of_other_programs_are_what_rosin_calls_them():
    scene = rosin.Scene(SLIDER)
    faster = scene.set("drive.V", 0.2)
    assert faster.get("drive.speed") == 0.2 and faster.toml == scene.set("drive.speed", 0.2).toml
    assert faster.run().metrics == scene.set("drive.speed", 0.2).run().metrics
    other = rosin.Scene({**SLIDER, "drive": {"V": 0.1, "normal_load": 1}}).set("drive.speed", 0.2)
    assert other.get("drive") == {"normal_load": 1, "speed": 0.2}
    assert rosin.Scene(tomllib.loads(other.toml)).run().metrics == other.run().metrics
    assert scene.set("law", {"type": "aging"}).set("law.Dc", "3 um").get("law.L") == "3 um"


def test_what_is_no_scene_and_no_path():
    with pytest.raises(TypeError, match="rosin.load reads a file"):
        rosin.Scene("scene.toml")
    with pytest.raises(TypeError, match="a path is a text"):
        rosin.Scene(SLIDER).set(3, 4)
