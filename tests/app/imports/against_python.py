"""Random scripts for rsfmodel, run by Python and NumPy and read by app/imports/python.py: what the reader gives is what Python
has, or is refused.
"""
import copy
import importlib.util
import pathlib
import random
import sys
import types

import numpy as np

spec = importlib.util.spec_from_file_location("reader", pathlib.Path(sys.argv[1]))
reader = importlib.util.module_from_spec(spec)
spec.loader.exec_module(reader)

HEAD = """import copy
import numpy as np
from rsfmodel import rsf, staterelations
from lab import configure, keep
model = rsf.Model()
model.mu0 = 0.6
model.a = 0.005
model.k = 1e-3
model.vref = 1.0
state1 = staterelations.DieterichState()
state1.b = 0.01
state1.Dc = 10.0
model.state_relations = [state1]
x = 3
y = 0.5
model.time = np.arange(0, 4, 0.5)
lp = np.ones_like(model.time)
"""
PIECES = [
    "x = x + 1", "y = 2 * y - x", "x = y ** 2 / 3", "x = -x // 2", "x, y = y, x", "y = x % 3", "x += 1", "x *= y", "y = abs(-x)",
    "model.a = 0.004 + 0.001 * y * 0", "model.k = y", "state1.b = 0.02", "model.mu0 = x", "m = model", "m.a = 0.007", "s = state1",
    "s.Dc = 7.0", "state1.b += 0.01", "model.a *= 2", "lp[4:] = 10.", "lp[2] = 5", "lp[::2] = 3.0", "lp[model.time > 2] = 4.",
    "lp[(model.time > 1) & (model.time < 3)] = 6.", "lp[~(model.time > 2)] = 8.", "lp[np.where(model.time > 2)] = 3.0",
    "lp[[0, 1]] = 2.", "lp.fill(2.0)", "np.copyto(lp, 3.0)", "np.multiply(lp, 2, out=lp)", "np.add(lp, 1, lp)", "v = lp", "v[1] = 9.",
    "v = lp[1:4]", "v[:] = 7.", "lp = lp + 1", "lp += 1", "lp = 2 * lp - y", "lp = np.array([1.] * 4 + [10.] * 4)", "lp = lp.copy()",
    "model.loadpoint_velocity = lp", "model.loadpoint_velocity[3] = 2.", "model.time = 2 * model.time", "lp = -lp",
    "lp = np.concatenate([lp[:4], lp[4:]])", "lp = np.concatenate((np.ones(4), 3. * np.ones(4)))", "lp = np.full(8, 2)", "lp[1] = 2.5",
    "lp = np.linspace(1, 2, 8)", "lp = np.zeros_like(model.time)", "lp = np.ones(8, dtype=int)", "lp = np.arange(8)",
    "for s in [state1]: s.b = 0.03", "for i in range(3): x = i", "if x > 2: model.a = 0.008", "while False: model.a = 1",
    "for i in range(4): lp[i] = i", "[setattr(q, 'b', 0.04) for q in [state1]]", "list(map(lambda q: setattr(q, 'b', 0.05), [state1]))",
    "setattr(model, 'a', 0.006)", "model.__setattr__('a', 0.0061)", "model.__dict__['a'] = 0.0062", "vars(model)['a'] = 0.0063",
    "configure(model)", "configure(state1)", "configure([model])", "f = configure", "g = [configure]", "g[0](model)", "keep(configure)(model)",
    "exec('model.a = 0.0064')", "globals()['x'] = 17", "eval('configure(model)')", "import other_script", "del y; y = 0.25",
    "d = {'q': model}", "d['q'].a = 0.0065", "q = (model, state1)", "q[0].a = 0.0066", "q = [state1]", "q[0].b = 0.06", "q.append(state1)",
    "model.state_relations.append(state1)", "model.state_relations = [state1, state1]", "model.state_relations.pop(); model.state_relations = [state1]",
    "with keep(model) as w: w.a = 0.0067", "try:\n    model.a = 0.0068\nexcept Exception: pass", "model = copy.copy(model)",
    "z = copy.deepcopy(model); z.a = 0.0069", "print(model.a, x)", "t = (x := 5)", "(model).a = 0.0071", "x = len(lp)", "x = lp.size",
    "x = lp[-1]", "x = float(lp[2])", "x = int(y)", "y = round(x)", "x = True + 1", "x = x if x else 2", "x = x and 3", "x = 0 or y",
    "x = 1 < 2 < 3", "a = b = y", "model.a, model.k = 0.0072, 0.002", "def change():\n    model.a = 0.0073", "change()", "h = change", "h()",
    "def setx():\n    global x\n    x = 99", "setx()", "keep(setx)()", "class Own:\n    a = configure(model)", "def dflt(q=configure(state1)): pass",
    "x = [1, 2, 3][1]", "x = (1, 2)[0]", "x = 'abc'", "y = 1j", "x = 1e3", "x = 2 ** 10", "x = 2 ** -1", "x = 7 // 2.", "x = -7 % 3", "x = ~x",
    "x = not x", "x = 5 ^ 3", "x = 5 & 3", "x = 1 << 3", "model.b = 3", "from lab import *", "raise SystemExit", "exit()",
    "assert configure(model) is None", "@keep\ndef deco(): model.a = 0.0074", "deco()", "x: float = 4", "if True:\n    def late():\n        model.a = 0.0075", "late()",
    "r = range(3)", "n = None", "import numpy", "x = numpy.pi if False else 1", "lp = np.asarray(lp)", "w = np.asarray(lp); w[0] = 11.", "w = lp.T; w[0] = 12.",
    "w = lp.reshape(8); w[0] = 13.", "w = model.time; w[0] = -1.", "lp.sort()", "sorted([state1], key=configure)", "max([state1], key=configure)",
    "model.solve()", "x = model.solve()", "l = [model] * 2; l[1].a = 0.0076", "k = lambda: configure(model)", "k()", "model.time.flags.writeable = True",
]


RUNS = []  # models, as they were when they were solved


def modules():
    class Thing:
        pass

    class Model(Thing):
        def solve(self):
            RUNS.append((self, snapshot(self)))

    class DieterichState(Thing):
        pass

    def configure(thing):
        things = thing if isinstance(thing, list) else [thing]
        for one in things:
            if isinstance(one, Model):
                one.a = 0.1234
            elif isinstance(one, DieterichState):
                one.b = 0.4321
        return None

    class Keep:
        def __init__(self, what):
            self.what = what

        def __call__(self, *given):
            return self.what(*given)

        def __enter__(self):
            return self.what

        def __exit__(self, *_):
            return False

    made = {name: types.ModuleType(name) for name in ("rsfmodel", "lab", "other_script")}
    made["rsfmodel"].rsf = types.SimpleNamespace(Model=Model)
    made["rsfmodel"].staterelations = types.SimpleNamespace(DieterichState=DieterichState)
    made["lab"].configure, made["lab"].keep, made["lab"].x, made["lab"].y = configure, Keep, 77, 78
    return made


def plain(value):
    if isinstance(value, np.ndarray):
        return [float(x.real) for x in value]
    if isinstance(value, (bool, int, float, np.number, np.bool_)):
        return float(value)
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    for model, shot in RUNS:
        if model is value:
            return shot
    if type(value).__name__ in ("Model", "DieterichState"):
        return snapshot(value)
    if isinstance(value, dict):
        return {"type": "", **{name: plain(one) for name, one in value.items()}}
    return None


def snapshot(thing):
    return {"type": type(thing).__name__, **{name: plain(value) for name, value in vars(thing).items()}}


def truth(text):
    RUNS.clear()
    made = modules()
    before = {name: sys.modules.get(name) for name in made}
    sys.modules.update(made)
    np.seterr(all="ignore")
    space = {"__name__": "__main__"}
    out, sys.stdout = sys.stdout, open("/dev/null", "w")
    try:
        exec(compile(text, "script", "exec"), space)
    except SystemExit:
        pass
    finally:
        sys.stdout = out
        for name, value in before.items():
            sys.modules.pop(name)
    return space


def read(answer, value):
    """A value of the document, or None where it is not known."""
    if isinstance(value, dict):
        if "object" not in value:
            return None
        one = answer["objects"][value["object"]]
        if one["changed"]:
            return None
        if "numbers" in one:
            return one["numbers"]
        if "list" in one:
            return [read(answer, x) for x in one["list"]]
        return {"type": one["type"], **{name: read(answer, slot[0]) for name, slot in one["slots"].items()}}
    return value


def same(got, wanted, path):
    if got is None:
        return 0
    if isinstance(got, dict) and isinstance(wanted, dict):
        missing = [name for name in wanted if name not in got]
        assert not missing, (path, "misses", missing)
        return sum(same(got[name], wanted.get(name), path + "." + name) for name in got)
    if isinstance(got, list) and isinstance(wanted, list):
        assert len(got) == len(wanted), (path, got, wanted)
        return sum(same(a, b, path) for a, b in zip(got, wanted))
    assert got == wanted or (isinstance(got, float) and isinstance(wanted, float) and abs(got - wanted) <= 1e-15 * abs(wanted)), (path, got, wanted)
    return 1


def main():
    known = refused = ran = 0
    for seed in range(int(sys.argv[2])):
        dice = random.Random(seed)
        text = HEAD + "\n".join(dice.choice(PIECES) for _ in range(dice.randint(1, 8)))
        if dice.random() < 0.7:
            text += "\nmodel.loadpoint_velocity = lp"
        if dice.random() < 0.5:
            text += "\nmodel.solve()\n" + "\n".join(dice.choice(PIECES) for _ in range(dice.randint(0, 3)))
        text += "\n"
        try:
            space = truth(text)
        except BaseException:
            continue  # a script that does not run
        ran += 1
        try:
            answer = reader.read(text.encode())
        except reader.Refused:
            refused += 1
            continue
        try:
            for name, (value, line) in answer["names"].items():
                got = read(answer, value)
                if name not in space:
                    assert got is None, (name, got, "not there")
                    continue
                wanted = plain(space[name])
                if isinstance(got, dict) and got.get("type") == "Model":
                    assert sum(model is space[name] for model, _ in RUNS) < 2, ("second run not refused", name)
                known += same(got, wanted, name)
        except AssertionError as problem:
            print(seed, problem)
            print(text[len(HEAD):])
            return 1
    print(ran, "scripts run,", known, "values as Python has them,", refused, "scripts refused")
    return 0


sys.exit(main())
