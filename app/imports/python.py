"""Reads a script in Python for `rosin import`, and runs none of it.

The parser is Python's own. Names that are given plain values, their arithmetic and vectors of NumPy are followed, with the
objects of rsfmodel and QDYN. Whatever else a script does makes all that it may change unknown, by its line: a call
each object that it can reach, a loop or a condition each name and object that it mentions.

The text comes on standard input; the answer is a document of JSON on standard output: names with values and lines,
objects by their places in a list.
"""
import array
import ast
import copy
import json
import math
import resource
import signal
import sys

LONGEST = 1 << 16  # bytes of a script
MOST_NUMBERS, MOST_MADE = 1_000_000, 3_000_000  # of a vector, and in all vectors and lists
MOST_NESTED = 60
SECONDS, BYTES = 1, 1 << 28  # of the processor, of memory

BLOCK = "stands in a loop, a condition or a function, which is not run"
CALL = "may change the parameters in a way that is not followed, as no script is run; write them as assignments"


class Refused(Exception):
    """Ends the reading, at a line."""


class NotUnderstood(Exception):
    """Ends an expression, which then has no value."""


class Unknown:
    def __init__(self, why, line, holds=(), body=None):
        self.why, self.line, self.holds = why, line, list(holds)  # the values that it may lead to
        self.body = body  # of a function or class of the script's own: names that it mentions, names that it may give anew


class Named:
    """What another module defines, by its full name: numpy.ones_like."""

    def __init__(self, path):
        self.path = path


class Record:
    """An object, or a dictionary: values by name, each with its line."""

    def __init__(self, kind, slots=()):
        self.kind, self.slots, self.name = kind, dict(slots), ""
        self.changed = None  # (line, why) where it may have been changed unseen
        self.taken = 0  # the line in which a mesh has taken its values
        self.run = None  # (line, copy) of when it was run


class List:
    def __init__(self, items):
        self.items, self.changed = items, None


class Vector:
    def __init__(self, numbers, kind):
        self.numbers, self.kind = array.array("d", numbers), kind  # floats "f", whole numbers "i", truth values "b"
        self.changed, self.line = None, 0


OBJECTS = (Record, List, Vector)
NUMBER = (int, float)
QUIET = ("print", "len", "str", "float", "int", "open", "matplotlib", "pylab", "seaborn", "time", "datetime", "os", "warnings",
         "logging", "pprint", "sys.path", "rsfmodel.plot", "json.dump", "pickle.dump", "numpy.savetxt", "numpy.diff",
         "numpy.loadtxt")  # functions and modules that change nothing of what they are given
# words by which a script may reach all of its names
REACHES_ALL = {"exec", "eval", "compile", "globals", "locals", "vars", "modules", "_getframe", "__import__", "__builtins__",
               "builtins", "runpy", "inspect", "gc", "ctypes", "importlib", "__main__", "__globals__", "__dict__"}
MAIN = ast.dump(ast.parse("__name__ == '__main__'", mode="eval").body)
OPERATIONS = {
    ast.Add: lambda a, b: a + b, ast.Sub: lambda a, b: a - b, ast.Mult: lambda a, b: a * b, ast.Div: lambda a, b: a / b,
    ast.FloorDiv: lambda a, b: a // b, ast.Mod: lambda a, b: a % b, ast.Pow: lambda a, b: a**b,
    ast.Lt: lambda a, b: a < b, ast.LtE: lambda a, b: a <= b, ast.Gt: lambda a, b: a > b, ast.GtE: lambda a, b: a >= b,
    ast.Eq: lambda a, b: a == b, ast.NotEq: lambda a, b: a != b,
    ast.BitAnd: lambda a, b: a & b, ast.BitOr: lambda a, b: a | b}
FUNCTIONS = {name: getattr(math, name) for name in ("exp", "log", "log10", "sqrt", "sin", "cos", "tan", "floor", "ceil")}
FUNCTIONS.update(abs=abs, float=float, int=int, round=round)
CONSTANTS = {"pi": math.pi, "e": math.e, "inf": math.inf}
STATES = ("DieterichState", "RuinaState", "PrzState", "NagataState")
RESULTS = {"Model": ("results", "solver_info", "critical_times"), "qdyn": ("ot", "ox", "ot_vmax")}
QDYN = {"MESHDIM": 0, "V_PL": 1e-9, "L": 1, "SIGMA": 50e6, "VS": 3000, "MU": 30e9, "TPER": 31536000, "APER": 0,
        "TMAX": 1000, "NSTOP": 0, "FRICTION_MODEL": "RSF"}  # what the wrapper begins with
QDYN_FRICTION = {"RNS_LAW": 0, "THETA_LAW": 1, "A": 0.0010, "B": 0.0011, "DC": 1e-5, "MU_SS": 0.6, "V_SS": 1e-6,
                 "V_0": 1.01e-5, "TH_0": 1}


def new_qdyn():
    settings = Record("", {name: (value, 0) for name, value in QDYN.items()})
    settings.slots["SET_DICT_RSF"] = (Record("", {name: (value, 0) for name, value in QDYN_FRICTION.items()}), 0)
    for name in ("SET_DICT_CNS", "SET_DICT_TP", "SET_DICT_LOCALISATION"):
        settings.slots[name] = (Record(""), 0)
    return Record("qdyn", {"set_dict": (settings, 0), "mesh_dict": (Record(""), 0)})


def words(node):
    """All names in a node, and those that it gives a value."""
    used, bound = set(), set()
    for part in ast.walk(node):
        if isinstance(part, ast.Name):
            (used if isinstance(part.ctx, ast.Load) else bound).add(part.id)
        elif isinstance(part, ast.Attribute):
            used.add("." + part.attr if part.attr not in REACHES_ALL else part.attr)
        elif isinstance(part, (ast.Import, ast.ImportFrom)):
            bound |= {alias.asname or alias.name.split(".")[0] for alias in part.names}
            used |= {alias.name.split(".")[0] for alias in part.names} | {(getattr(part, "module", "") or "").split(".")[0]}
        elif isinstance(part, (ast.Global, ast.Nonlocal)):
            bound |= set(part.names)
        elif isinstance(getattr(part, "name", None), str):  # of a function, a class, an exception or a pattern
            bound.add(part.name)
    return used, bound


def reach(values):
    """All objects, and values that are not known, that values lead to."""
    found, seen, stack = [], set(), list(values)
    while stack:
        value = stack.pop()
        if isinstance(value, OBJECTS + (Unknown,)) and id(value) not in seen:
            seen.add(id(value))
            found.append(value)
            stack.extend([slot[0] for slot in value.slots.values()] if isinstance(value, Record) else
                         value.items if isinstance(value, List) else getattr(value, "holds", ()))
    return found


class Reader:
    def __init__(self):
        self.names = {}  # value and line
        self.made = self.depth = 0
        self.line, self.ended = 1, False

    def room(self, count):
        self.made += count
        if count > MOST_NUMBERS or self.made > MOST_MADE:
            raise Refused(self.line, "makes too many numbers: %d in one vector, %d in all, are read" %
                          (MOST_NUMBERS, MOST_MADE))

    def vector(self, numbers, kind):
        numbers = list(numbers)
        self.room(len(numbers))
        return Vector(numbers, kind)

    # ------------------------------------------------------------ what may have changed

    def change(self, values, line, why=CALL):
        for value in reach(values):
            if isinstance(value, OBJECTS):
                value.changed = value.changed or (line, why)

    def may_change(self, node, why):
        """All that a node names may change, and all that functions of the script's own name to which it leads."""
        used, bound = words(node)
        todo, names, values = used | bound, set(), []
        while todo:
            name = todo.pop()
            names.add(name)
            if name in REACHES_ALL:
                todo |= set(self.names) - names
            if name in self.names:
                values += reach([self.names[name][0]])
                for value in values:
                    if isinstance(value, Unknown) and value.body:
                        todo |= value.body[0] - names
                        bound |= value.body[1]
        self.change(values, node.lineno, why)
        for name in set(self.names) if not REACHES_ALL.isdisjoint(names) else bound:
            if name in bound or not isinstance(self.names[name][0], Record):
                self.names[name] = (Unknown(why, node.lineno, values, self.body(node)), node.lineno)

    @staticmethod
    def body(node):
        """What functions in a node mention, and the names outside of them that they may give anew."""
        given = {name for part in ast.walk(node) if isinstance(part, (ast.Global, ast.Nonlocal)) for name in part.names}
        return words(node)[0] | given, given

    # ------------------------------------------------------------ statements

    def run(self, statements):
        for node in statements:
            if self.ended:
                return
            self.line = node.lineno
            if not REACHES_ALL.isdisjoint(words(node)[0]) and not isinstance(node, ast.If):
                self.may_change(node, CALL)
            elif isinstance(node, ast.Assign):
                value = self.value(node.value)
                for target in node.targets:
                    self.assign(target, value)
            elif isinstance(node, ast.AnnAssign) and node.value is not None:
                self.assign(node.target, self.value(node.value))
            elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name) and isinstance(
                    self.names.get(node.target.id, (None,))[0], NUMBER):
                self.assign(node.target, self.value(ast.copy_location(
                    ast.BinOp(ast.copy_location(ast.Name(node.target.id, ast.Load()), node), node.op, node.value), node)))
            elif isinstance(node, ast.Expr):
                self.value(node.value)
            elif isinstance(node, (ast.Import, ast.ImportFrom)) and node.names[0].name != "*":
                for alias in node.names:
                    path = alias.name if alias.asname else alias.name.split(".")[0]
                    if isinstance(node, ast.ImportFrom):
                        path = "%s.%s" % (node.module, alias.name)
                    self.names[alias.asname or path.split(".")[-1]] = (Named(path), node.lineno)
            elif isinstance(node, (ast.FunctionDef, ast.ClassDef)) and not node.decorator_list:
                self.define(node)
            elif isinstance(node, ast.If) and ast.dump(node.test) == MAIN:
                self.run(node.body)
            elif isinstance(node, ast.Raise):
                self.ended = True
            elif isinstance(node, ast.ImportFrom):  # of all names of a module, which may be any
                for name in self.names:
                    self.names[name] = (Unknown(CALL, node.lineno, [self.names[name][0]]), node.lineno)
            elif not isinstance(node, (ast.Pass, ast.Global, ast.AnnAssign)):
                self.may_change(node, BLOCK if hasattr(node, "body") else CALL)

    def define(self, node):
        """Runs what is run where a function or a class is defined: defaults, bases, and what is no method."""
        function = isinstance(node, ast.FunctionDef)
        for part in node.args.defaults + node.args.kw_defaults if function else node.bases + node.keywords:
            if part is not None:
                self.value(getattr(part, "value", part) if isinstance(part, ast.keyword) else part)
        for part in [] if function else node.body:
            if not isinstance(part, ast.FunctionDef) or part.decorator_list:
                self.may_change(part, CALL)
        self.names[node.name] = (Unknown("is a function of the script", node.lineno, [], self.body(node)), node.lineno)

    def assign(self, target, value):
        line = self.line
        if isinstance(target, ast.Name):
            self.names[target.id] = (value, line)
            if isinstance(value, Record):
                value.name = value.name or target.id
            return
        if isinstance(target, (ast.Tuple, ast.List)):
            plain = isinstance(value, List) and not value.changed and len(value.items) == len(target.elts)
            for i, one in enumerate(target.elts):
                plain = plain and not isinstance(one, ast.Starred)
                self.assign(one.value if isinstance(one, ast.Starred) else one, value.items[i] if plain else
                            Unknown("is one of several values that are given together", line, [value]))
            return
        of = self.value(target.value)
        key = target.attr if isinstance(target, ast.Attribute) else self.index(target.slice)
        if isinstance(of, Record) and isinstance(key, str) and bool(of.kind) == isinstance(target, ast.Attribute):
            if of.taken:
                self.change([of], line, "changes settings that render_mesh has taken in line %d; set them before" % of.taken)
            of.slots[key] = (value, line)
        elif isinstance(of, Vector) and of.kind == "f" and isinstance(value, (Vector,) + NUMBER) and self.put(of, key, value):
            of.line = line
        else:
            self.change([of], line, "changes a part in a way that is not understood")

    def put(self, vector, key, value):
        size = len(vector.numbers)
        if type(key) is int and -size <= key < size:
            where = [key % size]
        elif isinstance(key, slice):
            where = range(*key.indices(size))
        elif isinstance(key, Vector) and key.kind == "b" and len(key.numbers) == size and not key.changed:
            where = [i for i, x in enumerate(key.numbers) if x]
        else:
            return False
        if isinstance(value, Vector) and (value.changed or len(value.numbers) != len(where)):
            return False
        for i, x in zip(where, list(value.numbers) if isinstance(value, Vector) else [value] * len(where)):
            vector.numbers[i] = x
        return True

    def index(self, key):
        key = getattr(key, "value", key) if type(key).__name__ == "Index" else key  # of Python before 3.9
        if not isinstance(key, ast.Slice):
            return self.value(key)
        parts = [part and self.value(part) for part in (key.lower, key.upper, key.step)]
        plain = all(part is None or type(part) is int for part in parts) and parts[2] != 0
        return slice(*parts) if plain else Unknown("is a part that is not understood", self.line)

    # ------------------------------------------------------------ expressions

    def value(self, node):
        """Unknown where an expression is not followed; it may lead to all that it names."""
        self.depth += 1
        try:
            if self.depth > MOST_NESTED:
                raise Refused(node.lineno, "is nested too deeply")
            value = getattr(self, "of_" + type(node).__name__, self.of_other)(node)
            if isinstance(value, int) and value.bit_length() > 1024 or isinstance(value, complex):
                raise NotUnderstood("is no number that is read")
            return value
        except (NotUnderstood, ArithmeticError, ValueError, TypeError, KeyError, IndexError) as problem:
            why = str(problem) if isinstance(problem, NotUnderstood) and str(problem) else "is not understood"
            return Unknown(why, node.lineno, [self.names[name][0] for name in words(node)[0] if name in self.names])
        finally:
            self.depth -= 1

    def of_other(self, node):
        """A comprehension, a lambda, a text that is put together: what they call is not seen."""
        if any(isinstance(part, (ast.Call, ast.Lambda, ast.NamedExpr)) for part in ast.walk(node)):
            self.may_change(node, BLOCK)
        raise NotUnderstood(BLOCK)

    def of_Constant(self, node):
        if isinstance(node.value, NUMBER + (str,)) or node.value is None:
            return node.value
        raise NotUnderstood()

    def of_Name(self, node):
        if node.id in self.names:
            return self.names[node.id][0]
        if node.id in QUIET or node.id in FUNCTIONS or node.id in ("exit", "quit", "dict"):
            return Named(node.id)
        raise NotUnderstood("refers to '%s', which is not given" % node.id)

    def of_Attribute(self, node):
        of = self.value(node.value)
        if isinstance(of, Named):
            module = of.path in ("numpy", "math")
            return CONSTANTS[node.attr] if module and node.attr in CONSTANTS else Named(of.path + "." + node.attr)
        if isinstance(of, Record) and of.kind and not of.changed:
            if node.attr in RESULTS.get(of.kind, ()):
                return Unknown("is a result", node.lineno)
            if node.attr in of.slots:
                return of.slots[node.attr][0]
        if isinstance(of, Vector) and node.attr == "size" and not of.changed:
            return len(of.numbers)
        raise NotUnderstood()

    def of_Subscript(self, node):
        of, key = self.value(node.value), self.index(node.slice)
        if isinstance(of, OBJECTS) and of.changed:
            raise NotUnderstood(of.changed[1])
        if isinstance(of, Record) and not of.kind and isinstance(key, str):
            return of.slots[key][0]
        if isinstance(of, List) and type(key) is int:
            return of.items[key]
        if isinstance(of, Vector) and type(key) is int:
            return of.numbers[key] if of.kind == "f" else int(of.numbers[key])
        raise NotUnderstood()

    def of_UnaryOp(self, node):
        of = self.value(node.operand)
        if isinstance(node.op, (ast.USub, ast.UAdd)):
            return self.combined(-1 if isinstance(node.op, ast.USub) else 1, ast.Mult, of)
        if isinstance(node.op, ast.Invert) and isinstance(of, Vector) and of.kind == "b" and not of.changed:
            return self.vector((not x for x in of.numbers), "b")
        raise NotUnderstood(getattr(of, "why", ""))

    def of_BinOp(self, node):
        return self.combined(self.value(node.left), type(node.op), self.value(node.right))

    def of_Compare(self, node):
        if len(node.ops) > 1:
            raise NotUnderstood()
        return self.combined(self.value(node.left), type(node.ops[0]), self.value(node.comparators[0]))

    def combined(self, a, operation, b):
        for side in (a, b):
            if isinstance(side, Unknown) or getattr(side, "changed", None):
                raise NotUnderstood(side.why if isinstance(side, Unknown) else side.changed[1])
        apply = OPERATIONS[operation]
        if isinstance(a, NUMBER) and isinstance(b, NUMBER):
            if operation is ast.Pow and isinstance(a, int) and isinstance(b, int) and b * a.bit_length() > 1024:
                raise NotUnderstood("is no number that is read")
            return apply(a, b)
        if isinstance(a, List) and isinstance(b, List) and operation is ast.Add:
            self.room(len(a.items) + len(b.items))
            return List(a.items + b.items)
        if isinstance(b, List):
            a, b = b, a
        if isinstance(a, List) and type(b) is int and operation is ast.Mult:
            self.room(len(a.items) * max(b, 0))
            return List(a.items * b)
        if not (isinstance(a, NUMBER + (Vector,)) and isinstance(b, NUMBER + (Vector,))):
            raise NotUnderstood()
        kinds = {side.kind if isinstance(side, Vector) else "f" if isinstance(side, float) else "i" for side in (a, b)}
        logical, compares = operation in (ast.BitAnd, ast.BitOr), issubclass(operation, ast.cmpop)
        if logical != (kinds == {"b"}) or (operation is ast.Pow and kinds == {"i"}):
            raise NotUnderstood()
        size = len(a.numbers) if isinstance(a, Vector) else len(b.numbers)
        lists = [side.numbers if isinstance(side, Vector) else [side] * size for side in (a, b)]
        if len(lists[0]) != len(lists[1]):
            raise NotUnderstood("joins vectors of different lengths")
        made = "b" if logical or compares else "i" if kinds == {"i"} and operation is not ast.Div else "f"
        return self.vector((apply(bool(x), bool(y)) if logical else apply(x, y) for x, y in zip(*lists)), made)

    def of_List(self, node):
        self.room(len(node.elts))
        return List([self.value(one) for one in node.elts])

    of_Tuple = of_List

    def of_Dict(self, node):
        slots = {}
        for key, value in zip(node.keys, node.values):
            name = self.value(key) if key is not None else None
            if not isinstance(name, str):
                raise NotUnderstood()
            slots[name] = (self.value(value), key.lineno)
        return Record("", slots)

    # ------------------------------------------------------------ calls

    def of_Call(self, node):
        plain = not node.keywords and not any(isinstance(one, ast.Starred) for one in node.args)
        name = node.func.attr if isinstance(node.func, ast.Attribute) else ""
        of = self.value(node.func.value) if name else None
        if isinstance(of, Record):
            done = self.method(of, name, [self.value(one) for one in node.args], node)
            if done is not NotImplemented:
                return done
        function = self.value(node.func) if not isinstance(of, OBJECTS) else None
        given = [self.value(one) for one in node.args]
        path = function.path if isinstance(function, Named) else ""
        if plain and path:
            done = self.function(path, given)
            if done is not NotImplemented:
                return done
        if path == "dict" and not given:
            return Record("", {one.arg: (self.value(one.value), one.value.lineno) for one in node.keywords if one.arg})
        for one in node.keywords:  # which may change something
            self.value(one.value)
        if not path or not any(path == one or path.startswith(one + ".") for one in QUIET):
            self.may_change(node, CALL)
        raise NotUnderstood("comes from '%s', which is not run" % (path or name or getattr(node.func, "id", "a function")))

    def method(self, of, name, given, node):
        if (of.kind, name) in (("Model", "solve"), ("qdyn", "run")):
            if of.run:
                of.run[1].changed = (node.lineno, "is a second run, beside that in line %d; one scene is one run" % of.run[0])
            else:
                of.run = (node.lineno, copy.deepcopy(of))
        elif (of.kind, name) == ("qdyn", "settings") and len(given) == 1:
            settings = of.slots["set_dict"][0]
            if any(not isinstance(one, Record) or one.changed for one in (given[0], settings)) or settings.taken:
                self.change([of], getattr(given[0], "line", node.lineno))
                return True
            for key, (value, line) in list(given[0].slots.items()):
                mine = settings.slots.get(key, (None,))[0]
                if isinstance(mine, Record) and isinstance(value, Record) and not value.changed:
                    mine.slots.update(value.slots)
                else:
                    settings.slots[key] = (value, line)
        elif (of.kind, name) == ("qdyn", "render_mesh"):
            of.slots["mesh_dict"] = (Record(""), 0)
            for value in reach([of.slots["set_dict"][0]]):
                value.taken = node.lineno
        elif (of.kind, name) not in (("Model", "savetxt"), ("qdyn", "write_input"), ("qdyn", "read_output")):
            return NotImplemented
        return Unknown("is a result", node.lineno)

    def function(self, path, given):
        module, _, name = path.rpartition(".")
        first = given[0] if given else None
        root, count = module.split(".")[0], len(given)
        numeric = all(type(one) in NUMBER for one in given)
        if path in ("exit", "quit", "sys.exit"):
            self.ended = True
            return None
        if root in ("rsfmodel", "rsf", "staterelations") and count == 0 and name in ("Model",) + STATES:
            return Record(name)
        if root in ("qdyn", "pyqdyn") and count == 0 and name == "qdyn":
            return new_qdyn()
        if path == "copy.deepcopy" and isinstance(first, OBJECTS):
            made = copy.deepcopy(first)
            for value in reach([made]):
                value.run = None
            return made
        if path == "len" and isinstance(first, (Vector, List)) and not first.changed:
            return len(first.numbers if isinstance(first, Vector) else first.items)
        if name in FUNCTIONS and root in ("", "numpy", "math") and numeric and count == 1:
            return FUNCTIONS[name](first)
        if root != "numpy" or count == 0:
            return NotImplemented
        if name == "arange" and numeric and count <= 3:
            start, stop, step = (0, first, 1) if count == 1 else (given + [1])[:3]
            size = max(0, math.ceil((stop - start) / step))
            self.room(size)
            whole = all(type(one) is int for one in given)
            return Vector([start + i * ((start + step) - start) for i in range(size)], "i" if whole else "f")
        if name == "linspace" and numeric and count in (2, 3) and type((given + [50])[2]) is int and (given + [50])[2] > 1:
            start, stop, size = (given + [50])[:3]
            self.room(size)
            return Vector([i * ((stop - start) / (size - 1)) + start for i in range(size - 1)] + [stop], "f")
        if name in ("ones", "zeros", "full") and count == 1 + (name == "full") and type(first) is int and first >= 0:
            fill = given[1] if name == "full" else name == "ones"
            self.room(first)
            return Vector([float(fill)] * first, "i" if type(fill) is int else "f")
        if name in ("ones_like", "zeros_like", "full_like") and count == 1 + (name == "full_like") and isinstance(
                first, Vector) and not first.changed:
            fill = given[1] if name == "full_like" else name == "ones_like"
            if first.kind == "f" or isinstance(fill, bool):
                return self.vector([float(fill)] * len(first.numbers), first.kind)
        if name in ("array", "copy") and count == 1:
            return self.as_vector(first)
        if name in ("concatenate", "hstack") and count == 1 and isinstance(first, List) and first.items:
            parts = [self.as_vector(one) for one in first.items]
            return self.vector((x for part in parts for x in part.numbers), max((part.kind for part in parts), key="bif".index))
        return NotImplemented

    def as_vector(self, value):
        if isinstance(value, Vector) and not value.changed:
            return self.vector(value.numbers, value.kind)
        if isinstance(value, List) and not value.changed and value.items and all(type(x) in NUMBER for x in value.items):
            return self.vector(value.items, "f" if any(isinstance(x, float) for x in value.items) else "i")
        raise NotUnderstood("has elements that are not understood")


class Document:
    def __init__(self, names):
        self.objects, self.places = [], {}
        self.names = {name: self.slot(value, line) for name, (value, line) in names.items() if not isinstance(value, Named)}

    def slot(self, value, line):
        """A value with the line that gave it, or that changed its numbers later."""
        return [self.value(value), max(line, getattr(value, "line", 0) if isinstance(value, Vector) else 0)]

    def value(self, value):
        if isinstance(value, NUMBER):
            return float(value) if math.isfinite(value) else {"number": str(value)}
        if isinstance(value, str):
            return {"text": value[:200]}
        if not isinstance(value, OBJECTS):
            return {"unknown": getattr(value, "why", "is not understood")}
        if id(value) not in self.places:
            self.places[id(value)] = len(self.objects)
            self.objects.append(value)
        return {"object": self.places[id(value)]}

    def finished(self):
        made = []
        for one in self.objects:  # which grow
            if isinstance(one, Record):
                one = one.run[1] if one.run else one
                entry = {"type": one.kind, "name": one.name, "slots": {name: self.slot(*slot) for name, slot in one.slots.items()}}
            elif isinstance(one, List):
                entry = {"list": [self.value(x) for x in one.items]}
            else:
                entry = {"numbers": [x if math.isfinite(x) else None for x in one.numbers]}
            entry["changed"] = one.changed
            made.append(entry)
        return {"objects": made, "names": self.names}


def read(text):
    if len(text) > LONGEST:
        raise Refused(text[:LONGEST].count(b"\n") + 1, "is where the script becomes longer than %d bytes" % LONGEST)
    reader = Reader()
    try:
        tree = ast.parse(text)
        reader.run(tree.body)
        return Document(reader.names).finished()
    except SyntaxError as problem:
        raise Refused(problem.lineno or 1, "is no Python: %s" % problem.msg)
    except ValueError as problem:
        raise Refused(1, "begins what is no Python: %s" % problem)
    except (MemoryError, RecursionError, TimeoutError):
        raise Refused(reader.line, "is where reading the script becomes too much work; write its parameters alone")


def out_of_time(*_):
    raise TimeoutError


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 1))
    signal.signal(signal.SIGXCPU, out_of_time)
    try:
        answer = read(sys.stdin.buffer.read())
    except Refused as refused:
        answer = {"refused": refused.args[1], "line": refused.args[0]}
    sys.stdout.write(json.dumps(answer))
