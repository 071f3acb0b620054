"""Scenes, and the verbs of the command as their methods."""

from __future__ import annotations

import contextlib
import copy
import inspect
import keyword
import os
import re
import shutil
import tempfile
import tomllib
import warnings
import weakref
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

from . import _rosin, toml
from .command import perform
from .errors import IncompleteWarning, InputError
from .result import Result

NAME = "scene"  # what errors call a scene that stands in no file


class Scene:
    """A friction system and what is asked of it: tables and keys of a scene's file.

    It never changes: `set` returns another scene. Each verb of the command that takes a scene is a method, such as
    `run`, `stability`, `cycle`, `map`, `frf`; `help(rosin.Scene)` lists them with their options.

    Parameters
    ----------
    content : mapping
        Tables of the scene, such as ``{"law": {"type": "ageing"}, "drive": {"speed": "10 um/s"}}``. Files that it
        names are looked for in the working folder.
    """

    def __init__(self, content: Mapping[str, Any]) -> None:
        if not isinstance(content, Mapping):
            raise TypeError(f"a scene is made of a mapping, not of {type(content).__name__}; rosin.load reads a file")
        self._path: str | None = None
        self._text = toml.document(content)
        self._changes: tuple[str, ...] = ()
        self._document: dict[str, Any] = tomllib.loads(self._text)

    @classmethod
    def _load(cls, path: str | os.PathLike[str]) -> Scene:
        scene = cls.__new__(cls)
        scene._path = os.fspath(path)
        if scene._path.startswith("-"):  # which would be read as an option
            scene._path = "./" + scene._path
        try:
            scene._text = Path(path).read_text(encoding="utf-8-sig")  # editors of Windows begin with a mark
            scene._document = tomllib.loads(scene._text)
        except OSError as problem:
            raise InputError(scene._path, problem.strerror or str(problem)) from None
        except ValueError as problem:
            place = re.search(r"at line (\d+), column (\d+)", str(problem))
            where = f":{place[1]}:{place[2]}" if place else ""
            raise InputError(scene._path + where, f"not valid TOML: {problem}") from None
        scene._changes = ()
        return scene

    def set(self, path: str, value: Any) -> Scene:
        """The scene with one value changed, as ``--set path=value`` changes it.

        Parameters
        ----------
        path : str
            Keys with dots between them, ``"drive.speed"``; entries of lists are numbered from 1.
        value
            A boolean, a number (in SI units), a text (also a quantity with its unit, ``"10 um/s"``), a list or a
            mapping; an array, which an attribute ``units`` makes quantities, such as ``plane.dataset.normal_load[3]``.
        """
        if not isinstance(path, str):
            raise TypeError(f"a path is a text, such as 'drive.speed', not {type(path).__name__}")
        scene = copy.copy(self)
        written = toml.value(value, path)
        scene._document = copy.deepcopy(self._document)
        own = path if self._has(path) else _rosin.own_path(self.toml, path)
        keys = own.split(".")
        at: Any = scene._document
        for depth, key in enumerate(keys):
            last = depth == len(keys) - 1
            if isinstance(at, list):
                if not key.isascii() or not key.isdigit() or not 1 <= int(key) <= len(at):
                    raise InputError(path, f"{'.'.join(keys[:depth])} is a list of {len(at)}; an entry of it has a "
                                           f"number from 1, not '{key}'")
                index: Any = int(key) - 1
            elif isinstance(at, dict):
                if not key:
                    raise InputError(path, "a key of the path is empty")
                index = key
                if not last:
                    at.setdefault(key, {})
            else:
                raise InputError(path, f"{'.'.join(keys[:depth])} is {at!r}, not a table")
            if last:
                if isinstance(at, dict) and index not in at:  # what stands there under another program's name gives way
                    for other in [one for one in at if _rosin.own_path(self.toml, ".".join([*keys[:-1], one])) == own]:
                        del at[other]
                at[index] = tomllib.loads("value = " + written)["value"]
            else:
                at = at[index]
        scene._changes = (*self._changes, f"{path}={written}")
        return scene

    def _has(self, path: str) -> bool:
        try:
            self.get(path)
        except KeyError:
            return False
        return True

    def get(self, path: str) -> Any:
        """What the scene says at a path, as it stands there.

        Raises
        ------
        KeyError
            Where nothing stands, as for what is left to its default.
        """
        at: Any = self._document
        for key in path.split("."):
            try:
                at = at[int(key) - 1] if isinstance(at, list) and int(key) > 0 else at[key]
            except (KeyError, IndexError, TypeError, ValueError):
                raise KeyError(path) from None
        return copy.deepcopy(at)

    @property
    def toml(self) -> str:
        """The scene as a file of it would read."""
        return toml.document(self._document)

    def __repr__(self) -> str:
        return f"<rosin.Scene {self._document.get('title') or self._path or NAME}>"

    def _perform(self, words: list[str], out: str | os.PathLike[str] | None, progress: bool) -> Result:
        folder = Path(tempfile.mkdtemp(prefix="rosin-") if out is None else out)
        words = [*words, "--json", f"--out={folder}", *(f"--set={change}" for change in self._changes)]
        verb, target = words[0], self._path or NAME
        with contextlib.ExitStack() as undone:
            if out is None:
                undone.callback(shutil.rmtree, folder, ignore_errors=True)
            complete, output, messages, made = perform([*words, target], target, self._text, progress)
            result = Result(verb, complete, output, messages, Path(made).absolute())
            if out is None:
                weakref.finalize(result, undone.pop_all().close)
            else:
                result.dataset, result.tables  # now, as a later result may take the place of the files
        if not complete:
            warnings.warn(f"{verb} {target}: {result.outcome}" + (f": {result.detail}" if result.detail else ""),
                          IncompleteWarning, stacklevel=3)
        return result

    if TYPE_CHECKING:  # the methods are made below, from the command's own list

        def __getattr__(self, verb: str) -> Callable[..., Result]: ...


def load(path: str | os.PathLike[str]) -> Scene:
    """The scene of a file.

    Raises
    ------
    InputError
        If it cannot be read or is no TOML; `place` is its line. Whether it makes sense is found by the verb asked.
    """
    return Scene._load(path)


# Options that have another form here, or none: everything is quiet, results are documents, pictures are left out
# unless `pictures` is true.
_OWN = {"--help", "--set", "--json", "--quiet", "--out", "--no-pictures", "--explain"}


def _keyword(option: str) -> str:
    """The argument of an option: '--time-limit' is time_limit, '--from' is from_, as `from` is a word of Python."""
    name = option[2:].replace("-", "_")
    return name + "_" if keyword.iskeyword(name) else name


def _method(verb: dict[str, Any]) -> Callable[..., Result]:
    """The method of a verb: operands but the scene by position, options by keyword."""
    operands = [one for one in verb["arguments"] if one["name"] != "SCENE"]
    options = {_keyword(one["name"]): one for one in verb["options"] if one["name"] not in _OWN}
    draws = any(one["name"] == "--no-pictures" for one in verb["options"])

    kind = inspect.Parameter
    parameters = [kind("self", kind.POSITIONAL_ONLY)]
    parameters += [kind(one["name"].lower(), kind.POSITIONAL_OR_KEYWORD, annotation=str) for one in operands]
    types = {"": bool, "INT": int, "UINT": int, "FLOAT": float}
    for name, option in options.items():
        usual = None if option["value"] else False
        parameters.append(kind(name, kind.KEYWORD_ONLY, default=usual, annotation=types.get(option["value"], str)))
    parameters.append(kind("out", kind.KEYWORD_ONLY, default=None, annotation=str))
    if draws:
        parameters.append(kind("pictures", kind.KEYWORD_ONLY, default=False, annotation=bool))
    parameters.append(kind("progress", kind.KEYWORD_ONLY, default=False, annotation=bool))
    signature = inspect.Signature(parameters, return_annotation=Result)

    def method(*given: Any, **named: Any) -> Result:
        bound = signature.bind(*given, **named)
        bound.apply_defaults()
        asked = bound.arguments
        words = [verb["name"]]
        for one in operands:
            words.append(str(asked[one["name"].lower()]))
            if words[-1].startswith("-"):  # which would be read as an option
                raise InputError("", f"unknown {one['name'].lower()} '{words[-1]}'; known here: {one['help']}")
        for name, option in options.items():
            if asked[name] is True and not option["value"]:
                words.append(option["name"])
            elif asked[name] is not None and asked[name] is not False:
                words.append(f"{option['name']}={asked[name]}")
        if draws and not asked["pictures"]:
            words.append("--no-pictures")
        return asked["self"]._perform(words, asked["out"], asked["progress"])

    method.__name__ = verb["name"]
    method.__qualname__ = f"Scene.{verb['name']}"
    method.__signature__ = signature  # type: ignore[attr-defined]
    lines = [f"{verb['help'][0].upper()}{verb['help'][1:]}: ``rosin {verb['name']}``.", "", "Parameters", "----------"]
    for one in operands:
        lines += [one["name"].lower() + " : str", f"    {one['help']}"]
    for name, option in options.items():
        lines += [f"{name} : {types.get(option['value'], str).__name__}", f"    {option['help']}"]
    lines += ["out : path", "    folder that keeps all files; left out: a temporary one, gone with the result"]
    if draws:
        lines += ["pictures : bool", "    draw the command's own pictures into the folder"]
    lines += ["progress : bool", "    show a bar, by tqdm", "", "Returns", "-------", "Result", "", "Raises", "------",
              "InputError", "KeyboardInterrupt", "    Ctrl-C ends the work in order; a map in `out` goes on from there."]
    method.__doc__ = "\n".join(lines)
    return method


for _verb in _rosin.verbs():
    if any(one["name"] == "SCENE" for one in _verb["arguments"]):
        setattr(Scene, _verb["name"], _method(_verb))
