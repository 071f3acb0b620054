#!/usr/bin/env python3
"""One result, the same numbers in every format: JSON against docs/results.schema.json and against the tables that it
describes, CSV against NetCDF, MATLAB and Python, bit for bit; declared figures by matplotlib and in the report.

    tests/results/results_test.py build/release/rosin [--all]

Each verb is asked of one oscillator, and a run and a cycle of each; with --all every verb of each (minutes). What needs a
package that is not there (python3-jsonschema, -xarray, -netcdf4, -scipy, -matplotlib; the module of rosin) says so and is left out.
"""
import csv
import importlib
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/gate"))
import gate  # noqa: E402

SCHEMA = json.loads((ROOT / "docs/results.schema.json").read_text())
OWN = [("curve", "bristol-board-cycle"), ("frf", "frf-load-family"), ("fit", "step-with-trend"), ("study", "stick-slip-study"),
       ("lab slide-hold-slide", "lab-slide-hold-slide"), ("compare", "compare-laws"), ("branch", "two-motions"),
       ("stability", "mode-coupling"), ("basin", "which-motion"), ("map", "bristol-board-plane"), ("lyapunov", "belt-chaos")]
SMALL = {"study": ["study.cases=20"], "map": ["map.x.points=6", "map.y.points=5"], "lyapunov": ["lyapunov.duration=60"],
         "basin": ["basin.x.points=3", "basin.y.points=3"]}


def there(module):
    try:
        return importlib.import_module(module)
    except ImportError:
        print(f"left out: python3 has no {module}")
        return None


JSONSCHEMA, XARRAY, SCIPY, ROSIN = there("jsonschema"), there("xarray"), there("scipy.io"), there("rosin")
NUMPY = there("numpy") if XARRAY or SCIPY else None
MATPLOTLIB = there("matplotlib.pyplot")


def questions(every_verb):
    for verb, example in OWN:
        if (ROOT / f"examples/{example}.toml").exists():
            yield f"examples/{example}.toml", verb.split(), [part for s in SMALL.get(verb, []) for part in ("--set", s)]
    types, verbs = {}, set()
    for scene, verb, options in gate.questions_of_every_verb():
        kind = tomllib.loads((ROOT / scene).read_text())["oscillator"].get("type", "slider")
        if types.setdefault(kind, scene) != scene:
            continue
        if every_verb or verb[0] in ("run", "cycle") or (verb[0] not in verbs and kind == "structure"):
            verbs.add(verb[0])
            yield scene, verb, options


def same(a, b):
    return (a is None or b is None or math.isnan(a) or math.isnan(b)) and (a is None or math.isnan(a)) == (
        b is None or math.isnan(b)) or a == b


class Check:
    def __init__(self, name):
        self.name, self.failures = name, []

    def that(self, good, what):
        if not good:
            self.failures.append(f"{self.name}: {what}")


def check_tables(check, document, folder):
    """CSV has the described columns, NetCDF and MATLAB the same numbers, and lists of the document stand in them."""
    for about in document["datasets"]:
        name, variables = about["name"], about["variables"]
        stored, table = folder / f"{name}.nc", folder / f"{name}.csv"
        if 0 in about["dimensions"].values():
            check.that(not stored.exists() and not table.exists(), f"{name} has no rows, and files")
            continue
        check.that(stored.exists(), f"{name}.nc is not there")
        data = None
        if XARRAY and stored.exists():
            with XARRAY.open_dataset(stored, decode_times=False, mask_and_scale=False) as opened:
                data = opened.load()
            check.that(dict(data.sizes) == about["dimensions"], f"{name}.nc: dimensions {dict(data.sizes)}")
            for variable, told in variables.items():
                column = data[variable.replace(" ", "_").replace("/", "_")]
                check.that(list(column.dims) == told["over"], f"{name}.nc: {variable} over {column.dims}")
                check.that(column.attrs.get("units") == told.get("unit"), f"{name}.nc: {variable} in {column.attrs.get('units')}")
                check.that(column.attrs["long_name"] == told["meaning"], f"{name}.nc: {variable} is '{column.attrs['long_name']}'")
        if name not in ("sweep", "basin"):  # whose CSV is of a picture
            check_columns(check, document, about, table, data)
        if SCIPY and data is not None:
            check_matlab(check, about, folder / f"{name}.mat", data)


def check_columns(check, document, about, table, data):
    if len(about["dimensions"]) > 1 or not table.exists():
        return
    with table.open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    names = [name for name, told in about["variables"].items() if told["over"]]
    check.that([heading.partition(" (")[0] for heading in header] == [name.partition(" (")[0] for name in names],
               f"{table.name}: {header}")
    lists = document.get("columns", {}) | {k: v for k, v in document.items() if isinstance(v, list)}
    is_main = about is document["datasets"][0]
    for place, name in enumerate(names):
        cells = [row[place] for row in rows]
        if "unit" not in about["variables"][name]:
            continue
        values = list(map(float, cells))
        if data is not None and names.index(name) == place:
            column = data[name.replace(" ", "_").replace("/", "_")].values.tolist()
            check.that(all(map(same, column, values)) and len(column) == len(values), f"{table.name}: {name} is not that of NetCDF")
        if is_main and isinstance(lists.get(name), list) and len(lists[name]) == len(values):
            check.that(all(map(same, lists[name], values)), f"{table.name}: {name} is not that of the document")


def check_matlab(check, about, path, data):
    if not path.exists():
        return
    stored = SCIPY.loadmat(path)
    for variable, told in about["variables"].items():
        if "unit" not in told:
            continue
        name = "".join(c if c.isascii() and c.isalnum() else "_" for c in variable)
        values = stored[name if name[0].isalpha() else "x" + name]
        column = data[variable.replace(" ", "_").replace("/", "_")].values
        check.that(NUMPY.array_equal(values.T.reshape(column.shape), column, equal_nan=True), f"{path.name}: {name} is not that of NetCDF")


def check_errors(check, value, path=""):
    """Names of errors are those of values, of the same object or of a table within it."""
    if isinstance(value, list):
        for i, entry in enumerate(value[:50]):
            check_errors(check, entry, f"{path}[{i}]")
    if not isinstance(value, dict):
        return
    tables = (value.get(table) for table in ("columns", "metrics", "readings"))
    known = {*value, *(name for table in tables if isinstance(table, dict) for name in table), "relative", "eigenvalue"}
    if isinstance(value.get("error"), dict) and "median" not in value["error"]:
        for name in value["error"]:
            check.that(name in known, f"{path}.error has '{name}', of no value")
    for name, entry in value.items():
        if name not in ("error", "datasets"):
            check_errors(check, entry, f"{path}.{name}")


def check_python(check, scene, verb, options, document):
    if not ROSIN or not XARRAY or "--time-limit" in options:
        return
    loaded = ROSIN.load(ROOT / scene)
    for path, value in (given.split("=", 1) for given in options if given != "--set"):
        loaded = loaded.set(path, tomllib.loads(f"v = {value}")["v"])
    result = getattr(loaded, verb[0])(*verb[1:])
    check.that(gate.without_times(result.raw) == gate.without_times(document), "Python has another document")
    check.that([*([] if result.dataset is None else [None]), *result.tables] or not document["datasets"], "Python has no datasets")
    for about, data in zip(document["datasets"], [result.dataset, *result.tables.values()]):
        check.that({name.replace(" ", "_").replace("/", "_") for name in about["variables"]} <= set(data.variables),
                   f"Python: {about['name']} has {list(data.variables)}")
        check.that(dict(data.sizes) == about["dimensions"], f"Python: {about['name']} is {dict(data.sizes)}")


def check_figures(check, rosin, folder):
    """Each declared figure is drawn by matplotlib, and the report has its lines."""
    if not ROSIN or not MATPLOTLIB or not (folder / "result.json").exists():
        return  # the work ended before there was a result
    result = ROSIN.Result.read(folder)
    for name in ROSIN.declared.names(folder, result.label):
        declared, figure = ROSIN.declared.read(folder, name), ROSIN.plot(result, name)
        figure.canvas.draw()
        drawn = sum(bool(ax.lines or ax.collections or ax.patches or ax.containers) for ax in figure.axes)
        check.that(drawn >= len(declared["panels"]), f"matplotlib: {name} has {drawn} of {len(declared['panels'])} panels")
        MATPLOTLIB.close(figure)
    reported = subprocess.run([rosin, "report", str(folder), "--quiet"], capture_output=True, text=True)
    check.that(reported.returncode == 0, f"no report: {reported.stderr}")
    page = (folder / "report.html").read_text() if reported.returncode == 0 else ""
    shown = [json.loads(text.split(">", 1)[1]) for text in page.split("</script>") for text in text.split('<script type="application/json"')[1:]]
    for figure in shown:
        lines = figure.get("series") or figure.get("rules") or figure.get("layers")
        check.that(lines, f"report: nothing in {figure.get('title')}")


def ask(rosin, scene, verb, options):
    check = Check(f"{' '.join(verb)} {scene}")
    with tempfile.TemporaryDirectory() as out:
        folder = pathlib.Path(out)
        formats = ["--netcdf"] + (["--matlab"] if has_matlab(rosin) else [])
        ran = subprocess.run([rosin, *verb[:2 if verb[0] == "lab" else 1], str(ROOT / scene), *verb[2 if verb[0] == "lab" else 1:], *options, *formats, "--json",
                              "--no-pictures", "--out", out], capture_output=True, text=True)
        if ran.returncode > 1 or not ran.stdout:
            return check  # the pair is refused
        document = json.loads(ran.stdout)
        if JSONSCHEMA:
            for error in JSONSCHEMA.Draft202012Validator(SCHEMA).iter_errors(document):
                check.that(False, f"{error.json_path}: {error.message[:200]}")
        check_errors(check, document)
        if check.failures:
            return check
        check_tables(check, document, folder)
        check_python(check, scene, verb, options, document)
        check_figures(check, rosin, folder)
    return check


def has_matlab(rosin, known={}):
    if rosin not in known:
        known[rosin] = "--matlab" in subprocess.run([rosin, "curve", "--help"], capture_output=True, text=True).stdout
    return known[rosin]


def main():
    rosin = os.path.abspath(sys.argv[1])
    asked, failures = 0, []
    for question in questions("--all" in sys.argv):
        asked += 1
        failures += ask(rosin, *question).failures
    print("\n".join(failures))
    print(f"{asked} results, {len(failures)} differences between formats")
    sys.exit(bool(failures))


if __name__ == "__main__":
    main()
