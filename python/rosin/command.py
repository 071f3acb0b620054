"""Command lines, performed within this process."""

from __future__ import annotations

import re

from . import _rosin
from .errors import InputError


def perform(words: list[str], origin: str = "", text: str | None = None, progress: bool = False) -> tuple[bool, str, str, str]:
    """A command line as the command `rosin` performs it, within this process.

    Returns
    -------
    complete : bool
    output, messages : str
        What the command prints to standard output and to standard error.
    folder : str
        The results folder, where one was asked for.

    Raises
    ------
    InputError
    """
    words = ["rosin", *words]
    for given in words if text is None else [*words, text]:
        if "\0" in given:
            raise InputError(origin, f"{given[:200]!r} holds a zero byte")
        if not given.isprintable() and any("\ud800" <= letter <= "\udfff" for letter in given):
            raise InputError(origin, f"{given[:200]!r} holds half of a character (a surrogate)")
    if progress:
        from tqdm.auto import tqdm

        with tqdm(total=100, unit="%", bar_format="{l_bar}{bar}| {elapsed}<{remaining}") as bar:
            answer = _rosin.perform(words, text, lambda part: bar.update(round(100 * part) - bar.n))
            bar.update(100 - bar.n)
    else:
        answer = _rosin.perform(words, text)
    status, *streams, folder = answer
    output, messages, wrong = (stream.decode(errors="replace") for stream in streams)
    if status == 2:
        raise InputError(*_placed(wrong.strip().removeprefix("rosin: "), origin))
    return status == 0, output, messages, folder


def _placed(wrong: str, origin: str) -> tuple[str, str]:
    """The place that an error begins with, if it begins with one, and the rest."""
    place = rf"({re.escape(origin)}(?::\d+:\d+)?|--set .*?|[^\s:]+(?::\d+){{1,2}}): (.*)"
    found = re.fullmatch(place, wrong, re.DOTALL)
    return (found[1].removeprefix("--set "), found[2]) if found else ("", wrong)
