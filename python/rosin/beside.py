"""Numbers of rosin beside printed ones, as a table."""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass

from .errors import InputError

NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"


def with_error(value: float, error: float) -> str:
    """The value to the digit that its error leaves, and the error: "12.00103129 ± 2e-08"."""
    if not math.isfinite(value):
        return f"{value:.6g}"
    if not math.isfinite(error):
        return f"{value:.6g}, of unknown error"
    if error <= 0:
        return f"{value:.10g}"
    of_error = math.floor(math.log10(error))
    of_value = math.floor(math.log10(abs(value))) if value else of_error
    places = min(max(of_value - of_error, 0), 13)
    size = f"{error:.0e}" if of_error < -3 or of_error > 3 else f"{round(error, -of_error):.{max(-of_error, 0)}f}"
    if -5 < of_value < 7:
        return f"{value:.{max(min(-of_error, 13 - of_value), 0)}f} ± {size}"
    return f"{value:.{places}e} ± {size}"


@dataclass(frozen=True)
class Printed:
    """A number that somebody printed: one, "0.09 ± 0.01", or a range, "10 … 11". Its last digit is uncertain by half.
    What is no text is exact.
    """

    text: str
    low: float
    high: float
    accuracy: float

    @classmethod
    def read(cls, given: str | float) -> Printed:
        if not isinstance(given, str):
            return cls(f"{given:.10g}", given, given, 0.0)
        text = given.replace("−", "-")
        found = re.fullmatch(rf"\s*({NUMBER})\s*(?:(±|…)\s*({NUMBER}))?\s*", text)
        if not found:
            raise InputError("", f"printed number '{given}': one number, 'number ± error', or 'number … number'")
        low = high = float(found[1])
        accuracy = _half_a_digit(found[1])
        if found[2] == "±":
            accuracy = float(found[3])
        elif found[2] == "…":
            high = float(found[3])
            accuracy = max(accuracy, _half_a_digit(found[3]))
        return cls(given, low, high, accuracy)

    def difference(self, value: float) -> float:
        """From the number, or from the nearer end of the range; 0 within it."""
        return value - min(max(value, self.low), self.high)


def _half_a_digit(text: str) -> float:
    digits, _, exponent = text.lower().partition("e")
    places = len(digits.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - places)


class Beside:
    """A table: what, printed, found with its error, and the difference with the error of both."""

    def __init__(self, rows: list[tuple[str, str, str, str]], against: str) -> None:
        self.rows = rows
        self.header = "quantity", against, "rosin", "difference"

    def __repr__(self) -> str:
        lines = [self.header, *self.rows]
        widths = [max(len(line[column]) for line in lines) for column in range(4)]
        return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)

    def _repr_html_(self) -> str:
        def row(cells: Iterable[str], tag: str) -> str:
            return "<tr>" + "".join(f"<{tag}>{html.escape(cell)}</{tag}>" for cell in cells) + "</tr>"

        return "<table>\n" + "\n".join([row(self.header, "th"), *(row(one, "td") for one in self.rows)]) + "\n</table>"


def beside(rows: Iterable[tuple[str, str | float, float, float | None]], against: str = "printed") -> Beside:
    """Printed numbers and those of rosin as a table.

    Parameters
    ----------
    rows : iterable of (what, printed, found, error)
        `what` names the quantity with its unit. `printed` is a text such as ``"12"``, ``"0.09 ± 0.01"`` or
        ``"10 … 11"``: half of its last digit counts as its error where none is said. A number in its place is exact.
        `error` is that of `found`; None where it is not known.
    against : str
        What stands above the numbers of others.

    Returns
    -------
    Beside
        Shown as a table by notebooks, and by ``print`` as text.
    """
    lines = []
    for what, printed, found, error in rows:
        found, error = float(found), math.nan if error is None else float(error)
        other = Printed.read(printed)
        difference = with_error(other.difference(found), other.accuracy + error)
        lines.append((what, other.text, with_error(found, error), difference))
    return Beside(lines, against)
