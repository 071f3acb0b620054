#!/usr/bin/env python3
"""What a picture is drawn from, in a few numbers: digest.py FILE NAME, where FILE is a picture in a folder of results.

Prints a line for each column of each table that the picture's script for gnuplot names: picture, table, column, how many numbers,
the least, the mean and the largest of them to four digits. Columns that hold nothing but rounding error have no line.
"""

import csv
import math
import re
import sys
from pathlib import Path

ROUNDING = 1e-12  # SI


def columns(table: Path) -> dict[str, list[float]]:
    """Finite numbers of each column; lines between blocks of gnuplot are left out."""
    with open(table, encoding="utf-8", newline="") as file:
        names, *rows = csv.reader(file)
    twice = {name for name in names if names.count(name) > 1}
    if twice:
        sys.exit(f"{table}: more than one column is called {', '.join(sorted(twice))}")
    found: dict[str, list[float]] = {name: [] for name in names}
    for row in rows:
        for name, cell in zip(names, row):
            try:
                value = float(cell)
            except ValueError:
                continue
            if math.isfinite(value):
                found[name].append(value)
    return found


def digest(picture: Path, name: str) -> list[str]:
    script = picture.with_suffix(".gp").read_text(encoding="utf-8")
    lines = []
    for table in sorted(set(re.findall(r"'([\w-]+\.csv)'", script))):
        if not (picture.parent / table).exists():
            continue  # the title of a panel, which names a measured table
        for column, numbers in columns(picture.parent / table).items():
            if any(abs(number) > ROUNDING for number in numbers):
                least, mean, largest = min(numbers), math.fsum(numbers) / len(numbers), max(numbers)
                lines.append(f"{name}\t{table}\t{column}\t{len(numbers)}\t{least:.4g}\t{mean:.4g}\t{largest:.4g}")
    return lines


if __name__ == "__main__":
    print("\n".join(digest(Path(sys.argv[1]), sys.argv[2])))
