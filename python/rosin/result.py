"""What comes back from a verb."""

from __future__ import annotations

import json
import re
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _rosin, tables
from .errors import InputError

if TYPE_CHECKING:
    import xarray


class Result:
    """The answer of a verb: the same numbers as the command's, bit for bit.

    Attributes
    ----------
    verb : str
    complete : bool
        Whether everything asked was computed.
    raw : dict
        The whole document, as in the command's ``result.json``; what is absent or not finite is None.
    folder : pathlib.Path
        The files; a temporary folder is gone with the result.
    """

    def __init__(self, verb: str, complete: bool, output: str, messages: str, folder: Path) -> None:
        self.complete = complete
        self.raw: dict[str, Any] = json.loads(output) if output else {}
        self.verb: str = self.raw.get("verb", verb)  # a map of one axis is a sweep
        self.folder = folder
        self._messages = messages

    @classmethod
    def read(cls, folder: str | Path, verb: str = "result") -> Result:
        """The answer that stands in a results folder, of the command or of Python: that of a verb ("cycle"), or the last.

        Raises
        ------
        rosin.InputError
            Where the folder has none.
        """
        document = Path(folder) / f"{verb}.json"
        if not document.is_file():
            there = sorted(path.name.removesuffix(".manifest.json") for path in Path(folder).glob("?*.manifest.json"))
            raise InputError(str(document), "no such result" + (f"; the folder has {', '.join(there)}" if there else ""))
        text = document.read_text(encoding="utf-8")
        return cls(verb, json.loads(text)["outcome"] == "reached the end", text, "", Path(folder))

    @property
    def label(self) -> str:
        """What its files are named by: the verb, or "design"."""
        return "design" if self.verb == "compare" and "discriminability" in self.raw else self.verb

    @property
    def outcome(self) -> str:
        """How the computation ended: "reached the end", "none exists", "tolerance not met", …"""
        return self.raw.get("outcome", "unknown")

    @property
    def detail(self) -> str:
        """Where and why it ended short; else empty."""
        return self.raw.get("outcome_detail", "")

    @property
    def verdict(self) -> str:
        """What the result says in a sentence, with the numbers that decide."""
        return self.raw.get("verdict", "")

    @property
    def metrics(self) -> dict[str, float]:
        """Single numbers by name, in SI units: of a cycle, the readings of an experiment, fitted parameters, …"""
        for table in ("readings", "metrics", "parameters", "steady"):
            if isinstance(self.raw.get(table), dict):
                entries = {name: one["value"] if isinstance(one, dict) and "value" in one else one
                           for name, one in self.raw[table].items()}
                return {name: one for name, one in _numbers(entries).items() if _of(name) not in entries}
        return _numbers({name: one for name, one in self.raw.items() if name != "tolerance"})

    @property
    def error(self) -> dict[str, Any]:
        """Estimated absolute errors by name; standard errors of fitted parameters."""
        if "error" in self.raw:  # averages have theirs beside them
            averages = self.raw.get("metrics")
            beside = _numbers(averages) if isinstance(averages, dict) else {}
            return self.raw["error"] | {_of(name): one for name, one in beside.items() if _of(name) in beside}
        fitted = self.raw.get("parameters")
        if not isinstance(fitted, dict):
            return {}
        return {name: one["standard_error"] for name, one in fitted.items() if "standard_error" in one}

    @property
    def units(self) -> dict[str, str]:
        """Units by name, of series and of single numbers, where they are known."""
        if self.verb == "fit":
            return {name: one.get("unit", "1") for name, one in self.raw.get("parameters", {}).items()}
        stated: dict[str, str] = self.raw.get("units", {})
        return stated | {name: unit for name in self.metrics if (unit := _rosin.unit_of(name, stated))}

    @property
    def notes(self) -> list[str]:
        """What is worth knowing of how the numbers came about."""
        said = re.findall(r"^note: (.*)$", self._messages, re.MULTILINE)
        return list(dict.fromkeys([*self.raw.get("notes", []), *said]))

    @cached_property
    def dataset(self) -> xarray.Dataset | None:
        """The plane or table, if there is one: coordinates, and variables with `units` and `long_name`; errors are
        the variables ``<name>_error``. ``dataset.to_netcdf("plane.nc")`` keeps it."""
        return tables.dataset(self)

    @cached_property
    def tables(self) -> dict[str, xarray.Dataset]:
        """Further tables by name: data and residuals of a fit, peaks of an experiment, events of a branch, …"""
        return tables.beside(self)

    def __getstate__(self) -> dict[str, Any]:  # its files may be gone where it arrives, as between processes
        self.dataset, self.tables
        return self.__dict__

    def __repr__(self) -> str:
        lines = [f"<rosin.Result of {self.verb}: {self.outcome}>"]
        for name, number in self.metrics.items():
            error = self.error.get(name)
            lines.append(f"  {name:<24} {number:.10g}" + (f" ± {error:.0e}" if isinstance(error, (int, float)) and error else "")
                         + (f" {self.units[name]}" if self.units.get(name, "1") != "1" else ""))
        return "\n".join(lines)


def _of(name: str) -> str:
    """What a number is the error of; empty where it is none."""
    return name.removesuffix("_error") if name.endswith("_error") else ""


def _numbers(entries: dict[str, Any]) -> dict[str, float]:
    return {name: one for name, one in entries.items() if isinstance(one, (int, float)) and not isinstance(one, bool)}
