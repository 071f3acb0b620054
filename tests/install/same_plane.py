"""The installed package draws the plane of an example, and its numbers are those of the installed command, bit for bit.

same_plane.py SCENE, with both in the search paths, in a folder for the results.
"""

import subprocess
import sys

import matplotlib
import numpy
import xarray

matplotlib.use("Agg")
import rosin

scene = rosin.load(sys.argv[1]).set("map.x.points", 8).set("map.y.points", 6)
plane = scene.map()
rosin.plot(plane).savefig("plane.png")

words = ["--set", "map.x.points=8", "--set", "map.y.points=6", "--out", "plane", "--quiet", "--no-pictures"]
subprocess.run(["rosin", "map", sys.argv[1], *words], check=True)
command = xarray.load_dataset("plane/map.nc", decode_times=False)
assert set(command.data_vars) == set(plane.dataset.data_vars) and len(command.data_vars) > 4
for name in command.data_vars:
    ours, theirs = plane.dataset[name].values, command[name].values
    assert ours.dtype == theirs.dtype and numpy.array_equal(ours.view("u1"), theirs.view("u1")), f"{name} differs"
assert int(numpy.isfinite(command.stick_fraction).sum()) > 20
with open("plane.png", "rb") as picture:
    assert picture.read(4) == b"\x89PNG"
print(f"{len(command.data_vars)} variables of {command.stick_fraction.size} points, the same bits: {rosin.__file__}")
