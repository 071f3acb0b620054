"""Pictures of results, in the style of the command's own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable

from .errors import InputError

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from .result import Result

# Lines differ in dash as well as in colour: readable in grey and by the colour-blind.
LINES = [
    {"color": "#00336F", "linestyle": "-", "linewidth": 1.8},
    {"color": "#B0560F", "linestyle": (0, (6, 3)), "linewidth": 1.6},
    {"color": "#3A8F5C", "linestyle": (0, (9, 2, 2, 2)), "linewidth": 1.6},
    {"color": "#8A4FA3", "linestyle": (0, (4, 2)), "linewidth": 1.6},
    {"color": "#555555", "linestyle": (0, (1.5, 2)), "linewidth": 1.4},
]
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


def plot(result: Result, what: str | list[str] | None = None) -> Figure:
    """Draws a plane, a motion over time, a cycle as a loop, a frequency response, or a table over its coordinate.

    Parameters
    ----------
    result : Result
    what : str or list of str, optional
        Names of variables of ``result.dataset``, one panel each; left out: those that tell most.

    Returns
    -------
    matplotlib.figure.Figure
        ``plot(result).savefig("plane.png")`` keeps it.

    Raises
    ------
    InputError
        Where the result has no dataset, or no such variable.
    """
    import matplotlib.pyplot as pyplot

    data = result.dataset
    if data is None:
        raise InputError("", f"a result of '{result.verb}' ({result.outcome}) has no plane or table to draw")
    draw = {"map": _plane, "basin": _plane, "cycle": _loop, "sweep": _sweep}.get(result.verb, _columns)
    names = draw.chosen(data) if what is None else [what] if isinstance(what, str) else list(what)
    for name in names:
        if name not in data:
            raise InputError("", f"there is no '{name}' to draw; known here: {', '.join(map(str, data.data_vars))}")
    with pyplot.rc_context(STYLE):
        figure = draw(data, names)
        figure.suptitle(result.raw.get("title", ""), fontsize=11)
        return figure


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
    numbers = [str(name) for name, one in data.items() if one.ndim == 2 and one.dtype.kind == "f"]
    shown = [name for name in numbers if not name.endswith("_error")]
    return shown[:2] or [name for name in ("attractor", "regime") if name in data]


@_chosen(_of_plane)
def _plane(data: xarray.Dataset, names: list[str]) -> Figure:
    from matplotlib.colors import ListedColormap
    import matplotlib.pyplot as pyplot

    figure, axes = pyplot.subplots(1, len(names), figsize=(5.6 * len(names), 4.4), squeeze=False, sharey=True)
    for ax, name in zip(axes[0], names):
        plane = data[name]
        y, x = map(str, plane.dims)
        words = plane.attrs.get("flag_meanings", "").split()
        if words:
            colours = ["#E8EEF4", "#00336F", "#B0560F", "#3A8F5C", "#8A4FA3", "#555555", "#C9A227", "#7FA6CC"]
            flags = list(plane.attrs["flag_values"])
            values = plane.where(plane >= 0)
            cells = ax.pcolormesh(data[x], data[y], values, shading="nearest", rasterized=True, vmin=flags[0] - 0.5,
                                  vmax=flags[-1] + 0.5,
                                  cmap=ListedColormap([colours[i % len(colours)] for i in range(len(flags))]))
            figure.colorbar(cells, ax=ax, ticks=flags).ax.set_yticklabels(word.replace("_", " ") for word in words)
        else:
            cells = ax.pcolormesh(data[x], data[y], plane, shading="nearest", rasterized=True, cmap="cividis")
            figure.colorbar(cells, ax=ax, label=name.replace("_", " ") + _unit(plane))
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
        if ax is axes[0][0]:
            ax.set_ylabel(_label(data, y))
    if axes[0][0].lines:
        axes[0][0].legend(loc="lower left", bbox_to_anchor=(0, 1), ncol=2, fontsize=9)
    return figure


def _unit(column: xarray.DataArray) -> str:
    unit = column.attrs.get("units", "1")
    return "" if unit == "1" else f" ({unit})"


def _of_columns(data: xarray.Dataset) -> list[str]:
    first = str(next(iter(data.dims)))
    numbers = [str(name) for name, one in data.items() if one.dims == (first,) and one.dtype.kind == "f"]
    told = ("magnitude", "phase"), ("displacement", "slip_rate", "friction_coefficient")
    for names in told:
        if all(name in numbers for name in names):
            return list(names)
    return numbers[:3]


@_chosen(_of_columns)
def _columns(data: xarray.Dataset, names: list[str]) -> Figure:
    import matplotlib.pyplot as pyplot

    figure, axes = pyplot.subplots(len(names), 1, figsize=(7, 1.2 + 1.8 * len(names)), squeeze=False, sharex=True)
    over = str(next(iter(data[names[0]].dims)))
    for ax, name in zip(axes[:, 0], names):
        ax.plot(data[over] if over in data else range(data.sizes[over]), data[name], **LINES[0])
        ax.set_ylabel(_label(data, name).replace(" $", "\n$", 1))
        if name == "magnitude":
            ax.set_yscale("log")
    ax.set_xlabel(_label(data, over) if over in data else over)
    if _decades(data[over]) > 3:
        ax.set_xscale("log")
    return figure


def _decades(values: xarray.DataArray) -> float:
    import numpy

    low, high = float(values.min()), float(values.max())
    return float(numpy.log10(high / low)) if low > 0 else 0


def _of_loop(data: xarray.Dataset) -> list[str]:
    """Of the first contact."""
    found = [[str(name) for name in data if str(name).startswith(begin)][:1] for begin in ("slip_rate", "friction_coefficient")]
    return sum(found, [])


@_chosen(_of_loop)
def _loop(data: xarray.Dataset, names: list[str]) -> Figure:
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


@_chosen(lambda data: [str(name) for name, one in data.items() if one.ndim == 2][:2])
def _sweep(data: xarray.Dataset, names: list[str]) -> Figure:
    """What a motion becomes: each recorded moment over the parameter."""
    import matplotlib.pyplot as pyplot

    figure, ax = pyplot.subplots(figsize=(7, 4.4))
    over = str(data[names[0]].dims[0])
    for number, name in enumerate(names):
        ax.plot(data[over], data[name], linestyle="none", marker="os^vD"[number % 5], markersize=2.2 - 0.6 * (number % 2),
                markeredgewidth=0, color=LINES[number % len(LINES)]["color"])
        ax.plot([], [], linestyle="none", marker="os^vD"[number % 5], color=LINES[number % len(LINES)]["color"],
                label=data[name].attrs.get("long_name", name).replace("_", " "))
    ax.set_xlabel(_label(data, over))
    ax.set_ylabel(_label(data, names[0]) if len(names) == 1 else names[0].removesuffix("_up").removesuffix("_down")
                  .replace("_", " ") + _unit(data[names[0]]))
    ax.legend(loc="upper left", bbox_to_anchor=(0, 1.12), ncol=2)
    return figure
