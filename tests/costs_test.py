#!/usr/bin/env python3
"""Costs of compilations and tests: what a compiler takes is logged, and the tables of a page are renewed with their reasons."""
import importlib.util
import json
import sys
import tempfile
from pathlib import Path

spec = importlib.util.spec_from_file_location("costs", Path(__file__).parents[1] / "cmake/costs.py")
costs = importlib.util.module_from_spec(spec)
spec.loader.exec_module(costs)

with tempfile.TemporaryDirectory() as folder:
    place = Path(folder)
    (place / "one.cpp").write_text("#include <vector>\nint main() { return 0; }\n")
    log = str(place / "build.log")
    assert costs.main(["compile", log, "c++", "-c", str(place / "one.cpp"), "-o", f"{place}/one.o"]) == 0
    assert costs.main(["compile", log, "c++", "-c", str(place / "none.cpp"), "-o", f"{place}/none.o"]) != 0
    line, = map(json.loads, Path(log).read_text().splitlines())
    assert line["file"] == "one.cpp" and 0 < line["seconds"] < 60 and line["kilobytes"] > 1000

    (place / "build.log").write_text("".join(
        json.dumps({"file": file, "target": target, "seconds": seconds, "kilobytes": 5e5}) + "\n"
        for file, target, seconds in [("laws/a.cpp", "rosin", 12.04), ("app/b.cpp", "rosin_app", 3.0),
                                      ("tests/c.cpp", "rosin_tests", 5.0)]))
    (place / "tests.log").write_text("      Start  1: one thing is so\n"
                                     "  1/2 Test  #1: one thing is so ..............   Passed    0.31 sec\n"
                                     "  2/2 Test  #2: another, with (brackets) .....***Failed   12.04 sec\n")
    (place / "CONTRIBUTING.md").write_text(
        "before\n<!-- compilations -->\nold\n\n| file | s | why so long |\n|---|---|---|\n| `laws/a.cpp` | 9 | kernels |\n"
        "<!-- end of compilations -->\nbetween\n<!-- tests -->\n<!-- end of tests -->\nafter\n")
    costs.root = place
    assert costs.main(["write", log, str(place / "tests.log")]) == 0
    page = (place / "CONTRIBUTING.md").read_text()
    assert "| `laws/a.cpp` | 12.0 | kernels |" in page and "Everything takes 20 s" in page and "the command 15 s" in page, page
    assert "| another, with (brackets) | 12 |  |" in page and "The 2 tests take 12 s" in page, page
    assert page.startswith("before\n") and page.endswith("after\n") and "between" in page and "old" not in page
    costs.main(["write", log, str(place / "tests.log")])
    assert (place / "CONTRIBUTING.md").read_text() == page
sys.exit(0)
