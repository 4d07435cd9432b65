"""The loaded equilibrium that studies of a scene start from, in their figures."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Json, Part


class Equilibrium(Part):
    """The loaded equilibrium."""

    status: str
    residual_n: float


def equilibrium_figures(found: Json) -> Json:
    """Return the figures of an `Equilibrium`, of what a result says of it: status, and residual in N."""
    return {"status": found["status"].lower(), "residual_n": found["residual"]}
