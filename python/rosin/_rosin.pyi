"""What the compiled module python/module.cpp has; use the package instead."""

from typing import Any, Callable

def perform(words: list[str], text: str | None = None,
            progress: Callable[[float], Any] | None = None) -> tuple[int, bytes, bytes, bytes]: ...
def verbs() -> list[dict[str, Any]]: ...
