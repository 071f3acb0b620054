"""Values and scenes written as TOML, so that they are read exactly as a scene's file is."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from typing import Any

from .errors import InputError


def key(name: str) -> str:
    """The name as it stands before an equals sign."""
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else text(name)


def text(words: str) -> str:
    """Between quotes. TOML has the escapes of JSON, which leaves one control character as it is."""
    return json.dumps(words, ensure_ascii=False).replace("\x7f", "\\u007F")


def value(given: Any, path: str) -> str:
    """Any value on one line; numbers read back the same.

    Raises
    ------
    InputError
        For what is no boolean, number, text, list or mapping; `path` is its place.
    """
    if path.count(".") > 100:
        raise InputError(path[:60] + "…", "lies more than 100 levels deep")
    if hasattr(given, "__array__"):  # of numpy, xarray, pandas
        given = _listed(given)
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, (int, float)):
        return repr(given)
    if isinstance(given, str):
        return text(given)
    if isinstance(given, Mapping):
        inner = (f"{key(str(name))} = {value(one, f'{path}.{name}')}" for name, one in given.items())
        return "{ " + ", ".join(inner) + " }"
    if isinstance(given, os.PathLike):
        return text(os.fspath(given))
    if isinstance(given, (list, tuple, range)):
        return "[" + ", ".join(value(one, f"{path}.{i}") for i, one in enumerate(given, 1)) + "]"
    raise InputError(path, f"{given!r} is {type(given).__name__}; a scene holds booleans, numbers, texts, lists and "
                           "mappings")


def _listed(array: Any) -> Any:
    """An array as numbers, lists and texts; as quantities where it says its unit, as what rosin returns does."""
    import numpy

    plain = numpy.asarray(array).tolist()
    unit = getattr(array, "attrs", {}).get("units", "1")
    return plain if unit == "1" else _with_unit(plain, unit)


def _with_unit(plain: Any, unit: str) -> Any:
    if isinstance(plain, list):
        return [_with_unit(one, unit) for one in plain]
    return f"{plain!r} {unit}"


def document(content: Mapping[str, Any]) -> str:
    """A scene: values first, then a section for each table, whose own tables stand on one line."""
    values, sections = [], []
    for name, given in content.items():
        if isinstance(given, Mapping):
            lines = [f"{key(str(inner))} = {value(one, f'{name}.{inner}')}" for inner, one in given.items()]
            sections.append("\n".join([f"[{key(str(name))}]", *lines]) + "\n")
        else:
            values.append(f"{key(str(name))} = {value(given, str(name))}\n")
    return "\n".join(["".join(values), *sections] if values else sections)
