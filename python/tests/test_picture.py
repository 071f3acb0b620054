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


def test_a_picture_for_a_column_of_a_journal():
    result = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 6).set("map.y.points", 5).map()
    figure = rosin.plot(result, ["stick_fraction", "loop_area_normalised"], width=85)
    assert figure.get_size_inches()[0] == pytest.approx(85 / 25.4)
    assert {text.get_fontsize() for ax in figure.axes for text in (ax.xaxis.label, ax.yaxis.label)} == {7}
    above, below = (ax.get_position() for ax in figure.axes[:2])
    assert above.x0 == below.x0 and above.y0 >= below.y1  # one below the other
    with pytest.raises(rosin.InputError, match="width = 20 is outside 80 … 250"):
        rosin.plot(result, width=20)


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


def test_several_lines_in_a_picture():
    family = rosin.plot(rosin.load(ROOT / "examples/frf-load-family.toml").frf())
    assert [line.get_label() for line in family.axes[0].lines] == [f"$N$ = {load} N" for load in (3, 16, 26, 37, 47)]
    laws = rosin.plot(rosin.load(ROOT / "examples/compare-laws.toml").compare(), "friction_coefficient")
    assert [line.get_label() for line in laws.axes[0].lines] == ["ageing", "slip", "Perrin-Rice-Zheng"]
    assert labels(laws) == [("time $t$ (s)", "friction coefficient\n$\\mu$")]
    motions = rosin.load(ROOT / "examples/two-motions.toml").set("branch.values", []).set("branch.to", 1.3).branch()
    drawn = rosin.plot(motions, "slip_rate_max").axes[0]
    steady = motions.dataset.where(motions.dataset.branch < 0, drop=True)  # slips at the speed of the belt
    assert numpy.array_equal(steady.slip_rate_max, steady["drive.speed"]) and steady.slip_rate_max.size > 10
    dashed = [line for line in drawn.lines if line.get_linestyle() != "-"]
    assert {line.get_label().split(", ")[1] for line in dashed if not line.get_label().startswith("_")} == {"unstable"}


def test_cells_of_a_coarse_plane_meet_half_way():
    scene = rosin.load(ROOT / "examples/information-on-lambda.toml").set("map.x.points", 3).set("map.y.points", 3)
    axes = rosin.plot(scene.compare(design=True), "discriminability").axes[0]
    edges = axes.collections[0].get_coordinates()[0, :, 0]
    loads = [9.81e-8, 9.81e-4, 9.81]
    assert edges[1] == pytest.approx((loads[0] * loads[1]) ** 0.5, rel=1e-9) and (edges > 0).all()
    assert edges[0] < loads[0] < edges[1] < loads[1] < edges[2] < loads[2] < edges[3]


def test_a_fit_is_drawn_with_its_residuals():
    figure = rosin.plot(rosin.load(ROOT / "examples/step-with-trend.toml").fit())
    above, below = figure.axes
    assert below.get_xlabel() == "time (s)" and below.get_ylabel() == "residual /\nstandard error"
    assert numpy.std(below.lines[0].get_ydata()) == pytest.approx(1, abs=0.1)


def test_a_sweep_is_drawn_by_one_quantity():
    sweep = rosin.load(ROOT / "examples/forced-belt-sweep.toml").set("sweep.points", 3).set("sweep.keep", 4)
    shown = rosin.plot(sweep.set("sweep.direction", "up").set("sweep.transient", 20).sweep())
    assert labels(shown) == [("speed of the driving surface $V$ (m/s)", "displacement, upwards $x$ (m)")]


def test_what_cannot_be_drawn_says_so():
    run = rosin.Scene(SLIDER).run()
    for what in ("velocty", "displacement_error", []):
        with pytest.raises(rosin.InputError, match="there is no '.*' to draw; known here: displacement, velocity"):
            rosin.plot(run, what)
    with pytest.raises(TypeError, match="results are drawn"):
        rosin.plot(run.dataset)
    with pytest.raises(rosin.InputError, match=r"a result of 'stability' \(reached the end\) has no plane or table"):
        rosin.plot(rosin.load(ROOT / "examples/load-step.toml").stability())


def test_a_sweep_of_metrics_is_drawn_too():
    scene = rosin.load(ROOT / "examples/coulomb-stick-slip.toml")
    sweep = scene.set("sweep", {"parameter": "drive.speed", "from": 0.1, "to": 0.2, "points": 2, "record": "metrics"}).sweep()
    [axes] = rosin.plot(sweep).axes
    assert axes.get_xlabel() == "speed of the driving surface $V$ (m/s)"
    assert axes.lines[0].get_ydata().tolist() == sweep.dataset.displacement_amplitude_up.values.tolist()


def test_titles_and_names_are_no_formulas(tmp_path):
    title = r"5 $ and \nonsense 6 $ of _ ^ {"
    result = rosin.Scene({**SLIDER, "title": title}).run()
    figure = rosin.plot(result)
    figure.savefig(tmp_path / "run.png")  # sets the text
    shown = figure._suptitle.get_text()
    assert shown.replace(r"\$", "$") == title and shown.count("$") == shown.count(r"\$")


def test_values_beside_the_scale_of_a_plane_are_left_out():
    plane = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 3).set("map.y.points", 2)
    result = plane.set("map.y.extra", [0]).map()
    assert result.dataset["lambda"].size == 3
    shown = rosin.plot(result, "stick_fraction").axes[0].collections[0].get_array()
    assert numpy.ma.filled(shown, numpy.nan).ravel() == pytest.approx(result.dataset.stick_fraction.values[:2].ravel(),
                                                                       nan_ok=True, abs=0)


def test_random_starts_are_drawn_by_what_they_come_to():
    axes = {"x": {"start": "displacement", "from": -2, "to": 3}, "y": {"start": "velocity", "from": -2, "to": 2}}
    basin = rosin.load(ROOT / "examples/which-motion.toml").set("basin", {"samples": 12, **axes}).basin()
    [drawn] = rosin.plot(basin).axes
    assert drawn.get_xlabel() == "displacement at the start $x$ (m)"
    assert sum(len(line.get_xdata()) for line in drawn.lines) == 12
    assert {text.get_text() for text in drawn.get_legend().get_texts()} == {"steady 0", "cycle 1"}
