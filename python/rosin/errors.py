"""What may be wrong: with the input, and with an answer that ends short."""

from __future__ import annotations


class InputError(ValueError):
    """The input cannot be used.

    Attributes
    ----------
    place : str
        Where: "file:line:column", the file, or the change by `Scene.set`; empty where it is in no scene.
    message : str
        The quantity, its value, the accepted range with its unit, the nearest valid name.
    """

    def __init__(self, place: str, message: str) -> None:
        super().__init__(f"{place}: {message}" if place else message)
        self.place = place
        self.message = message

    def __reduce__(self):  # which lets it pass between processes
        return InputError, (self.place, self.message)


class IncompleteWarning(UserWarning):
    """A computation ended short of what was asked; its result holds what there is, and says why."""
