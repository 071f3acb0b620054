"""Pictures of results, in the style of the command's own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

from .errors import InputError
from .result import Result

if TYPE_CHECKING:
    import numpy
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Lines differ in dash as well as in colour: readable in grey and by the colour-blind.
LINES = [
    {"color": "#00336F", "linestyle": "-", "linewidth": 1.8},
    {"color": "#B0560F", "linestyle": (0, (6, 3)), "linewidth": 1.6},
    {"color": "#3A8F5C", "linestyle": (0, (9, 2, 2, 2)), "linewidth": 1.6},
    {"color": "#8A4FA3", "linestyle": (0, (4, 2)), "linewidth": 1.6},
    {"color": "#555555", "linestyle": (0, (1.5, 2)), "linewidth": 1.4},
]
# matplotlib.pyplot.rcParams.update(rosin.STYLE) gives other pictures the same looks.
STYLE = {
    "font.size": 10,
    "axes.grid": True,
    "grid.color": "#CCCCCC",
    "grid.linewidth": 0.5,
    "axes.axisbelow": True,
    "axes.linewidth": 0.8,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "legend.frameon": False,
    "figure.constrained_layout.use": True,
    "axes.prop_cycle": f"cycler(color={[line['color'] for line in LINES]}, linestyle={[line['linestyle'] for line in LINES]})",
}
SYMBOLS = {
    "time": "t",
    "displacement": "x",
    "velocity": r"\dot x",
    "slip_rate": "v",
    "slip": "s",
    "speed": "V",
    "normal_load": "N",
    "friction_force": "F",
    "friction_coefficient": r"\mu",
    "lambda": r"\lambda",
    "stiffness": "k",
    "mass": "m",
    "damping": "c",
    "frequency": "f",
    "magnitude": "|Z|",
    "phase": r"\arg Z",
    "theta": r"\theta",
    "psi": r"\psi",
}


def plot(result: Result, what: str | list[str] | None = None, *, width: float | None = None) -> Figure:
    """Draws a plane, a motion over time, a cycle as a loop, a frequency response, branches, a fit with its residuals,
    or a table over its coordinate.

    Parameters
    ----------
    result : Result
    what : str or list of str, optional
        Names of variables of ``result.dataset``, one panel each; left out: those that tell most.
    width : float, optional
        Of the picture in print, from 80 to 250 mm: 85 for a column of a journal. Text is then 7 points high below 130 mm,
        where panels stand one below the other, and 8 points above; left out: as on a screen.

    Returns
    -------
    matplotlib.figure.Figure
        ``plot(result).savefig("plane.png")`` keeps it.

    Raises
    ------
    InputError
        Where the result has no dataset, or no such variable, or for another width.
    """
    import matplotlib.pyplot as pyplot

    if not isinstance(result, Result):
        raise TypeError(f"results are drawn, such as scene.run(), not {type(result).__name__}")
    if width is not None and not 80 <= width <= 250:
        raise InputError("", f"width = {width} is outside 80 … 250 (width of pictures in print, mm)")
    narrow = width is not None and width < 130
    points = STYLE["font.size"] if width is None else 7 if narrow else 8
    pyplot.draw_if_interactive()  # loads the backend, whose rcParams rc_context would undo: notebooks then show nothing more
    data = result.tables.get("curve-1") if result.verb == "fit" else result.dataset
    if data is None:
        raise InputError("", f"a result of '{result.verb}' ({result.outcome}) has no plane or table to draw")
    draw = {"map": _plane, "basin": _plane, "cycle": _loop, "sweep": _sweep, "branch": _branch, "fit": _fit}.get(
        result.verb, _columns)
    if "start" in data.dims:
        draw = _starts
    if result.verb == "compare" and "scale" in next(iter(data.coords.values())).attrs:
        draw = _plane
    usual = draw.chosen(data)
    names = usual if what is None else [what] if isinstance(what, str) else list(what)
    known = usual if draw is _fit else [str(name) for name in data.variables if data[name].dims == data[usual[0]].dims]
    for name in names or [""]:
        if name not in known:
            raise InputError("", f"there is no '{name}' to draw; known here: "
                                 f"{', '.join(one for one in known if one not in data.coords)}")
    with pyplot.rc_context({**STYLE, "font.size": points, "legend.fontsize": 0.9 * points}):
        figure = draw(data, names, narrow)
        figure.suptitle(_plain(result.raw.get("title", "")), fontsize=1.1 * points, wrap=True)
        if width is not None:
            figure.set_size_inches(width / 25.4, figure.get_size_inches()[1] * points / STYLE["font.size"])
        return figure


def _plain(words: str) -> str:
    """Words of a scene, as they are: matplotlib sets what stands between two dollars as a formula."""
    return words.replace("$", r"\$")


def _label(data: xarray.Dataset, name: str) -> str:
    """Name, symbol and unit: "slip rate $v$ (m/s)"."""
    column = data[name]
    words = column.attrs.get("long_name", name).split(";")[0]
    if len(words) > 40:
        words = name
    symbol = SYMBOLS.get(name.removesuffix("_up").removesuffix("_down"))
    unit = column.attrs.get("units", "1")
    return words.replace("_", " ") + (f" ${symbol}$" if symbol else "") + (f" ({unit})" if unit != "1" else "")


def _chosen(choose: Callable[[xarray.Dataset], list[str]]) -> Callable[[Any], Any]:
    """What a picture shows where nothing is said."""

    def mark(draw: Any) -> Any:
        draw.chosen = choose
        return draw

    return mark


def _of_plane(data: xarray.Dataset) -> list[str]:
    numbers = [str(name) for name, one in data.items() if one.ndim >= 2 and one.dtype.kind == "f"]
    shown = [name for name in numbers if not name.endswith("_error")]
    return shown[:2] or [name for name in ("attractor", "regime") if name in data]


@_chosen(_of_plane)
def _plane(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    from matplotlib.colors import ListedColormap, LogNorm
    import matplotlib.pyplot as pyplot

    panels = []  # a plane for each member of a comparison
    for name in names:
        members = data.member.values if "member" in data[name].dims else [None]
        panels += [(name, member, data[name] if member is None else data[name].sel(member=member)) for member in members]
    down, across = (len(panels), 1) if narrow else (1, len(panels))
    figure, axes = pyplot.subplots(down, across, figsize=(5.6 * across, 4.4 * down), squeeze=False, sharey=True)
    for ax, (name, member, plane) in zip(axes.flat, panels):
        if member is not None:
            ax.set_title(_plain(str(member)), fontsize=pyplot.rcParams["font.size"])
        y, x = map(str, plane.dims)
        plane = plane.isel({over: _on_scale(plane[over]) for over in (x, y)})
        edges = _edges(plane[x]), _edges(plane[y])
        words = plane.attrs.get("flag_meanings", "").split()
        if words:
            colours = ["#E8EEF4", "#00336F", "#B0560F", "#3A8F5C", "#8A4FA3", "#555555", "#C9A227", "#7FA6CC"]
            flags = list(plane.attrs["flag_values"])
            values = plane.where(plane >= 0)
            cells = ax.pcolormesh(*edges, values, shading="flat", rasterized=True, vmin=flags[0] - 0.5,
                                  vmax=flags[-1] + 0.5,
                                  cmap=ListedColormap([colours[i % len(colours)] for i in range(len(flags))]))
            figure.colorbar(cells, ax=ax, ticks=flags).ax.set_yticklabels(word.replace("_", " ") for word in words)
        else:
            norm, label = None, name.replace("_", " ")
            if plane.attrs.get("scale") == "log":  # five decades below the most; white where less, or nothing, is told
                most = float(plane.max()) or 1.0
                norm, label = LogNorm(most * 1e-5, most), plane.attrs["long_name"]
                plane = plane.where(plane >= most * 1e-5)
            cells = ax.pcolormesh(*edges, plane, shading="flat", rasterized=True, cmap="cividis", norm=norm)
            figure.colorbar(cells, ax=ax, label=label + _unit(plane))
        ax.set_facecolor("#FFFFFF")
        for axis, of in (("x", x), ("y", y)):
            if data[of].attrs.get("scale") == "log":
                getattr(ax, f"set_{axis}scale")("log")
        limits = ax.get_xlim(), ax.get_ylim()
        for line, dash, meaning in (("threshold", "-", "threshold of steady sliding"), ("fold", "--", "fold of cycles")):
            if f"{line}_x" in data:
                over = data[f"{line}_x"], data[f"{line}_y"]
                ax.plot(*over, color="white", linewidth=3.2)  # seen on dark cells as well
                ax.plot(*over, color="black", linestyle=dash, linewidth=1.4, label=meaning)
        ax.set_xlim(limits[0]), ax.set_ylim(limits[1])
        ax.grid(False)
        ax.set_xlabel(_label(data, x))
        if ax in axes[:, 0]:
            ax.set_ylabel(_label(data, y))
    if axes[0][0].lines:
        axes[0][0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=1 if narrow else 2)
    return figure


def _on_scale(axis: xarray.DataArray) -> slice:
    """The values that rise along the scale; behind them stand those that a scene adds, such as 0 of a logarithmic one."""
    import numpy

    values = axis.values
    rises = numpy.append(True, values[1:] > values[:-1])
    if axis.attrs.get("scale") == "log":
        rises &= values > 0
    return slice(int(numpy.argmin(numpy.append(rises, False))))


def _edges(axis: xarray.DataArray) -> numpy.ndarray:
    """Where cells around the values of an axis meet: half way, on its scale."""
    import numpy

    values = axis.values
    if values.size < 2:
        return numpy.array([values[0] - 0.5, values[0] + 0.5])
    if axis.attrs.get("scale") == "log":
        return numpy.exp(_middles(numpy.log(values)))
    return _middles(values)


def _middles(values: numpy.ndarray) -> numpy.ndarray:
    import numpy

    between = (values[1:] + values[:-1]) / 2
    return numpy.concatenate([[2 * values[0] - between[0]], between, [2 * values[-1] - between[-1]]])


@_chosen(lambda data: ["attractor"])
def _starts(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    """Random starts, and what each comes to."""
    import matplotlib.pyplot as pyplot

    x, y = [str(name) for name, one in data.items() if one.dtype.kind == "f"]
    figure, axes = pyplot.subplots(len(names), 1, figsize=(5.6, 4.4 * len(names)), squeeze=False, sharex=True)
    for ax, name in zip(axes[:, 0], names):
        words = data[name].attrs.get("flag_meanings", "").split()
        for number, value in enumerate(sorted(set(data[name].values))):
            of = data.isel(start=data[name].values == value)
            flags = list(data[name].attrs.get("flag_values", []))
            ax.plot(of[x], of[y], linestyle="none", marker="os^vD"[number % 5], markersize=4, color=LINES[number % len(LINES)]["color"],
                    label=words[flags.index(value)].replace("_", " ") if value in flags else f"{name} = {value:g}")
        ax.set_ylabel(_label(data, y))
        ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=1 if narrow else 3)
    axes[-1, 0].set_xlabel(_label(data, x))
    return figure


def _unit(column: xarray.DataArray) -> str:
    unit = column.attrs.get("units", "1")
    return "" if unit == "1" else f" ({unit})"


def _of_columns(data: xarray.Dataset) -> list[str]:
    first = next((name for name in map(str, data) if data[name].ndim), None)
    dimensions = data[first].dims if first else ()
    numbers = [str(name) for name, one in data.items() if one.dims == dimensions and one.dtype.kind == "f"]
    told = ("magnitude", "phase"), ("displacement", "slip_rate", "friction_coefficient")
    for names in told:
        if all(name in numbers for name in names):
            return list(names)
    return numbers[:3]


@_chosen(_of_columns)
def _columns(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    """One variable below the other; where there are several members, a line for each."""
    import matplotlib.pyplot as pyplot

    figure, axes = pyplot.subplots(len(names), 1, figsize=(7, 1.2 + 1.8 * len(names)), squeeze=False, sharex=True)
    over, many = _directions(data, names[0])
    for ax, name in zip(axes[:, 0], names):
        members = [None] if many is None else range(data.sizes[many])
        for number in members:
            lines = data if number is None else data.isel({many: number})
            x = lines[over] if over in lines.variables else range(data.sizes[over])
            if many == "mode":  # whose order changes on the way
                ax.plot(x, lines[name], linestyle="none", marker=".", markersize=3, color=LINES[0]["color"])
            else:
                ax.plot(x, lines[name], **LINES[(number or 0) % len(LINES)], label=_member(data, many, number))
        ax.set_ylabel(_label(data, name).replace(" $", "\n$", 1))
        if name == "magnitude":
            ax.set_yscale("log")
    ax.set_xlabel(_label(data, over) if over in data.variables else over)
    if over in data.variables and _decades(data[over]) >= 1.5:
        ax.set_xscale("log")
    if many is not None and many != "mode":
        axes[0, 0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=1 if narrow else 3)
    return figure


def _directions(data: xarray.Dataset, name: str) -> tuple[str, str | None]:
    """The coordinate that a variable is drawn over, and the dimension of which each entry is a line."""
    dimensions = [str(one) for one in data[name].dims]
    lines = [one for one in dimensions if one in ("member", "mode")]
    if not lines and len(dimensions) == 2:
        lines = [dimensions[0]]  # of a family
    over = next(one for one in dimensions if one not in lines)
    if over == "sample":  # each member has its own
        over = next(str(one) for one in data.coords if data[one].ndim == 2)
    return over, lines[0] if lines else None


def _member(data: xarray.Dataset, many: str | None, number: int | None) -> str | None:
    if many is None or number is None:
        return None
    value = data[many].values[number]
    if many == "member":
        return _plain(str(value))
    unit = _unit(data[many]).strip(" ()")
    return f"${SYMBOLS.get(many, many)}$ = {value:g} {unit}".rstrip()


@_chosen(lambda data: [next(str(name) for name in data if str(name).endswith("_max"))])
def _branch(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    """Metrics over the parameter: stable motions as lines, unstable ones dashed."""
    import matplotlib.pyplot as pyplot

    figure, axes = pyplot.subplots(len(names), 1, figsize=(7, 1.6 + 2.8 * len(names)), squeeze=False, sharex=True)
    over = str(list(data)[1])
    for ax, name in zip(axes[:, 0], names):
        for branch in sorted(set(data.branch.values)):
            of = data.isel({data.branch.dims[0]: data.branch.values == branch})
            colour = LINES[int(branch + 1) % len(LINES)]["color"]
            steady = "steady sliding" if branch < 0 else f"cycles of branch {branch:g}"
            for stable, dash in ((1, "-"), (0, (0, (4, 2)))):
                ax.plot(of[over], of[name].where(of.stable == stable), color=colour, linestyle=dash, linewidth=1.6,
                        label=f"{steady}, {'stable' if stable else 'unstable'}" if (of.stable == stable).any() else None)
        ax.set_ylabel(_label(data, name))
    ax.set_xlabel(_label(data, over))
    axes[0, 0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=1 if narrow else 2)
    return figure


@_chosen(lambda data: [str(name) for name in data if str(name).endswith("data")])
def _fit(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    """Data and fits above their residuals over the standard error."""
    import matplotlib.pyplot as pyplot

    over = str(next(iter(data.dims)))
    x = data[over] if over in data.variables else data[str(next(iter(data)))]
    down, across = (len(names), 1) if narrow else (1, len(names))
    figure, axes = pyplot.subplots(2 * down, across, figsize=(7 if across == 1 else 5 * across, 5 * down), squeeze=False,
                                   sharex=True, gridspec_kw={"height_ratios": [2, 1] * down})
    for (above, below), name in zip(axes.T.reshape(-1, 2), names):
        part = name.removesuffix("data")
        above.plot(x, data[name], linestyle="none", marker="o", markersize=2.4, color="#888888", label="measured")
        fits = [str(one) for one in data if str(one) == f"{part}fit" or str(one).startswith(f"{part}fit_of_")]
        for number, fit in enumerate(fits):
            above.plot(x, data[fit], **LINES[number % len(LINES)], label=fit.removeprefix(part).replace("_", " "))
        below.plot(x, data[f"{part}residual"] / data[f"{part}standard_error"], linestyle="none", marker=".",
                   markersize=3, color=LINES[0]["color"])
        above.set_ylabel(part.replace("_", " ").strip() or "measured and fitted")
        below.set_ylabel("residual /\nstandard error")
        below.set_xlabel(over.replace("_", " ") + _unit(x))
        above.legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=1 if narrow else 3)
    return figure


def _decades(values: xarray.DataArray) -> float:
    import numpy

    low, high = float(values.min()), float(values.max())
    return float(numpy.log10(high / low)) if low > 0 and high < float("inf") else 0


def _of_loop(data: xarray.Dataset) -> list[str]:
    """Of the first contact."""
    found = [[str(name) for name in data if str(name).startswith(begin)][:1] for begin in ("slip_rate", "friction_coefficient")]
    return sum(found, [])


@_chosen(_of_loop)
def _loop(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    """Two variables of a periodic motion, one over the other."""
    import matplotlib.pyplot as pyplot

    if len(names) != 2:
        raise InputError("", f"a loop is one variable over another, not {len(names)}: {', '.join(names)}")
    x, y = names
    figure, ax = pyplot.subplots(figsize=(5.6, 4.4))
    closed = data.isel(time=[*range(data.sizes["time"]), 0])
    ax.plot(closed[x], closed[y], **LINES[0])
    if _decades(data[x]) > 2:
        ax.set_xscale("log")
    ax.set_xlabel(_label(data, x)), ax.set_ylabel(_label(data, y))
    return figure


def _of_sweep(data: xarray.Dataset) -> list[str]:
    """One quantity, in all directions in which it was recorded."""
    names = [str(name) for name in data if "_error_" not in str(name)]
    names.sort(key=lambda name: name.startswith("acceleration"))  # last, as in tables of runs
    stem = names[0].removesuffix("_up").removesuffix("_down")
    return [name for name in names if name.removesuffix("_up").removesuffix("_down") == stem]


@_chosen(_of_sweep)
def _sweep(data: xarray.Dataset, names: list[str], narrow: bool) -> Figure:
    """What a motion becomes: each recorded moment over the parameter."""
    import matplotlib.pyplot as pyplot

    figure, ax = pyplot.subplots(figsize=(7, 4.4))
    over = str(data[names[0]].dims[0])
    size = 2.2 if data[names[0]].ndim > 1 else 5  # a cloud of moments, or one number at each value
    for number, name in enumerate(names):
        ax.plot(data[over], data[name], linestyle="none", marker="os^vD"[number % 5], markersize=size * (1 - 0.27 * (number % 2)),
                markeredgewidth=0, color=LINES[number % len(LINES)]["color"])
        ax.plot([], [], linestyle="none", marker="os^vD"[number % 5], color=LINES[number % len(LINES)]["color"],
                label=data[name].attrs.get("long_name", name).replace("_", " "))
    ax.set_xlabel(_label(data, over))
    ax.set_ylabel(_label(data, names[0]) if len(names) == 1 else names[0].removesuffix("_up").removesuffix("_down")
                  .replace("_", " ") + _unit(data[names[0]]))
    ax.legend(loc="upper left", bbox_to_anchor=(0, 1.12), ncol=2)
    return figure
