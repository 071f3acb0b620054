"""Pictures of results, in the style of the command's own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import declared
from .errors import InputError
from .result import Result

if TYPE_CHECKING:
    import numpy
    import xarray
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
    "velocity": "ẋ",
    "slip_rate": "v",
    "slip": "s",
    "speed": "V",
    "normal_load": "N",
    "friction_force": "F",
    "friction_coefficient": "μ",
    "lambda": "λ",
    "stiffness": "k",
    "mass": "m",
    "damping": "c",
    "frequency": "f",
    "magnitude": "|Z|",
    "phase": "arg Z",
    "theta": "θ",
    "psi": "ψ",
}


def plot(result: Result, what: str | list[str] | None = None, *, width: float | None = None) -> Figure:
    """Draws the figure that a result declares, as the command does, or variables of its dataset.

    Parameters
    ----------
    result : Result
    what : str or list of str, optional
        The name of another figure of the result, such as "fit-displacement", or names of variables of
        ``result.dataset``, one panel each, over its coordinate or as a plane; left out: the main figure.
    width : float, optional
        Of the picture in print, from 80 to 250 mm: 85 for a column of a journal. Text is then 7 points high below 130 mm,
        where panels stand one below the other, and 8 points above; left out: as on a screen.

    Returns
    -------
    matplotlib.figure.Figure
        ``plot(result).savefig("plane.png")`` keeps it. Its data are in SI units, also where labels have a prefix.

    Raises
    ------
    InputError
        Where the result has no figure, or no such variable, or for another width.
    """
    import matplotlib.pyplot as pyplot

    if not isinstance(result, Result):
        raise TypeError(f"results are drawn, such as scene.run(), not {type(result).__name__}")
    if width is not None and not 80 <= width <= 250:
        raise InputError("", f"width = {width} is outside 80 … 250 (width of pictures in print, mm)")
    points = STYLE["font.size"] if width is None else 7 if width < 130 else 8
    pyplot.draw_if_interactive()  # loads the backend, whose rcParams rc_context would undo: notebooks then show nothing more
    figures = declared.names(result.folder, result.label)
    if what is None and not figures:
        raise InputError("", f"a result of '{result.verb}' ({result.outcome}) declares no figure")
    tables: dict[str, declared.Table] = {}
    if what is None or what in figures:
        shown = declared.read(result.folder, what if isinstance(what, str) else figures[0])
    else:
        shown = _of_variables(result, [what] if isinstance(what, str) else list(what), figures, tables)
    with pyplot.rc_context({**STYLE, "font.size": points, "legend.fontsize": 0.9 * points}):
        return declared.draw(shown, result.folder, tables, width)


def _of_variables(result: Result, names: list[str], figures: list[str], tables: dict[str, declared.Table]) -> dict[str, Any]:
    """A declaration of variables of the dataset, a panel each, whose numbers stand in `tables`."""
    data = result.dataset
    known = [] if data is None else [str(name) for name, one in data.items() if one.ndim and one.dtype.kind in "fiu"]
    for name in names or [""]:
        if name not in known:
            raise InputError("", f"there is no '{name}' to draw; known here: {', '.join([*figures, *known]) or 'nothing'}")
    assert data is not None
    shown: dict[str, Any] = {"title": result.raw.get("title", ""), "columns": 1, "width": 800, "height": 190, "key": "above", "panels": []}
    for name in names:
        if all("scale" in data[over].attrs for over in data[name].dims[-2:]) and data[name].ndim > 1:
            members = data.member.values if "member" in data[name].dims else [None]
            shown["panels"] += [_plane(data, name, member, tables) for member in members]
            shown |= {"columns": 3, "width": 650 * min(3, len(shown["panels"])), "height": 340}
        else:
            shown["panels"].append(_columns(data, name, tables))
    return shown


def _plane(data: xarray.Dataset, name: str, member: Any, tables: dict[str, declared.Table]) -> dict[str, Any]:
    """A variable over a plane, with the lines at which motion changes."""
    import numpy

    plane = data[name] if member is None else data[name].sel(member=member)
    y, x = map(str, plane.dims)
    plane = plane.isel({over: _on_scale(plane[over]) for over in (x, y)})
    edges = numpy.meshgrid(_edges(plane[x]), _edges(plane[y]))
    corners = [edges[0][:-1, :-1], edges[0][:-1, 1:], edges[1][:-1, :-1], edges[1][1:, :-1]]
    table = f"{name} of {member}"
    tables[table] = declared.Table.of_columns(plane.values.astype(float).ravel(), *(one.ravel() for one in corners))
    panel: dict[str, Any] = {"title": "" if member is None else str(member), "lines": []}
    for which, of, along in (("x", x, edges[0][0]), ("y", y, edges[1][:, 0])):
        panel[which] = _axis(data, of) | {"from": along[0], "to": along[-1]}
    cells = {"how": "cells", "table": table, "x": {}, "y": {}, "corners": 2}
    words = plane.attrs.get("flag_meanings", "").split()
    if words:
        colours = ["#E8EEF4", *(line["color"] for line in LINES), "#C9A227", "#7FA6CC"]
        for number, (flag, word) in enumerate(zip(plane.attrs["flag_values"], words)):
            panel["lines"].append(cells | {"title": word.replace("_", " "), "look": {"colour": colours[number % len(colours)]},
                                           "where": [{"column": 1, "compare": "=", "value": float(flag)}]})
    else:
        axis = _axis(data, name)
        if plane.attrs.get("scale") == "log":  # five decades below the most; white where less, or nothing, is told
            axis |= {"decades": True, "to": float(plane.max()) or 1.0, "from": (float(plane.max()) or 1.0) * 1e-5}
            cells["where"] = [{"column": 1, "compare": ">", "value": axis["from"]}]
        panel["colours"] = {"axis": axis, "palette": "cividis"}
        panel["lines"].append(cells | {"look": {}, "z": {"column": 1}})
    for line, dash, meaning in (("threshold", "", "threshold of steady sliding"), ("fold", "6,4", "fold of cycles")):
        if f"{line}_x" in data:
            tables[line] = declared.Table.of_columns(data[f"{line}_x"].values, data[f"{line}_y"].values)
            panel["lines"].append({"how": "line", "table": line, "title": meaning, "x": {"column": 1}, "y": {"column": 2},
                                   "look": {"colour": "#000000", "width": 1.4, "dash": dash, "halo": True}})
    return panel


def _columns(data: xarray.Dataset, name: str, tables: dict[str, declared.Table]) -> dict[str, Any]:
    """A variable over its coordinate; where there are several members, a line for each."""
    import numpy

    over, many = _directions(data, name)
    panel: dict[str, Any] = {"y": _axis(data, name), "lines": []}
    for number in [None] if many is None else range(data.sizes[many]):
        of = data if number is None else data.isel({many: number})
        x = of[over].values if over in of.variables else numpy.arange(data.sizes[over], dtype=float)
        table = f"{name} {number}"
        tables[table] = declared.Table.of_columns(x.astype(float), of[name].values.astype(float))
        look = LINES[(number or 0) % len(LINES)]
        lengths = look["linestyle"][1] if isinstance(look["linestyle"], tuple) else ()
        panel["lines"].append({
            "table": table, "x": {"column": 1}, "y": {"column": 2}, "title": "" if many == "mode" else _member(data, many, number),
            "how": "points" if many == "mode" else "line",  # modes change their order on the way
            "look": {"colour": LINES[0]["color"] if many == "mode" else look["color"], "width": look["linewidth"], "point": "dot", "size": 0.4,
                     "dash": ",".join(f"{2 * length * look['linewidth']:g}" for length in lengths)}})
    panel["x"] = _axis(data, over) if over in data.variables else {"name": over}
    if over in data.variables and _decades(data[over]) >= 1.5:
        panel["x"]["decades"] = True
    if name == "magnitude":
        panel["y"]["decades"] = True
    return panel


def _axis(data: xarray.Dataset, name: str) -> dict[str, Any]:
    """Name, symbol and unit, and the numbers that choose its prefix."""
    column = data[name]
    words = column.attrs.get("long_name", name).split(";")[0]
    unit = column.attrs.get("units", "1")
    axis = {"name": (words if len(words) <= 40 else name).replace("_", " "), "unit": "" if unit == "1" else unit,
            "symbol": SYMBOLS.get(name.removesuffix("_up").removesuffix("_down"), "")}
    if column.size and not column.isnull().all():
        axis |= {"low": float(column.min()), "high": float(column.max())}
    return axis | ({"decades": True} if column.attrs.get("scale") == "log" and name in data.coords else {})


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


def _member(data: xarray.Dataset, many: str | None, number: int | None) -> str:
    if many is None or number is None:
        return ""
    value, unit = data[many].values[number], data[many].attrs.get("units", "1")
    return str(value) if many == "member" else f"{SYMBOLS.get(many, many)} = {value:g} {unit if unit != '1' else ''}".rstrip()


def _decades(values: xarray.DataArray) -> float:
    import numpy

    low, high = float(values.min()), float(values.max())
    return float(numpy.log10(high / low)) if low > 0 and high < float("inf") else 0
