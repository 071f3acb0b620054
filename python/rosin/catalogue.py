"""Cards of the friction laws, and of the normal laws."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from .command import perform


@dataclass(frozen=True)
class Parameter:
    """A number of a law, in its SI unit, with the range that is accepted."""

    name: str
    unit: str
    default: Any
    minimum: float | None
    maximum: float | None
    meaning: str


@dataclass(frozen=True)
class State:
    """What a law remembers."""

    name: str
    unit: str
    meaning: str


@dataclass(frozen=True)
class Preset:
    """Published values of a law's parameters."""

    name: str
    source: str
    values: dict[str, Any]


@dataclass(frozen=True)
class Law:
    """A friction law, ``scene.set("law", {"type": law.name})``, or a normal law."""

    name: str
    title: str
    formula: str
    source: str
    limits: str
    parameters: tuple[Parameter, ...]
    states: tuple[State, ...]
    presets: tuple[Preset, ...]
    raw: dict[str, Any] = field(repr=False)


def laws() -> list[Law]:
    """All friction laws of the catalogue, as ``rosin laws`` lists them."""
    return _cards("friction")


def normal_laws() -> list[Law]:
    """All laws of ``normal_contact``; units follow from exponents, and a default of None must be given."""
    return _cards("normal")


def _cards(kind: str) -> list[Law]:
    _, output, *_ = perform(["laws", "--json"])
    return [
        Law(
            **{key: card[key] for key in ("name", "title", "formula", "source", "limits")},
            parameters=tuple(Parameter(**one) for one in card["parameters"]),
            states=tuple(State(**one) for one in card["states"]),
            presets=tuple(Preset(**one) for one in card["presets"]),
            raw=card,
        )
        for card in json.loads(output)
        if card["kind"] == kind
    ]
