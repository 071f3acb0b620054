"""Pictures: what stands at their axes."""

import numpy
import matplotlib.pyplot
import pytest
import rosin

from conftest import ROOT, SLIDER


@pytest.fixture(autouse=True)
def close_all():
    yield
    matplotlib.pyplot.close("all")


def labels(figure):
    return [(ax.get_xlabel(), ax.get_ylabel()) for ax in figure.axes]


def test_a_plane_has_its_threshold():
    result = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 6).set("map.y.points", 5).map()
    declared, chosen = rosin.plot(result), rosin.plot(result, "stick_fraction")
    assert labels(declared)[0] == ("normal load $N$ (N)", "clock factor of the law's states $λ$")
    axes, bar = chosen.axes
    assert axes.get_xlabel() == "normal load $N$ (N)" and "$λ$" in axes.get_ylabel()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert bar.get_ylabel() == "stick fraction"
    known = result.dataset.stick_fraction.values.ravel()
    known = known[~numpy.isnan(known)]
    for ax in (axes, declared.axes[0]):
        assert list(ax.collections[0].get_array()) == pytest.approx(list(known), abs=0)
        assert any(numpy.array_equal(line.get_xdata(), result.dataset.threshold_x, equal_nan=True) for line in ax.lines)


def test_a_picture_for_a_column_of_a_journal():
    result = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 6).set("map.y.points", 5).map()
    figure = rosin.plot(result, ["stick_fraction", "loop_area_normalised"], width=85)
    assert figure.get_size_inches()[0] == pytest.approx(85 / 25.4)
    assert {text.get_fontsize() for ax in figure.axes for text in (ax.xaxis.label, ax.yaxis.label)} == {7}
    above, below = (ax.get_position() for ax in figure.axes[::2])  # beside each its colours
    assert above.x0 == below.x0 and above.y0 >= below.y1  # one below the other
    with pytest.raises(rosin.InputError, match="width = 20 is outside 80 … 250"):
        rosin.plot(result, width=20)


def test_a_motion_a_loop_and_a_response():
    run = rosin.Scene(SLIDER).run()
    assert labels(rosin.plot(run))[2] == ("", "friction coefficient $μ$")  # above what happens
    assert labels(rosin.plot(run, ["slip_rate", "friction_coefficient"])) == [
        ("", "slip rate $v$ (mm/s)"), ("time $t$ (s)", "friction coefficient $μ$")]
    cycle = rosin.load(ROOT / "examples/bristol-board-cycle.toml").cycle()
    drawn = rosin.plot(cycle)
    loop = next(ax for ax in drawn.axes if ax.get_xlabel() == "slip rate $v$ (µm/s)" and ax.get_ylabel() == "friction coefficient $μ$")
    line = loop.lines[0]
    assert max(line.get_xdata()) == pytest.approx(cycle.metrics["slip_rate_max"], rel=1e-3)  # SI units
    assert "0" < loop.xaxis.get_major_formatter()(6e-5, 0) == "60"
    response = rosin.plot(rosin.load(ROOT / "examples/frf-squeal.toml").frf())
    assert ("frequency $f$ (Hz)", r"phase $\mathrm{arg}\,Z$ (degree)") in labels(response)


def test_every_declared_figure_is_drawn(tmp_path):
    blocks = rosin.load(ROOT / "examples/two-blocks-on-a-belt.toml").cycle()
    assert {"cycle"} <= {*rosin.declared.names(blocks.folder, "cycle")}
    for result in (blocks, rosin.load(ROOT / "examples/load-step.toml").curve(),
                   rosin.load(ROOT / "examples/load-step.toml").stability(),
                   rosin.load(ROOT / "examples/pin-on-disk-windows.toml").stability(),
                   rosin.load(ROOT / "examples/lab-velocity-step.toml").lab("velocity-step"),
                   rosin.load(ROOT / "examples/elastic-block.toml").set("run.duration", "20 s").run()):
        for name in rosin.declared.names(result.folder, result.verb):
            for width in (None, 85):
                figure = rosin.plot(result, name, width=width)
                figure.savefig(tmp_path / "figure.png")
                assert len(figure.axes) > 0


def test_several_lines_in_a_picture():
    family = rosin.plot(rosin.load(ROOT / "examples/frf-load-family.toml").frf(), "magnitude")
    assert [line.get_label() for line in family.axes[0].lines] == [f"N = {load} N" for load in (3, 16, 26, 37, 47)]
    laws = rosin.plot(rosin.load(ROOT / "examples/compare-laws.toml").compare(), "friction_coefficient")
    assert [line.get_label() for line in laws.axes[0].lines] == ["ageing", "slip", "Perrin-Rice-Zheng"]
    assert labels(laws) == [("time $t$ (s)", "friction coefficient $μ$")]
    motions = rosin.load(ROOT / "examples/two-motions.toml").set("branch.values", []).set("branch.to", 1.3).branch()
    drawn = rosin.plot(motions)
    steady = motions.dataset.where(motions.dataset.branch < 0, drop=True)  # slips at the speed of the belt
    assert numpy.array_equal(steady.slip_rate_max, steady["drive.speed"]) and steady.slip_rate_max.size > 10
    dashed = [line for line in drawn.axes[0].lines if line.get_linestyle() != "-"]
    assert "unstable" in {line.get_label() for line in dashed}


def test_cells_of_a_coarse_plane_meet_half_way():
    scene = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 3).set("map.y.points", 3)
    axes = rosin.plot(scene.map(), "stick_fraction").axes[0]
    edges = sorted({x for cell in axes.collections[0].get_paths() for x in cell.vertices[:, 0]})
    loads = [9.81e-8, 9.81e-4, 9.81]
    assert edges[1] == pytest.approx((loads[0] * loads[1]) ** 0.5, rel=1e-9) and edges[0] > 0
    edges = [edge for k, edge in enumerate(edges) if k == 0 or edge > 1.001 * edges[k - 1]]
    assert edges[0] < loads[0] < edges[1] < loads[1] < edges[2] < loads[2] < edges[3]


def test_a_fit_is_drawn_with_its_residuals():
    figure = rosin.plot(rosin.load(ROOT / "examples/step-with-trend.toml").fit())
    above, below = figure.axes
    assert below.get_xlabel() == "time (s)" and below.get_ylabel() == "residual / error"
    assert numpy.std(below.lines[0].get_ydata()) == pytest.approx(1, abs=0.1)
    assert "law.mu0" in figure._supxlabel.get_text()


def test_what_cannot_be_drawn_says_so():
    run = rosin.Scene(SLIDER).run()
    for what in ("velocty", []):
        with pytest.raises(rosin.InputError, match="there is no '.*' to draw; known here: run, displacement, velocity"):
            rosin.plot(run, what)
    with pytest.raises(TypeError, match="results are drawn"):
        rosin.plot(run.dataset)


def test_titles_and_names_are_no_formulas(tmp_path):
    title = r"5 $ and \nonsense 6 $ of _ ^ {"
    result = rosin.Scene({**SLIDER, "title": title}).run()
    figure = rosin.plot(result)
    figure.savefig(tmp_path / "run.png")  # sets the text
    shown = figure.texts[0].get_text()
    assert shown.replace(r"\$", "$") == title and shown.count("$") == shown.count(r"\$")


def test_values_beside_the_scale_of_a_plane_are_left_out():
    plane = rosin.load(ROOT / "examples/bristol-board-plane.toml").set("map.x.points", 3).set("map.y.points", 2)
    result = plane.set("map.y.extra", [0]).map()
    assert result.dataset["lambda"].size == 3
    known = result.dataset.stick_fraction.values[:2].ravel()
    shown = rosin.plot(result, "stick_fraction").axes[0].collections[0].get_array()
    assert list(shown) == pytest.approx(list(known[~numpy.isnan(known)]), abs=0)


def test_random_starts_are_drawn_by_what_they_come_to():
    axes = {"x": {"start": "displacement", "from": -2, "to": 3}, "y": {"start": "velocity", "from": -2, "to": 2}}
    basin = rosin.load(ROOT / "examples/which-motion.toml").set("basin", {"samples": 12, **axes}).basin()
    figure = rosin.plot(basin)
    assert figure.axes[0].get_xlabel() == "displacement $x$, at the start (m)"
    drawn = [line for line in figure.axes[0].lines if line.get_linestyle() == "None"]
    assert sum(numpy.isfinite(line.get_ydata().astype(float)).sum() for line in drawn) >= 12
