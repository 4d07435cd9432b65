"""The error of what a system does not offer."""

from __future__ import annotations

import sys
from typing import Any

_ADVICE = "Use Linux, or macOS, or on Windows WSL or a container."


class Unavailable(OSError):
    """The operating system does not offer what the program needs.

    Attributes
    ----------
    what : str
        What it does not offer, in the plural: "limits on memory".
    """

    def __init__(self, what: str, advice: str = _ADVICE) -> None:
        super().__init__(f"{what} are not available on {sys.platform}. {advice}")
        self.what, self.advice = what, advice

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by what it is made of."""
        return type(self), (self.what, self.advice)
