"""One effect toggled, all others as they were decided."""

from __future__ import annotations

from collections.abc import Mapping

from fe_contact.effects.face_load_distribution import FaceLoadDistribution
from fe_contact.effects.finite_width import FiniteWidth


def flipped(decided: Mapping[str, str], name: str, choice: str) -> dict[str, str]:
    """Return the choices with `name` on or off.

    The plane that stands in for three dimensions is corrected for its finite width where it can be, and three
    dimensions need no correction.

    Parameters
    ----------
    decided : mapping of str to str
        Every effect "on" or "off".
    name, choice : str
    """
    choices = {**decided, name: choice}
    if name == FaceLoadDistribution.name:
        choices[FiniteWidth.name] = "auto" if choice == "off" else "off"
    if name == FiniteWidth.name and choice == "on":
        choices[FaceLoadDistribution.name] = "off"
    return choices
