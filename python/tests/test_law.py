"""Laws as Python functions: the same motions as laws from text and in C++."""

import numpy
import pytest
import rosin


def spinodal():
    def exponent(psi, mu0, b, L, v0, c, t_heal, a):
        return (mu0 + b * numpy.log(c + psi / (L / (L + v0 * t_heal)))) / a

    def friction(v, psi, mu0, a, b, L, v0, c, t_heal):
        return a * rosin.asinh_exp(v / (2 * v0), exponent(psi, mu0, b, L, v0, c, t_heal, a))

    def slip_rate(mu, psi, mu0, a, b, L, v0, c, t_heal):
        return 2 * v0 * rosin.sinh_exp(mu / a, exponent(psi, mu0, b, L, v0, c, t_heal, a))

    return rosin.law(
        friction, slip_rate=slip_rate, rate=lambda v, psi, L, t_heal: (1 - psi) / t_heal - abs(v) * psi / L,
        steady=lambda v, L, t_heal: 1 / (1 + abs(v) * t_heal / L),
        parameters={"mu0": 0.369, "a": 0.0349, "b": 0.0489, "L": (0.9e-6, "m"), "v0": (1e-6, "m/s"), "c": 1e-3, "t_heal": (90, "s")},
        states={"psi": {"unit": "1", "scale": "log", "minimum": 1e-300, "maximum": 1}})


def test_a_law_with_a_state_moves_as_the_one_in_c():
    rest = {"oscillator": {"mass": 1, "stiffness": 1.09}, "drive": {"speed": 1e-5, "normal_load": 9.81e-4}}
    known = rosin.Scene({"law": {"type": "spinodal", "preset": "bristol-board"}, **rest}).cycle(tolerance=1e-9)
    own = rosin.Scene({"law": spinodal(), **rest}).cycle(tolerance=1e-9)
    assert own.metrics["period"] == pytest.approx(known.metrics["period"], rel=3e-9)
    assert own.raw["law"] == "formula"


def test_a_curve_with_rest_sticks_and_takes_other_values():
    def weakening(v, mu_s, mu_d, v_s):
        return mu_d + (mu_s - mu_d) * numpy.exp(-v / v_s)

    law = rosin.law(weakening, static_limit=lambda mu_s: mu_s, parameters={"mu_s": 0.4, "mu_d": 0.3, "v_s": (0.01, "m/s")})
    rest = {"oscillator": {"mass": 1, "stiffness": 100}, "drive": {"speed": 0.01, "normal_load": 10}}
    scene = rosin.Scene({"law": {**law, "mu_s": 0.45}, **rest})
    text = {"parameters": {"mu_s": {"default": 0.45}, "mu_d": {"default": 0.3}, "v_s": {"default": 0.01, "unit": "m/s"}},
            "friction": "mu_d + (mu_s - mu_d)*exp(-v/v_s)", "static_limit": "mu_s"}
    assert scene.cycle().metrics["period"] == rosin.Scene({"law": {"type": "formula", "formula": text}, **rest}).cycle().metrics["period"]


@pytest.mark.parametrize("function", [
    lambda a, b, c: a - (b - c), lambda a, b, c: a / (b / c), lambda a, b, c: a - b * -c, lambda a, b, c: (a + b) ** 2 * c,
    lambda a, b, c: -(a - b) - 2, lambda a, b, c: 2 / a ** -1, lambda a, b, c: -a ** 2, lambda a, b, c: (-a) ** 2, lambda a, b, c: a ** b ** c,
    lambda a, b, c: numpy.maximum(a, numpy.sqrt(b * c)) - numpy.sign(-a), lambda a, b, c: +a - -b - abs(b - c), lambda a, b, c: 1e-3 * a - (-2.5) * b])
def test_formulas_say_what_python_says(function):
    text = rosin.law(function, parameters={"a": 4, "b": 2, "c": 3})["formula"]["friction"]
    names = {"a": 4, "b": 2, "c": 3, "sqrt": numpy.sqrt, "sign": numpy.sign, "max": numpy.maximum, "abs": abs}
    assert eval(text.replace("^", "**"), names) == pytest.approx(function(4, 2, 3))


def test_long_laws_have_named_parts():
    def friction(v, a):
        x = v / (1 + a)
        for _ in range(8):
            x = x + x * numpy.exp(-x * x)
        return x

    formula = rosin.law(friction, parameters={"a": 1.0})["formula"]
    assert len(formula["define"]) > 2 and all(len(part) < 1000 for part in [formula["friction"], *formula["define"].values()])


@pytest.mark.parametrize("make, said", [
    (lambda: rosin.law(lambda v, mus: mus, parameters={"mu_s": 1}), "takes 'mus', which is none of v, N, mu, mu_s"),
    (lambda: rosin.law(lambda v: 1 if v > 0 else 2), "'v' is a symbol: a law has no branches"),
    (lambda: rosin.law(lambda v: numpy.cos(v)), "formulas have no numpy.cos; known here"),
    (lambda: rosin.law(lambda v: v, parameters={"a": "1 m"}), "where a number, \\(number, SI unit\\) or a table is taken"),
    (lambda: rosin.law(lambda v: v, stiction=lambda v: v), "is no part of a law; known here: after_stop"),
    (lambda: rosin.law(lambda v: __import__("math").exp(v)), "take numpy's functions")])
def test_what_no_formula_says_is_refused(make, said):
    with pytest.raises(rosin.InputError, match=said):
        make()
