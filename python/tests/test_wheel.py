"""The wheel that `pip install .` makes."""

import base64
import csv
import hashlib
import importlib.util
import io
import os
import subprocess
import sys
import zipfile
from pathlib import Path

from conftest import ROOT


def test_a_wheel_is_whole_and_works_elsewhere(tmp_path):
    spec = importlib.util.spec_from_file_location("build_backend", ROOT / "python/build_backend.py")
    backend = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(backend)
    name = backend.wheel_of(Path(os.environ["ROSIN_BUILD"]), tmp_path)
    assert name.startswith("rosin-") and name.endswith("_x86_64.whl") or os.uname().machine != "x86_64"

    with zipfile.ZipFile(tmp_path / name) as wheel:
        contents = {path: wheel.read(path) for path in wheel.namelist()}
        wheel.extractall(tmp_path / "there")
    record = next(path for path in contents if path.endswith(".dist-info/RECORD"))
    listed = {path: digest for path, digest, _ in csv.reader(io.StringIO(contents[record].decode()))}
    assert listed.keys() == contents.keys()
    for path, digest in listed.items():
        if path != record:
            hashed = hashlib.sha256(contents[path]).digest()
            assert digest == "sha256=" + base64.urlsafe_b64encode(hashed).rstrip(b"=").decode()
    for path in (ROOT / "python/rosin").glob("*.py"):
        assert contents[f"rosin/{path.name}"] == path.read_bytes()
    assert "rosin/py.typed" in contents

    line = "import rosin; print(rosin.__file__, len(rosin.laws()))"
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "there")}
    said = subprocess.run([sys.executable, "-c", line], env=environment, cwd=tmp_path, check=True, capture_output=True,
                          text=True).stdout
    file, laws = said.split()
    assert Path(file).parent == tmp_path / "there/rosin" and int(laws) > 20
