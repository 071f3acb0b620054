# Five lines draw a parameter plane: where a slider on Bristol board vibrates, and how much of the time it sticks.
import rosin

scene = rosin.load("examples/bristol-board-plane.toml")
plane = scene.map()
print(plane.dataset.stick_fraction)
rosin.plot(plane).savefig("plane.png", dpi=150)
