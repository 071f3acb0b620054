# Two laws with one steady friction curve: where does the time that the slider sticks tell them apart?
import rosin

slider = rosin.Scene({
    "law": {"type": "ageing", "mu0": 0.6, "a": 0.010, "b": 0.015, "L": "10 um", "v0": "1 um/s"},
    "oscillator": {"type": "slider", "mass": 1, "stiffness": 1500},
    "drive": {"speed": "10 um/s", "normal_load": 5},
})

# Linearised, they are the same: both lose stability at one load.
laws = {name: slider.set("law.type", name) for name in ("ageing", "slip")}
for name, scene in laws.items():
    onset = scene.stability().raw["hopf"][0]
    print(f"{name:<8} slides steadily up to {onset['value']:.6f} N ({onset['parameter']})")

# Beyond it they move differently.
for load in (3.5, 5, 10):
    sticks = {name: scene.set("drive.normal_load", load).cycle().metrics["stick_fraction"] for name, scene in laws.items()}
    print(f"{load:>4} N: sticks {sticks['ageing']:.3f} of the time by ageing, {sticks['slip']:.3f} by slip")
