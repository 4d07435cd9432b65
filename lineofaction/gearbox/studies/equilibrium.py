"""The loaded equilibrium that studies of a scene start from, in their figures."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Json, Part


class Equilibrium(Part):
    """The loaded equilibrium."""

    status: str
    residual_n: float


def equilibrium_figures(found: Json) -> Json:
    """Return what a result says of its equilibrium for an `Equilibrium`: the status as it is written."""
    return {**found, "status": found["status"].lower()}
