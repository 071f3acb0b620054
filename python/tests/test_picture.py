"""Pictures: what stands at their axes."""

import numpy
import pytest
import rosin

from conftest import ROOT, SLIDER


def labels(figure):
    return [(ax.get_xlabel(), ax.get_ylabel()) for ax in figure.axes]


def test_a_plane_has_its_threshold():
    result = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 6).set("map.y.points", 5).map()
    figure = rosin.plot(result, "stick_fraction")
    axes, bar = figure.axes
    assert axes.get_xlabel() == "normal load $N$ (N)" and "$\\lambda$" in axes.get_ylabel()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert bar.get_ylabel() == "stick fraction"
    shown = axes.collections[0].get_array()
    assert numpy.ma.filled(shown, numpy.nan).ravel() == pytest.approx(result.dataset.stick_fraction.values.ravel(),
                                                                       nan_ok=True, abs=0)
    assert any(numpy.array_equal(line.get_xdata(), result.dataset.threshold_x, equal_nan=True) for line in axes.lines)


def test_a_motion_a_loop_and_a_response():
    assert labels(rosin.plot(rosin.Scene(SLIDER).run()))[-1] == ("time $t$ (s)", "friction coefficient\n$\\mu$")
    cycle = rosin.plot(rosin.load(ROOT / "examples/bristol-board-cycle.toml").cycle())
    assert labels(cycle) == [("slip rate $v$ (m/s)", "friction coefficient $\\mu$")]
    stick_slip = rosin.load(ROOT / "examples/coulomb-stick-slip.toml").cycle()
    assert (stick_slip.dataset.time.diff("time") == 0).any()  # friction jumps
    assert labels(rosin.plot(stick_slip)) == labels(cycle)
    blocks = rosin.plot(rosin.load(ROOT / "examples/two-blocks-on-a-belt.toml").cycle())
    assert labels(blocks) == [("slip rate 1 (m/s)", "friction coefficient 1")]
    line = cycle.axes[0].lines[0]
    assert line.get_xdata()[0] == line.get_xdata()[-1]  # closed
    response = rosin.plot(rosin.load(ROOT / "examples/frf-squeal.toml").frf())
    assert labels(response)[-1] == ("frequency $f$ (Hz)", "phase\n$\\arg Z$ (degree)")


def test_what_cannot_be_drawn_says_so():
    run = rosin.Scene(SLIDER).run()
    with pytest.raises(rosin.InputError, match="there is no 'velocty' to draw; known here: displacement"):
        rosin.plot(run, "velocty")
    with pytest.raises(rosin.InputError, match=r"a result of 'stability' \(reached the end\) has no plane or table"):
        rosin.plot(rosin.load(ROOT / "examples/load-step.toml").stability())
