#!/bin/sh
# Pictures out of the notebooks, as 'python3 notebooks/execute.py' has stored them: notebooks.sh ROSIN FOLDER
set -eu
python3 - "$2" <<'PYTHON'
import base64, json, pathlib, sys
for name, notebook, number in (("plane", "stick-slip-on-board", 1), ("squeal", "squeal", 3), ("pin-on-disk", "pin-on-disk", 2)):
    cells = json.loads(pathlib.Path(f"notebooks/{notebook}.ipynb").read_text())["cells"]
    pictures = [output["data"]["image/png"] for cell in cells for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]
    (pathlib.Path(sys.argv[1]) / f"{name}.png").write_bytes(base64.b64decode("".join(pictures[number])))
PYTHON
