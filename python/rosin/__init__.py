"""rosin: dynamic friction; laws, sliders, stability and parameter planes.

>>> import rosin
>>> scene = rosin.load("examples/bristol-board-plane.toml")
>>> plane = scene.map()
>>> plane.dataset.stick_fraction
>>> rosin.plot(plane)
"""

from .beside import beside
from .catalogue import Law, laws, normal_laws
from .errors import IncompleteWarning, InputError
from .own_law import asinh_exp, law, sinh_exp
from .picture import STYLE, plot
from .result import Result
from .scene import Scene, load

__all__ = ["STYLE", "IncompleteWarning", "InputError", "Law", "Result", "Scene", "asinh_exp", "beside", "law", "laws", "load", "normal_laws",
           "plot", "sinh_exp"]
