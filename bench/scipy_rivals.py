"""SciPy's Radau and LSODA on the slider's cycle and the fault's history, as the other rivals are applied.

Reads a job as JSON from the file named first, writes the results as JSON to the file named second.
"""
import json
import math
import platform
import sys
import time
import warnings

import numpy
import scipy
from scipy.integrate import LSODA, Radau
from scipy.optimize import brentq

warnings.simplefilter("ignore")
MU0, A, B, L, V0, C, T_HEAL = 0.369, 0.0349, 0.0489, 0.9e-6, 1e-6, 1e-3, 90.0
M, K, V = 1.0, 1.09, 1e-5
PSI_REF = L / (L + V0 * T_HEAL)
MOST_PASSAGES, DIED_OUT = 200, 1e-4
NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(4)
NODES, WEIGHTS = 0.5 + 0.5 * NODES, 0.5 * WEIGHTS


def exponent(psi):
    return (MU0 + B * math.log(C + psi / PSI_REF)) / A


def friction(v, psi):
    return A * math.asinh(v / (2 * V0) * math.exp(exponent(psi)))


def steady_friction(v):
    return friction(v, L / (L + abs(v) * T_HEAL))


class Failure(Exception):
    pass


def cycle(method, N, lam, tolerance, deadline):
    """Period, stick fraction and loop area of the motion that starts near stick."""

    def rate(t, y):
        x, v, psi = y
        try:
            mu = friction(v, psi)
        except ValueError:  # a trial step beyond the range of the logarithm
            mu = math.nan
        return [V - v, (K * x - N * mu) / M, ((1 - psi) / T_HEAL - abs(v) * psi / L) / lam]

    def jacobian(t, y):
        x, v, psi = y
        try:
            root = math.hypot(v, 2 * V0 * math.exp(-exponent(psi)))
        except ValueError:
            root = math.nan
        return numpy.array([[0, -1, 0],
                            [K / M, -N * A / root / M, -N * v / root * B / (C * PSI_REF + psi) / M],
                            [0, -math.copysign(psi / L, v) / lam, (-1 / T_HEAL - abs(v) / L) / lam]])

    longest = 10 * (2 * math.pi * math.sqrt(M / K) + N / (K * V))
    start = [N * steady_friction(V) / K, 1e-3 * V, L / (L + V * T_HEAL)]
    scale = numpy.array([N * A / K, V, C * PSI_REF])
    # SciPy refuses relative tolerances below 100 eps with a warning and uses that.
    solver = method(rate, 0.0, start, math.inf, rtol=tolerance, atol=tolerance * scale, jac=jacobian, max_step=longest)
    agree = tolerance * (10 if method is LSODA else 1)  # multistep return maps are noisy
    passages, began, last, amplitude, measuring = 0, 0.0, [0.0, 0.0, 0.0], 0.0, False
    stick = loop = 0.0
    result = {"period": 0, "stick_fraction": 0, "loop_area": 0, "steady": False, "passages": 0, "failure": ""}

    def measure(dense, t0, t1, step):
        nonlocal stick, loop
        h = t1 - t0
        if not h > 0:
            return
        d = 1e-3 * step
        for s, w in zip(NODES, WEIGHTS):
            t = t0 + s * h
            y = dense(t)
            v_rate = (8 * (dense(t + d)[1] - dense(t - d)[1]) - (dense(t + 2 * d)[1] - dense(t - 2 * d)[1])) / (12 * d)
            loop += w * h * (friction(y[1], y[2]) - steady_friction(y[1])) * v_rate
        marks = [t0] + list(t0 + NODES * h) + [t1]
        speeds = [dense(t)[1] for t in marks]
        for a, b, va, vb in zip(marks, marks[1:], speeds, speeds[1:]):
            cuts = [a]
            for level in (0.1 * V, -0.1 * V):
                if (va > level) != (vb > level):
                    cuts.append(brentq(lambda s: dense(s)[1] - level, a, b, xtol=1e-300, rtol=1e-15))
            cuts = sorted(cuts) + [b]
            for c, e in zip(cuts, cuts[1:]):
                if abs(dense(0.5 * (c + e))[1]) <= 0.1 * V:
                    stick += e - c

    while True:
        if time.process_time() > deadline:
            raise Failure("time limit of a problem")
        before, t0 = solver.y[1], solver.t
        message = solver.step()
        if solver.status == "failed":
            raise Failure(message or "failed")
        v, t1 = solver.y[1], solver.t
        if not math.isfinite(v):
            raise Failure("not finite")
        if not t1 > t0:
            raise Failure("steps of length zero")
        amplitude = max(amplitude, abs(v / V - 1))
        passed = before < V <= v
        dense = solver.dense_output() if passed or measuring else None
        at = brentq(lambda s: dense(s)[1] - V, t0, t1, xtol=1e-300, rtol=1e-15) if passed else t1
        if measuring:
            measure(dense, t0, at, t1 - t0)
        if passed:
            period, passages = at - began, passages + 1
            if measuring:
                result.update(period=period, stick_fraction=stick / period, loop_area=abs(loop), passages=passages)
                return result
            x, _, psi = dense(at)
            sizes = [period, max(abs(x), V * math.sqrt(M / K)), 10 * psi]
            changes = [abs(a - b) for a, b in zip([period, x, psi], last)]
            if passages > 1 and amplitude < DIED_OUT:
                result.update(steady=True, passages=passages)
                return result
            if passages > 2 and all(c <= agree * s for c, s in zip(changes, sizes)):
                measuring = True
                measure(dense, at, t1, t1 - t0)
            elif passages >= MOST_PASSAGES:
                raise Failure("not settled in 200 passages")
            last, began, amplitude = [period, x, psi], at, 0.0
        elif t1 - began > longest:
            if amplitude < DIED_OUT or abs(v / V - 1) < DIED_OUT:
                result.update(steady=True, passages=passages)
                return result
            raise Failure("no passage through v = V")


def fault(method, duration, tolerance, deadline):
    """ln v at the end of QDYN's stick-slip case, per unit area, in (ln v, ln theta)."""
    k, c, N, a, b, length, drive = 2e9, 2e10 / 6000, 5e6, 0.01, 0.025, 1e-5, 1e-6

    def rate(t, y):
        try:
            v, theta = math.exp(y[0]), math.exp(y[1])
            ageing = 1 / theta - v / length
            return [(k * (drive - v) - b * N * ageing) / (a * N + c * v), ageing]
        except (OverflowError, ZeroDivisionError):
            return [math.nan, math.nan]

    def jacobian(t, y):
        v, theta = math.exp(y[0]), math.exp(y[1])
        d, growth = a * N + c * v, rate(t, y)[0]
        by_v, by_theta = -v / length, -1 / theta
        return numpy.array([[(-k * v - b * N * by_v - growth * c * v) / d, -b * N * by_theta / d], [by_v, by_theta]])

    solver = method(rate, 0.0, [math.log(0.9e-6), math.log(10.0)], duration, rtol=tolerance, atol=tolerance, jac=jacobian)
    while solver.status == "running":
        if time.process_time() > deadline:
            raise Failure("time limit of a problem")
        message = solver.step()
        if solver.status == "failed":
            raise Failure(message or "failed")
    if not math.isfinite(solver.y[0]):
        raise Failure("not finite")
    return {"log_slip_rate": solver.y[0], "failure": ""}


def main():
    with open(sys.argv[1]) as file:
        job = json.load(file)
    method = {"Radau": Radau, "LSODA": LSODA}[job["method"]]
    rows = []
    spent, last, growth = 0.0, 0.0, 1.0
    for tolerance in job["tolerances"]:
        if spent + last * growth > job["limit"]:
            break
        row = {"tolerance": tolerance, "problems": []}
        rows.append(row)
        begin = time.process_time()
        for problem in job["problems"]:
            if time.process_time() - begin > job["limit"]:
                break
            best = math.inf
            for _ in range(job["repetitions"]):
                t0 = time.process_time()
                try:
                    if job["kind"] == "fault":
                        answer = fault(method, problem["duration"], tolerance, t0 + job["limit"])
                    else:
                        answer = cycle(method, *problem, tolerance, t0 + job["limit"] / 15)
                except Failure as failure:
                    answer = {"failure": str(failure)}
                except Exception as failure:
                    answer = {"failure": type(failure).__name__ + ": " + str(failure)}
                best = min(best, time.process_time() - t0)
            answer["seconds"] = best
            row["problems"].append(answer)
        seconds = sum(answer["seconds"] for answer in row["problems"])
        spent, growth, last = spent + seconds, max(1.0, seconds / last) if last else 1.5, seconds
    with open(sys.argv[2], "w") as file:
        json.dump({"rows": rows, "scipy": scipy.__version__, "numpy": numpy.__version__,
                   "python": platform.python_version()}, file)


main()
