"""Planes and tables of a result as xarray datasets: coordinates, `units`, `long_name`, errors as ``<name>_error``."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray

    from .result import Result


def dataset(result: Result) -> xarray.Dataset | None:
    """The main plane or table of a result, None where it has none."""
    described = result.raw.get("datasets", [])
    return _read(result, described[0]) if described else None


def beside(result: Result) -> dict[str, xarray.Dataset]:
    """Further tables by name, such as the peaks of a slide-hold-slide experiment."""
    tables = {}
    for described in result.raw.get("datasets", [])[1:]:
        table = _read(result, described)
        if table is not None:
            tables[described["name"].removeprefix(f"{result.verb}-")] = table
    return tables


def _read(result: Result, described: dict[str, Any]) -> xarray.Dataset | None:
    """One of the document's ``datasets``, as it stands in NetCDF, or else in columns."""
    import xarray

    plane, table = (result.folder / f"{described['name']}{ending}" for ending in (".nc", ".csv"))
    if plane.exists():
        with xarray.open_dataset(plane, decode_times=False) as stored:
            return stored.load()
    return _of_columns(result, described, table) if table.exists() else None


def _of_columns(result: Result, described: dict[str, Any], table: Any) -> xarray.Dataset:
    import numpy
    import xarray

    with table.open(newline="", encoding="utf-8") as file:
        _, *rows = (row for row in csv.reader(file) if row)
    [dimension] = described["dimensions"]
    data: dict[str, Any] = {}
    for place, (heading, about) in enumerate(described["variables"].items()):
        name, cells = heading.replace(" ", "_"), [row[place] for row in rows]
        attributes = {"units": about["unit"]} if "unit" in about else {}
        attributes["long_name"] = about["meaning"]
        data[name] = (dimension, numpy.array(cells, dtype=float if "unit" in about else str), attributes)
        if about.get("error") is not None:
            data[f"{name}_error"] = ((), float(about["error"]), attributes | {"long_name": f"absolute error of {name.replace('_', ' ')}"})
    return xarray.Dataset(data, attrs={"title": result.raw.get("title", ""), "version": f"rosin {result.raw.get('version', '')}"})
