"""Friction laws as Python functions: called once with symbols, they become the formulas of a law from text."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

from .errors import InputError

_LONGEST = 200  # characters of a part that has no name of its own
_UFUNCS = {"exp": "exp", "log": "ln", "log10": "log10", "sinh": "sinh", "cosh": "cosh", "tanh": "tanh", "arcsinh": "asinh", "sqrt": "sqrt",
           "absolute": "abs", "fabs": "abs", "sign": "sign", "minimum": "min", "maximum": "max", "fmin": "min", "fmax": "max"}
_OPERATORS = {"add": "+", "subtract": "-", "multiply": "*", "divide": "/", "true_divide": "/", "power": "^", "float_power": "^"}


def law(friction: Callable[..., Any], *, parameters: Mapping[str, Any] | None = None, states: Mapping[str, Any] | None = None,
        title: str | None = None, **parts: Any) -> dict[str, Any]:
    """A `[law]` of a scene out of Python functions.

    Each function is called once, with symbols for what its arguments name: the slip rate `v`, the load `N`, the coefficient `mu` (of a
    `slip_rate`), states and parameters. Arithmetic, abs, and numpy's exp, log, log10, sinh, cosh, tanh, arcsinh, sqrt, sign, minimum and
    maximum are understood; what comes out is compiled, with derivatives and units, like any law from text: a motion costs what it costs
    under a law in C++, and Python is not called again.

    Parameters
    ----------
    friction : callable
        Coefficient of friction, positive along `v`.
    parameters : mapping, optional
        Of each name its default: a number (dimensionless), a pair of number and SI unit, or the table of `law.formula.parameters`.
    states : mapping, optional
        Of each name its SI unit, or the table of `law.formula.states`.
    title : str, optional
        A line for pictures and reports; left out: the name of the function.
    **parts
        `static_limit` and `slip_rate`, functions; `rate`, `steady`, `after_stop`, `rest`, `size` and `kink`, functions that return a
        mapping by state, or one value where there is one state.

    Returns
    -------
    dict
        ``rosin.Scene({"law": rosin.law(...), ...})``; values of parameters go beside it, as in ``{**law, "mu_s": 0.5}``.

    Raises
    ------
    InputError
        For an argument that is no name of the law, for a branch over a symbol, and for a function that formulas have not.
    """
    given = {name: _entry(name, value, "default") for name, value in (parameters or {}).items()}
    own = {name: _entry(name, value, "unit") for name, value in (states or {}).items()}
    parser = _Tracer(["v", "N", "mu", *given, *own])
    formula: dict[str, Any] = {"title": title or friction.__name__.replace("_", " ").replace("<lambda>", "law from Python"),
                               "friction": parser.text(friction)}
    known = {"static_limit", "slip_rate", "kink"}, {"rate", "steady", "after_stop", "rest", "size"}
    for name, part in parts.items():
        if name in known[0]:
            formula[name] = parser.text(part)
        elif name in known[1]:
            formula[name] = parser.texts(part, list(own))
        else:
            raise InputError(name, f"is no part of a law; known here: {', '.join(sorted(known[0] | known[1]))}")
    for key, table in (("parameters", given), ("states", own), ("define", parser.parts)):
        if table:
            formula[key] = table
    return {"type": "formula", "formula": formula}


def _entry(name: str, value: Any, key: str) -> dict[str, Any]:
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, tuple) and len(value) == 2 and key == "default":
        return {"default": value[0], "unit": value[1]}
    if isinstance(value, str) == (key == "unit"):
        return {key: value}
    raise InputError(name, f"is {value!r}, where a number, (number, SI unit) or a table is taken" if key == "default"
                     else f"is {value!r}, where an SI unit or a table is taken")


class _Tracer:
    def __init__(self, names: list[str]) -> None:
        self.names, self.parts = names, dict[str, str]()

    def value(self, function: Any) -> Any:
        if not callable(function):
            return function
        arguments = list(inspect.signature(function).parameters)
        for name in arguments:
            if name not in self.names:
                raise InputError(getattr(function, "__name__", "law"), f"takes '{name}', which is none of {', '.join(self.names)}")
        return function(*(_Symbol(self, name, 9) for name in arguments))

    def text(self, function: Any) -> str:
        return self.operand(self.value(function))[0]

    def texts(self, function: Any, states: list[str]) -> dict[str, str]:
        values = self.value(function)
        if not isinstance(values, Mapping):
            if len(states) != 1:
                raise InputError(getattr(function, "__name__", "law"), f"has a value for each of {', '.join(states) or 'no states'}, by its name")
            values = {states[0]: values}
        return {name: self.operand(self.value(value))[0] for name, value in values.items()}

    def operand(self, value: Any) -> tuple[str, int]:
        """Text of a value and how strongly it binds."""
        if isinstance(value, _Symbol):
            return value.text, value.binds
        if isinstance(value, str):  # a formula, or a number with a unit
            return f"({value})", 9
        try:
            number = float(value)
        except (TypeError, ValueError):
            raise InputError("", f"a formula is made of numbers and symbols, not of {value!r}") from None
        return repr(number).removesuffix(".0"), 9 if number >= 0 else 0

    def made(self, text: str, binds: int) -> _Symbol:
        if len(text) > _LONGEST:  # is named, so that what is used twice stands once
            known = [name for name, part in self.parts.items() if part == text]
            name = known[0] if known else f"part_{len(self.parts) + 1}"
            self.parts[name] = text
            return _Symbol(self, name, 9)
        return _Symbol(self, text, binds)


class _Symbol:
    """A part of a formula; `binds`: 1 of a sum, 2 of a product, 3 of a power, 9 of what needs no parentheses."""

    __array_priority__ = 1000

    def __init__(self, tracer: _Tracer, text: str, binds: int) -> None:
        self.tracer, self.text, self.binds = tracer, text, binds

    def _with(self, sign: str, left: Any, right: Any) -> _Symbol:
        binds = {"+": 1, "-": 1, "*": 2, "/": 2, "^": 3}[sign]
        (a, first), (b, second) = self.tracer.operand(left), self.tracer.operand(right)
        a = a if first >= binds + (sign == "^") else f"({a})"
        b = b if second >= binds + 1 else f"({b})"
        return self.tracer.made(f"{a}{sign}{b}" if sign == "^" else f"{a} {sign} {b}", binds)

    def _function(self, name: str, *values: Any) -> _Symbol:
        return self.tracer.made(f"{name}({', '.join(self.tracer.operand(value)[0] for value in values)})", 9)

    def __add__(self, other: Any) -> _Symbol: return self._with("+", self, other)
    def __radd__(self, other: Any) -> _Symbol: return self._with("+", other, self)
    def __sub__(self, other: Any) -> _Symbol: return self._with("-", self, other)
    def __rsub__(self, other: Any) -> _Symbol: return self._with("-", other, self)
    def __mul__(self, other: Any) -> _Symbol: return self._with("*", self, other)
    def __rmul__(self, other: Any) -> _Symbol: return self._with("*", other, self)
    def __truediv__(self, other: Any) -> _Symbol: return self._with("/", self, other)
    def __rtruediv__(self, other: Any) -> _Symbol: return self._with("/", other, self)
    def __pow__(self, other: Any) -> _Symbol: return self._with("^", self, other)
    def __rpow__(self, other: Any) -> _Symbol: return self._with("^", other, self)
    def __neg__(self) -> _Symbol: return self._with("-", 0, self) if self.binds < 2 else self.tracer.made(f"-{self.text}", 1)
    def __pos__(self) -> _Symbol: return self
    def __abs__(self) -> _Symbol: return self._function("abs", self)

    def __array_ufunc__(self, ufunc: Any, method: str, *values: Any, **options: Any) -> _Symbol:
        name = ufunc.__name__
        if method == "__call__" and name in _UFUNCS:
            return self._function(_UFUNCS[name], *values)
        if method == "__call__" and name in _OPERATORS:
            return self._with(_OPERATORS[name], *values)
        if method == "__call__" and name == "negative":
            return -self
        if method == "__call__" and name == "square":
            return self**2
        raise InputError("", f"formulas have no numpy.{name}; known here: numpy.{', numpy.'.join(sorted(set(_UFUNCS)))}")

    def _no_branch(self, *_: Any) -> Any:
        raise InputError("", f"'{self.text}' is a symbol: a law has no branches; numpy.sign, minimum and maximum, or a static_limit, say where it changes")

    __bool__ = __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = _no_branch  # type: ignore[assignment]
    __hash__ = object.__hash__

    def __float__(self) -> float:
        raise InputError("", f"'{self.text}' is a symbol: take numpy's functions in place of those of math")


def asinh_exp(x: Any, exponent: Any) -> Any:
    """asinh(x·e^exponent) without overflow, for laws whose friction is a logarithm of the slip rate and smooth through 0."""
    return _of_either("asinh_exp", x, exponent)


def sinh_exp(x: Any, exponent: Any) -> Any:
    """e^−exponent · sinh x, the inverse of `asinh_exp` in x."""
    return _of_either("sinh_exp", x, exponent)


def _of_either(name: str, x: Any, exponent: Any) -> Any:
    for value in (x, exponent):
        if isinstance(value, _Symbol):
            return value._function(name, x, exponent)
    raise InputError("", f"{name} is taken of the symbols of a law")
