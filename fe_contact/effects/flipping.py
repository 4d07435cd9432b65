"""One effect toggled, all others as they were decided."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fe_contact.effects.effect import Effect, named


def flipped(registry: Sequence[Effect], decided: Mapping[str, str], name: str, choice: str) -> dict[str, str]:
    """Return the choices with `name` on or off.

    The plane that stands in for three dimensions is corrected for its finite width where it can be, and three
    dimensions need no correction.

    Parameters
    ----------
    registry : sequence of Effect
    decided : mapping of str to str
        Every effect "on" or "off".
    name, choice : str
    """
    choices = {**decided, name: choice}
    face, width = named(registry, "across_face"), named(registry, "finite_width")
    if name == face:
        choices[width] = "auto" if choice == "off" else "off"
    if name == width and choice == "on":
        choices[face] = "off"
    return choices
