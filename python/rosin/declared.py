"""Figures as results declare them (``NAME.figure.json``), drawn by matplotlib."""

from __future__ import annotations

import csv
import json
import math
import re
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PREFIXED = re.compile(r"(?:m|N|s|Hz|W|J|Pa)(?![a-z²])")  # units that take a prefix
PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n", -12: "p"}
MARKERS = {"dot": "o", "circle": "o", "cross": "x", "plus": "+", "square": "s", "open square": "s", "up": "^", "down": "v",
           "open up": "^", "open down": "v", "open diamond": "D"}
PIXELS, POINTS = 115, 6  # of a screen, in an inch; of a marker of size 1


def names(folder: Path, label: str) -> list[str]:
    """The figures that the result of that label in a folder declares, its main one first."""
    try:
        files = json.loads((folder / f"{label}.manifest.json").read_text(encoding="utf-8"))["files"]
    except OSError:
        return []
    found = [file.removesuffix(".figure.json") for file in files if file.endswith(".figure.json")]
    return sorted(found, key=lambda name: name != label)


def read(folder: Path, name: str) -> dict[str, Any]:
    """One of them."""
    return json.loads((folder / f"{name}.figure.json").read_text(encoding="utf-8"))


def draw(declared: dict[str, Any], folder: Path, tables: dict[str, Table], width: float | None = None) -> Figure:
    """Panels beside each other as declared, or one below the other where the picture is narrower than 130 mm.

    Parameters
    ----------
    declared : dict
    folder : pathlib.Path
        Where the tables that it names are files, unless they are among `tables`.
    width : float, optional
        In mm; left out: as on a screen.
    """
    import matplotlib.pyplot as pyplot

    panels, points = declared["panels"], pyplot.rcParams["font.size"]
    across = 1 if width is not None and width < 130 else min(declared["columns"], len(panels))
    down = math.ceil(len(panels) / across)
    inches = declared["width"] / PIXELS if width is None else width / 25.4
    heights = [max(one.get("height", declared["height"]) for one in panels[row * across : (row + 1) * across]) * points / 10 / PIXELS
               for row in range(down)]
    rows = [f"{plain(name)}: {plain(text)}" for name, text in declared.get("rows", [])]
    figure = pyplot.figure(figsize=(inches, sum(heights) + (4.2 * down + 1.35 * len(rows)) * points / 72))
    places = figure.add_gridspec(down, across, height_ratios=heights)
    drawn = []
    for number, panel in enumerate(panels):
        row, column = divmod(number, across)
        alone = column == 0 and number + 1 == len(panels)
        ax = figure.add_subplot(places[row, :] if alone else places[row, column], projection="3d" if _in_space(panel) else None)
        _panel(figure, ax, panel, folder, tables)
        drawn.append(ax)
    for above, below, one, other in zip(drawn, drawn[1:], panels, panels[1:]):
        if across == 1 and all(one["x"].get(key) == other["x"].get(key) for key in ("name", "unit", "decades", "from", "to")):
            above.set_xlabel("")
            above.tick_params(labelbottom=False)
    if rows:
        figure.supxlabel("\n".join(rows), x=0.01, horizontalalignment="left", fontsize=0.85 * points)
    letters = int(inches * 72 / (0.55 * points))  # in a line of the picture
    _head(figure, textwrap.wrap(declared["title"], letters), _keys(drawn, panels, declared["key"]), letters)
    return figure


def _head(figure: Figure, title: list[str], key: dict[str, Any], letters: int) -> None:
    """Title and key above all panels, with room of their own."""
    import matplotlib.pyplot as pyplot

    size = pyplot.rcParams["font.size"]
    line, high = 1.4 * size / 72, figure.get_size_inches()[1]
    columns = max(1, min(len(key), letters // (8 + max(map(len, key), default=0))))
    entries = math.ceil(len(key) / columns)
    above = line * (1.1 * len(title) + entries) + (0.08 if title or key else 0)
    figure.set_size_inches(figure.get_size_inches()[0], high + above)
    figure.get_layout_engine().set(rect=(0, 0, 1, high / (high + above)))
    if title:
        figure.text(0.5, 1 - 0.04 / (high + above), "\n".join(map(plain, title)), fontsize=1.1 * size, verticalalignment="top",
                    horizontalalignment="center")
    if key:
        figure.legend(key.values(), key.keys(), ncol=columns, loc="upper left", borderaxespad=0,
                      bbox_to_anchor=(0.02, 1 - (0.04 + 1.1 * line * len(title)) / (high + above)))


def plain(words: str) -> str:
    """Words as they are: matplotlib sets what stands between two dollars as a formula."""
    return words.replace("$", r"\$")


def label(axis: dict[str, Any], unit: str) -> str:
    """Name, symbol with its index, and unit: "slip rate $v$ (m/s)"."""
    symbol = re.sub(r"_(\w+)", r"_{\1}", axis.get("symbol", ""))
    symbol = re.sub(r"([A-Za-z]{2,}) ", r"\\mathrm{\1}\\,", symbol)  # of "arg Z"
    words = [plain(axis["name"])] if axis.get("name") else []
    text = " ".join([*words, f"${symbol}$"] if symbol else words)
    return text + (f", {plain(axis['detail'])}" if axis.get("detail") else "") + (f" ({unit})" if unit else "")


def prefixed(unit: str, largest: float) -> tuple[float, str]:
    """What values are multiplied by, and the unit that they then have."""
    if not largest > 0 or not math.isfinite(largest) or not PREFIXED.match(unit):
        return 1, unit
    power = min(max(3 * math.floor(math.log10(largest * 1.001) / 3), -12), 9)
    return 10.0**-power, PREFIXES[power] + unit


# ---------------------------------------------------------------- numbers


class Table:
    """Columns, counted from 1; a row without any number parts lines."""

    def __init__(self, rows: list[list[str]]) -> None:
        self.rows, self.size = rows, len(rows)
        self._numbers: dict[int, Any] = {}

    @classmethod
    def of_columns(cls, *columns: numpy.ndarray) -> Table:
        table = cls([])
        table.size, table._numbers = len(columns[0]), dict(enumerate(columns, 1))
        return table

    def column(self, number: int) -> numpy.ndarray:
        import numpy

        if number not in self._numbers:
            self._numbers[number] = numpy.array([_number(row[number - 1]) if len(row) >= number else math.nan for row in self.rows])
        return self._numbers[number]

    def of(self, cell: dict[str, Any]) -> numpy.ndarray:
        import numpy

        values = self.column(cell["column"]) if "column" in cell else numpy.zeros(self.size)
        if "over" in cell:
            values = values / self.column(cell["over"])
        if cell.get("absolute"):
            values = abs(values)
        values = values * cell.get("factor", 1) + cell.get("plus", 0)
        return numpy.where(values < cell["least"], cell["least"], values) if "least" in cell else values

    def where(self, conditions: list[dict[str, Any]]) -> numpy.ndarray:
        import numpy

        holds = numpy.ones(self.size, dtype=bool)
        for one in conditions:
            column, wanted = one["column"], one["value"]
            if isinstance(wanted, str):
                holds &= numpy.array([len(row) >= column and row[column - 1] == wanted for row in self.rows])
            else:
                values = self.column(column)
                holds &= {"=": values == wanted, "<": values < wanted, ">": values > wanted}[one["compare"]]
        return holds


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan


def _table(line: dict[str, Any], folder: Path, tables: dict[str, Table]) -> Table:
    if "rows" in line:
        return Table([[str(value) for value in row] for row in line["rows"]])
    if line["table"] not in tables:
        with (folder / line["table"]).open(newline="", encoding="utf-8") as file:
            tables[line["table"]] = Table([*csv.reader(file)][1:])
    return tables[line["table"]]


def _scaled(axis: dict[str, Any], first: float, last: float, count: int) -> numpy.ndarray:
    """Places at even distances along an axis."""
    import numpy

    return numpy.geomspace(first, last, count) if axis.get("decades") else numpy.linspace(first, last, count)


# ---------------------------------------------------------------- panels


def _in_space(panel: dict[str, Any]) -> bool:
    return "z" in panel and all(line["how"] != "surface" for line in panel["lines"])


def _panel(figure: Figure, ax: Axes, panel: dict[str, Any], folder: Path, tables: dict[str, Table]) -> None:
    colours = _Colours(panel.get("colours"))
    ax.set_title(plain(panel.get("title", "")), fontsize="medium")
    for shade in panel.get("shades", []):
        span = ax.axvspan if shade["axis"] == "x" else ax.axhspan
        span(shade["from"], shade["to"], color=shade["colour"], linewidth=0, zorder=0, label=shade.get("title"))
    for line in panel["lines"]:
        _line(ax, panel, line, folder, tables, colours)
    for rule in panel.get("rules", []):
        (ax.axvline if rule["axis"] == "x" else ax.axhline)(rule["at"], **_look(rule["look"], line=True), label=rule.get("title"))
    for mark in panel.get("marks", []):
        if mark["point"]:
            ax.plot(mark["x"], mark["y"], **_look(mark["look"], points=True), label=mark.get("title"))
        if mark["text"]:
            side = {"left": (-5, 0, "right", "center"), "right": (5, 0, "left", "center"),
                    "below": (0, -6, "center", "top")}.get(mark["side"], (0, 6, "center", "bottom"))
            ax.annotate(plain(mark["text"]), (mark["x"], mark["y"]), side[:2], textcoords="offset points",
                        horizontalalignment=side[2], verticalalignment=side[3], annotation_clip=True)
    for measure in panel.get("measures", []):
        (x0, y0), (x1, y1) = measure["from"], measure["to"]
        ax.annotate("", (x1, y1), (x0, y0), arrowprops={"arrowstyle": "<->", "color": "#B0560F"})
        ax.annotate(plain(measure["name"]), ((x0 + x1) / 2, (y0 + y1) / 2), (-4, 0) if x0 == x1 else (0, -10), color="#B0560F",
                    textcoords="offset points", horizontalalignment="right" if x0 == x1 else "center")
    for number, note in enumerate(panel.get("notes", [])):
        ax.text(0.97, 0.94 - 0.075 * number, plain(note), transform=ax.transAxes, horizontalalignment="right")
    for which in "xyz" if _in_space(panel) else "xy":
        (_axis_in_space if _in_space(panel) else _axis)(ax, which, panel[which])
    if panel.get("equal_scales"):
        ax.set_aspect("equal", adjustable="datalim")
    if colours.shown is not None:
        ax.grid(False)
        bar = figure.colorbar(colours.shown, ax=ax)
        _formatted(bar.ax.yaxis, panel["colours"]["axis"], bar.ax.get_ylim())


def _axis(ax: Axes, which: str, axis: dict[str, Any]) -> None:
    if axis.get("decades"):
        getattr(ax, f"set_{which}scale")("log")
    getattr(ax, f"set_{which}lim")(axis.get("from"), axis.get("to"))
    low, high = limits = getattr(ax, f"get_{which}lim")()
    along = getattr(ax, f"{which}axis")
    ticks = axis.get("ticks")
    if ticks is None and ("further_ticks" in axis or "ticks_from" in axis):  # the usual ones as well, unless they stand close
        further = axis.get("further_ticks", [])
        place = math.log10 if axis.get("decades") else float
        apart = 0.06 * abs(place(high) - place(low))
        ticks = [[at, f"{at:g}"] for at in along.get_ticklocs() if min(low, high) <= at <= max(low, high) and at >= axis.get("ticks_from", -math.inf)
                 and all(abs(place(at) - place(other)) > apart for other, _ in further if not axis.get("decades") or other > 0)] + further
    _formatted(along, axis, limits)
    if ticks is not None:
        along.set_ticks([at for at, _ in ticks], [plain(text) for _, text in ticks])
        along.set_minor_locator(_no_ticks())
        getattr(ax, f"set_{which}lim")(low, high)
    if axis.get("zero"):
        (ax.axvline if which == "x" else ax.axhline)(0, color="#555555", linewidth=0.8)


def _axis_in_space(ax: Axes, which: str, axis: dict[str, Any]) -> None:
    """Matplotlib has no logarithmic axes there: logarithms stand along linear ones."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    along = getattr(ax, f"{which}axis")
    along.set_major_locator(MaxNLocator(3, integer=bool(axis.get("decades"))))
    _formatted(along, axis, getattr(ax, f"get_{which}lim")())
    if axis.get("decades"):
        along.set_major_formatter(FuncFormatter(lambda power, _: f"$10^{{{power:g}}}$"))


def _no_ticks() -> Any:
    from matplotlib.ticker import NullLocator

    return NullLocator()


def _formatted(along: Any, axis: dict[str, Any], limits: tuple[float, float]) -> None:
    """Numbers with the prefix of the unit that suits them; the data stay in SI units."""
    from matplotlib.ticker import FuncFormatter

    unit = axis.get("unit", "")
    if not axis.get("decades"):
        largest = max(abs(axis.get("low", limits[0])), abs(axis.get("high", limits[1])))
        factor, unit = prefixed(unit, largest)
        if factor != 1:
            along.set_major_formatter(FuncFormatter(lambda value, _: f"{value * factor:.6g}".replace("-", "−")))
    along.set_label_text(label(axis, unit))


class _Colours:
    """The colours of numbers in a panel."""

    def __init__(self, scale: dict[str, Any] | None) -> None:
        self.scale, self.shown = scale, None

    def of(self, values: numpy.ndarray) -> dict[str, Any]:
        from matplotlib.colors import LinearSegmentedColormap, LogNorm, Normalize
        import numpy

        assert self.scale is not None
        axis, known = self.scale["axis"], values[numpy.isfinite(values)]
        low = axis.get("from", axis.get("low", known.min() if known.size else 0))
        high = axis.get("to", axis.get("high", known.max() if known.size else 1))
        if axis.get("decades"):
            low = low if low > 0 else high * 1e-5
        elif low == high:
            high = low + (abs(low) or 1)
        own = {"grey": ["#FFFFFF", "#111111"], "blue": ["#EAF1F7", "#00336F"], "signs": ["#B0560F", "#FFFFFF", "#3A8F5C"]}
        palette = self.scale["palette"]
        return {"norm": (LogNorm if axis.get("decades") else Normalize)(low, high),
                "cmap": LinearSegmentedColormap.from_list(palette, own[palette]) if palette in own else palette}


def _look(look: dict[str, Any], points: bool = False, line: bool = False) -> dict[str, Any]:
    """A style of lines and points, as matplotlib has it."""
    from matplotlib.patheffects import withStroke

    lengths = [float(length) / 2 / look["width"] for length in look["dash"].split(",")] if look.get("dash") else []
    style = {"color": look["colour"], "linewidth": look["width"], "linestyle": ((0, lengths) if lengths else "-") if line else "none"}
    if points:
        style |= {"marker": MARKERS[look["point"]], "markersize": POINTS * look["size"],
                  "markerfacecolor": "none" if look["point"].startswith(("open", "circle")) else look["colour"],
                  "markeredgewidth": 0.8}
    if look.get("halo"):
        style["path_effects"] = [withStroke(linewidth=look["width"] + 2.4, foreground="#FFFFFF")]
    return style


def _line(ax: Axes, panel: dict[str, Any], line: dict[str, Any], folder: Path, tables: dict[str, Table], colours: _Colours) -> None:
    import numpy
    from matplotlib.collections import PolyCollection

    how, look, title = line["how"], line["look"], plain(line.get("title", "")) or None
    if "grid" in line:
        grid = line["grid"]
        values = numpy.fromfile(folder / line["table"], count=grid["first"] + grid["columns"] * grid["rows"])[grid["first"] :]
        values = values.reshape(grid["rows"], grid["columns"])
        colours.shown = ax.pcolormesh(_scaled(panel["x"], *grid["x"], grid["columns"]), _scaled(panel["y"], *grid["y"], grid["rows"]),
                                      values, shading="nearest", rasterized=True, **colours.of(values))
        return
    table = _table(line, folder, tables)
    x, y = table.of(line["x"] or {}), table.of(line["y"] or {})
    holds = table.where(line.get("where", []))
    if how in ("image", "surface"):
        z = table.of(line["z"])
        style = colours.of(z) | {"rasterized": True}
        if how == "image":
            xs, ys = numpy.unique(x[~numpy.isnan(x)]), numpy.unique(y[~numpy.isnan(y)])
            values = numpy.full((ys.size, xs.size), math.nan)
            known = ~(numpy.isnan(x) | numpy.isnan(y))
            values[numpy.searchsorted(ys, y[known]), numpy.searchsorted(xs, x[known])] = z[known]
            colours.shown = ax.pcolormesh(xs, ys, values, shading="nearest", **style)
        else:
            gaps = numpy.flatnonzero(numpy.isnan(x))
            rows = [row for row in numpy.split(numpy.arange(x.size), gaps) if (~numpy.isnan(x[row])).any()]
            places = numpy.array([row[~numpy.isnan(x[row])] for row in rows])
            colours.shown = ax.pcolormesh(x[places], y[places], z[places][:-1, :-1], shading="flat", **style)
    elif how == "cells":
        left, right, low, high = (table.column(line["corners"] + edge) for edge in range(4))
        corners = numpy.stack([numpy.stack(pair, axis=-1) for pair in ((left, low), (right, low), (right, high), (left, high))], axis=1)
        known = holds & numpy.isfinite(corners).all(axis=(1, 2))
        if line.get("z"):
            z = table.of(line["z"])
            known &= ~numpy.isnan(z)
            cells = PolyCollection(corners[known], array=z[known], edgecolors="face", linewidths=0.2, rasterized=True, **colours.of(z))
            colours.shown = cells
        else:
            cells = PolyCollection(corners[known], facecolors=look["colour"], edgecolors=look["colour"], linewidths=0.2, label=title)
        ax.add_collection(cells, autolim=False)
        if known.any():
            ax.update_datalim(corners[known].reshape(-1, 2))
            ax.autoscale_view()
    elif how in ("band", "filled"):
        low, high = (table.of(line["low"]), table.of(line["high"])) if how == "band" else (0, y)
        ax.fill_between(x, low, high, color=look["colour"], linewidth=0, zorder=1, label=title)
    elif how == "upright":
        ax.vlines(x[holds], 0, 1, transform=ax.get_xaxis_transform(), color=look["colour"], linewidth=look["width"], label=title)
    elif how == "bars":
        ax.bar(x[holds], y[holds], width=0.5, color=look["colour"] + "66", edgecolor=look["colour"], label=title)
    elif how == "boxplot":
        ax.boxplot([y[~numpy.isnan(y) & holds]], positions=[x[0]], widths=0.5, manage_ticks=False)
    else:
        y = numpy.where(holds, y, math.nan)
        order = numpy.argsort(x, kind="stable") if line.get("sorted") else slice(None)
        along = [x[order], y[order]]
        if _in_space(panel):
            along = [numpy.log10(values) if panel[which].get("decades") else values
                     for which, values in zip("xyz", [*along, table.of(line["z"])[order]])]
        ax.plot(*along, drawstyle="steps-post" if how == "steps" else "default", label=title,
                **_look(look, points=how in ("points", "line and points"), line=how != "points"))


def _keys(axes: list[Axes], panels: list[dict[str, Any]], where: str) -> dict[str, Any]:
    """Titles of lines, with what stands for each: of all panels; those of a panel that has its own are put there."""
    def entries(of: list[Axes]) -> dict[str, Any]:
        return {title: handle for ax in of for handle, title in zip(*ax.get_legend_handles_labels())}

    if where != "own":
        return entries(axes)
    for ax, panel in zip(axes, panels):
        shown, inside = entries([ax]), panel.get("key") or ("top right" if panel.get("title") else "")
        place = {"loc": inside.replace("top", "upper").replace("bottom", "lower")} if inside else {
            "loc": "lower left", "bbox_to_anchor": (0, 1.01), "borderaxespad": 0, "ncol": 2}
        if shown:
            ax.legend(shown.values(), shown.keys(), **place)
    return {}
