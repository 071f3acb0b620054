"""Planes and tables of a verb as xarray datasets: coordinates, `units`, `long_name`, errors as ``<name>_error``."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _rosin

if TYPE_CHECKING:
    import xarray

    from .result import Result

# Tables beside the main one, by verb: patterns of their files. What only a picture needs is no table.
BESIDE = {"run": ["stick-slip"], "branch": ["locus"], "fit": ["fit-curve-*", "fit-residuals-*"], "lab": ["lab-*"]}

# Verbs whose NetCDF files have more than a table.
PLANES = {"map", "sweep", "basin"}


def dataset(result: Result) -> xarray.Dataset | None:
    """The main plane or table of a result, None where it has none."""
    for verb, key, of in (("frf", "family", _family), ("stability", "path", _path), ("fit", "correlation", _fit),
                          ("compare", "series", _series), ("compare", "planes", _planes),
                          ("compare", "discriminability", _design), ("compare", "separation", _strings)):
        if result.verb == verb and result.raw.get(key):
            return _titled(of(result), result)
    stored = result.folder / f"{result.verb}.nc"
    if result.verb in PLANES and stored.exists():
        import xarray

        with xarray.open_dataset(stored, decode_times=False) as plane:
            return plane.load()
    table = result.folder / f"{result.verb}.csv"
    return _table(table, result, result.error) if table.exists() else None


def beside(result: Result) -> dict[str, xarray.Dataset]:
    """Further tables by name, such as the peaks of a slide-hold-slide experiment."""
    found = {}
    for pattern in BESIDE.get(result.verb, []):
        for file in sorted(result.folder.glob(f"{pattern}.csv")):
            if not file.stem.startswith("lab-panel"):  # of a picture
                found[file.stem.removeprefix(f"{result.verb}-")] = _table(file, result)
    if result.raw.get("events") and result.verb == "branch":
        found["events"] = _events(result)
    return found


def _titled(data: xarray.Dataset, result: Result) -> xarray.Dataset:
    return data.assign_attrs(title=result.raw.get("title", ""), version=f"rosin {result.raw.get('version', '')}")


def _columns(table: Path) -> tuple[dict[str, Any], dict[str, str]]:
    """Columns and their units by name."""
    import numpy

    with table.open(newline="", encoding="utf-8") as file:
        header, *rows = (row for row in csv.reader(file) if row)
    columns: dict[str, Any] = {}
    units = {}
    for heading, cells in zip(header, zip(*rows) if rows else [()] * len(header)):
        name, _, unit = heading.removesuffix(")").partition(" (")
        name = name.replace(" ", "_")
        units[name] = unit or "1"
        try:
            columns[name] = numpy.array(cells, dtype=float)
        except ValueError:
            columns[name] = numpy.array(cells)
    return columns, units


def _table(table: Path, result: Result, errors: Mapping[str, Any] | None = None) -> xarray.Dataset:
    """A table whose first column is the coordinate of the others if it rises, or is time, which stands still in a
    jump; with errors of columns, if there are such."""
    import numpy
    import xarray

    columns, units = _columns(table)
    first = next(iter(columns))
    values = columns[first]
    rises = values.dtype == float and bool(numpy.all(values[1:] > values[:-1]))
    dimension = first if rises or first == "time" else "row"
    meaning = result.raw.get("meaning", {})

    def described(name: str, of: str = "{}") -> dict[str, str]:
        return {"units": units[name], "long_name": of.format(meaning.get(name, name.replace("_", " ")))}

    data: dict[str, Any] = {name: (dimension, values, described(name)) for name, values in columns.items()}
    for name, error in (errors or {}).items():
        if name in columns and isinstance(error, (int, float)):
            data[f"{name}_error"] = ((), float(error), described(name, "absolute error of {}"))
    return _titled(xarray.Dataset(data), result)


def _family(result: Result) -> xarray.Dataset:
    """Frequency responses over the parameter of their family."""
    import xarray

    family = result.raw["family"]
    members = []
    for number, _ in enumerate(family["members"], 1):
        members.append(_table(result.folder / f"frf-{number}.csv", result))
    [name] = _rosin.axis_names([family["parameter"]], list(map(str, members[0].variables)))
    along = xarray.DataArray([one["value"] for one in family["members"]], dims=name, name=name,
                             attrs={"units": family["unit"], "long_name": name.replace("_", " ")})
    return xarray.concat(members, dim=along, combine_attrs="override")


def _path(result: Result) -> xarray.Dataset:
    """Eigenvalues of steady sliding along a scan."""
    import numpy
    import xarray

    [name] = _rosin.axis_names([result.raw["parameter"]], ["mode", "growth_rate", "frequency"])
    values = numpy.array(result.raw["path"]["value"], dtype=float)
    modes = result.raw["path"]["eigenvalues"]
    most = max(map(len, modes))
    pairs = numpy.array([one + [[None, None]] * (most - len(one)) for one in modes], dtype=float)  # [value][mode]
    pairs = pairs[:, (pairs[..., 1] >= 0).any(axis=0)]  # one of each conjugate pair
    return xarray.Dataset(
        {"growth_rate": ((name, "mode"), pairs[..., 0], {"units": "1/s", "long_name": "growth rate"}),
         "frequency": ((name, "mode"), numpy.abs(pairs[..., 1]) / (2 * numpy.pi), {"units": "Hz", "long_name": "frequency"})},
        coords={name: (name, values, {"units": result.raw["unit"], "long_name": name.replace("_", " ")})})


def _series(result: Result) -> xarray.Dataset:
    """Members of a comparison over their common coordinate, or over samples where each has its own."""
    import numpy
    import xarray

    series = result.raw["series"]
    names = list(series)
    over = next(iter(series[names[0]]))
    lists = {column: [numpy.array(series[name][column], dtype=float) for name in names] for column in series[names[0]]}
    common = all(numpy.array_equal(one, lists[over][0]) for one in lists[over])
    dimension = over if common else "sample"
    length = max(map(len, lists[over]))
    data: dict[str, Any] = {}
    for column, members in lists.items():
        about = {"units": _rosin.unit_of(column, {}) or "1", "long_name": column.replace("_", " ")}
        if column == over and common:
            data[column] = (over, members[0], about)
        else:
            padded = [numpy.pad(one, (0, length - len(one)), constant_values=numpy.nan) for one in members]
            data[column] = (("member", dimension), numpy.array(padded), about)
    whole = xarray.Dataset(data).assign_coords(member=("member", names, {"long_name": "member of the comparison"}))
    return whole if common else whole.set_coords(over)


def _axes(result: Result, taken: Iterable[str]) -> tuple[dict[str, Any], tuple[str, str]]:
    """Coordinates of a plane, and its dimensions; names of variables are taken."""
    coordinates, dimensions = {}, []
    axes = [result.raw["y"], result.raw["x"]]
    for axis, name in zip(axes, _rosin.axis_names([axis["parameter"] for axis in axes], list(taken))):
        about = {"units": axis["unit"], "long_name": name.replace("_", " "), "scale": axis["scale"]}
        coordinates[name] = (name, axis["values"], about)
        dimensions.append(name)
    return coordinates, (dimensions[0], dimensions[1])


def _planes(result: Result) -> xarray.Dataset:
    """Planes of the members of a comparison."""
    import numpy
    import xarray

    planes = result.raw["planes"]
    metrics = list(next(iter(planes.values()))["metrics"])
    coordinates, dimensions = _axes(result, ["member", "regime", *metrics, *(f"{metric}_error" for metric in metrics)])
    coordinates["member"] = ("member", list(planes), {"long_name": "member of the comparison"})
    data: dict[str, Any] = {}
    for metric in metrics:
        for suffix, table in (("", "metrics"), ("_error", "error")):
            values = numpy.array([one[table][metric] for one in planes.values()], dtype=float)
            words = metric.replace("_", " ")
            unit = result.raw.get("differences", {}).get(metric, {}).get("unit", "1")
            data[metric + suffix] = (("member", *dimensions), values,
                                     {"units": unit, "long_name": f"absolute error of {words}" if suffix else words})
    data["regime"] = (("member", *dimensions), numpy.array([one["regime"] for one in planes.values()]))
    return xarray.Dataset(data, coords=coordinates)


def _strings(result: Result) -> xarray.Dataset:
    """Transients of bowed strings under several laws, and how far the closest two lie apart."""
    import numpy
    import xarray

    coordinates, dimensions = _axes(result, ["member", "transient_length", "reproducible", "separation"])
    members = result.raw["members"]
    coordinates["member"] = ("member", [one["name"] for one in members], {"long_name": "member of the comparison"})

    def of_all(key: str, kind: type) -> Any:
        return numpy.array([one[key] for one in members], dtype=kind)

    planes = ("member", *dimensions)
    return xarray.Dataset(
        {"transient_length": (planes, of_all("transient_length", float), {"units": "1", "long_name": "transient, in periods"}),
         "reproducible": (planes, of_all("reproducible_at", bool), {"long_name": "whether a small change keeps it"}),
         "separation": (dimensions, numpy.array(result.raw["separation"], dtype=float),
                        {"units": "1", "long_name": "least difference of two transients, in periods"})},
        coords=coordinates)


def _design(result: Result) -> xarray.Dataset:
    """What a measurement tells, over the plane of test conditions."""
    import numpy
    import xarray

    coordinates, dimensions = _axes(result, ["discriminability", "discriminability_error", "repeats"])
    words = ("information on ln " + result.raw["parameter"].rsplit(".", 1)[-1] if "parameter" in result.raw
             else "log-likelihood ratio of one measurement")
    data: dict[str, Any] = {}

    def add(name: str, values: Any, long_name: str, **more: str) -> None:
        data[name] = (dimensions, numpy.array(values, dtype=float), {"units": "1", "long_name": long_name} | more)

    add("discriminability", result.raw["discriminability"], words, scale="log")
    add("discriminability_error", result.raw["discriminability_error"], "absolute error of discriminability")
    if "repeats" in result.raw:
        add("repeats", result.raw["repeats"], "measurements needed")
    for metric, one in result.raw["by_metric"].items():
        add(f"discriminability_{metric}", one["discriminability"], f"{words}: {metric.replace('_', ' ')}", scale="log")
    return xarray.Dataset(data, coords=coordinates)


def _fit(result: Result) -> xarray.Dataset:
    """Fitted parameters, with their errors, intervals and correlations."""
    import numpy
    import xarray

    found = result.raw["parameters"]
    names = list(found)
    count = len(names)
    correlation = numpy.array(result.raw["correlation"], dtype=float).reshape(count, count)
    data: dict[str, Any] = {"correlation": (("parameter", "other_parameter"), correlation,
                                            {"units": "1", "long_name": "correlation of two fitted parameters"})}
    for name, one in found.items():
        about = {"units": one.get("unit", "1"), "long_name": name}
        data[name] = ((), _number(one["value"]), about)
        data[f"{name}_error"] = ((), _number(one.get("standard_error")), about | {"long_name": f"standard error of {name}"})
        if one.get("interval"):
            data[f"{name}_interval"] = ("end", [_number(end) for end in one["interval"]],
                                        about | {"long_name": f"{100 * result.raw['confidence']:g} % interval of {name}"})
    return xarray.Dataset(data, coords={"parameter": names, "other_parameter": names})


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)


def _events(result: Result) -> xarray.Dataset:
    """Where a branch changes: kind, value, error."""
    import xarray

    events, name = result.raw["events"], result.raw["parameter"]
    _, units = _columns(result.folder / "branch.csv")
    about = {"units": units[name], "long_name": name}
    return _titled(xarray.Dataset({
        "kind": ("event", [one["kind"] for one in events]),
        name: ("event", [_number(one["value"]) for one in events], about),
        f"{name}_error": ("event", [_number(one["error"]) for one in events],
                          about | {"long_name": f"absolute error of {name}"})}), result)
