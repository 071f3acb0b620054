"""Wrong input, ends before the work is done, and what goes on meanwhile."""

import functools
import os
import pickle
import re
import signal
import threading
import warnings

import pytest
import rosin
from rosin import _rosin

from conftest import LARGE_PLANE, SLIDER


def wrong(call):
    with pytest.raises(rosin.InputError) as raised:
        call()
    return raised.value


def test_wrong_input_has_its_place(tmp_path):
    error = wrong(rosin.Scene(SLIDER).set("drive.sped", 3).run)
    assert error.place == "drive.sped=3"
    assert error.message == "unknown key 'sped' in [drive]; did you mean 'speed'?"

    error = wrong(rosin.Scene(SLIDER | {"law": {"type": "coulomb", "mu_s": -4}}).run)
    assert error.place == "scene:3:8" and "law.mu_s = -4 is outside" in error.message

    file = tmp_path / "a: scene.toml"
    file.write_text("[law]\ntype = 'coulom'\n")
    error = wrong(rosin.load(file).run)
    assert error.place == f"{file}:2:8" and "did you mean 'coulomb'?" in error.message
    file.write_text("[law\n")
    error = wrong(lambda: rosin.load(file))
    assert error.place == f"{file}:1:5" and "not valid TOML" in error.message
    file.write_text("")
    assert wrong(rosin.load(file).run).message.startswith("the scene is empty")
    assert wrong(rosin.Scene({}).run).message.startswith("the scene is empty")

    file = tmp_path / "missing.toml"
    assert wrong(lambda: rosin.load(file)).place == str(file)
    assert wrong(rosin.Scene(SLIDER).map).message.startswith("the scene has no [map]")
    assert wrong(lambda: rosin.Scene(SLIDER).run(tolerance=7)).message.startswith("--tolerance = 7 is outside")
    assert pickle.loads(pickle.dumps(error)).place == error.place
    with pytest.raises(TypeError, match="tolerence"):
        rosin.Scene(SLIDER).run(tolerence=1e-3)


@pytest.mark.parametrize("call, message", [
    (lambda scene: scene.set("title", "a\0b").run(), "title holds a zero byte"),
    (lambda scene: scene.set("title", "a\ud800b").run(), "holds half of a character"),
    (lambda scene: scene.set("", 1), "a key of the path is empty"),
    (lambda scene: scene.set("drive.speed.x", 1), "drive.speed is 0.1, not a table"),
    (lambda scene: scene.set("drive.speed", float("nan")).run(), "is not a number"),
    (lambda scene: scene.set("drive.speed", [1, 2]).run(), "drive.speed is a list"),
    (lambda scene: scene.set("law", functools.reduce(lambda inner, _: {"a": inner}, range(500), 1)), "levels deep"),
    (lambda scene: scene.run(out="/dev/null/x"), "cannot be made"),
    (lambda scene: scene.run(out="a\0b"), "holds a zero byte"),
    (lambda scene: scene.run(threads=0), "--threads = 0 is outside"),
    (lambda scene: scene.run(tolerance="x"), "--tolerance = x"),
    (lambda scene: scene.lab("velocity-stp"), "did you mean 'velocity-step'?"),
    (lambda scene: scene.lab("--help"), "unknown experiment '--help'; known here: inclined-plane"),
    (lambda scene: rosin.load("/"), "Is a directory"),
    (lambda scene: rosin.load("/bin/sh"), "not valid TOML"),
])
def test_hostile_input_is_refused(call, message, capfd):
    assert message in wrong(lambda: call(rosin.Scene(SLIDER))).message
    assert capfd.readouterr() == ("", "")


def test_an_answer_that_ends_short_is_a_result(large_map):
    with pytest.warns(rosin.IncompleteWarning, match="map .*budget.* spent"):
        result = large_map.map(time_limit=0.3, threads=1)
    assert not result.complete and "spent" in result.outcome
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert rosin.Scene(SLIDER).run().complete  # the limit was that work's only


def test_an_interruption_ends_the_work(large_map):
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where a shell works in the background
    # Python runs the timer's thread while the map is computed; the signal is that of Ctrl-C.
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        large_map.map(threads=1)
    signal.signal(signal.SIGINT, before)
    assert rosin.Scene(SLIDER).run().complete


def test_progress_rises_and_an_interrupted_map_goes_on(tmp_path, monkeypatch):
    scene = rosin.load(LARGE_PLANE).set("map.x.points", 100).set("map.y.points", 100)
    seen = []

    def look(part):
        seen.append(part)
        if part > 0.1:
            raise StopIteration("enough")

    with monkeypatch.context() as patched, pytest.raises(StopIteration, match="enough"):
        patched.setattr(_rosin, "perform", functools.partial(_rosin.perform, progress=look))
        scene.map(out=tmp_path, threads=1)
    assert seen == sorted(seen) and 0 <= seen[0] <= 0.1 < seen[-1] < 1
    with pytest.warns(rosin.IncompleteWarning):
        result = scene.map(out=tmp_path, time_limit=0.01)
    assert any(re.fullmatch(r"going on from [1-9]\d+ finished points", note) for note in result.notes)


def test_threads_wait_for_each_other():
    alone = rosin.Scene(SLIDER).run().raw
    results = []
    threads = [threading.Thread(target=lambda: results.append(rosin.Scene(SLIDER).run().raw)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == [alone] * 4


def test_nothing_is_printed(capfd):
    rosin.Scene(SLIDER).run()
    for _ in range(2):  # NetCDF in one thread after another
        assert rosin.load(LARGE_PLANE).set("map.x.points", 2).set("map.y.points", 2).map().dataset
    rosin.laws()
    wrong(rosin.Scene(SLIDER).set("oscillator.mass", -1).run)
    assert capfd.readouterr() == ("", "")
