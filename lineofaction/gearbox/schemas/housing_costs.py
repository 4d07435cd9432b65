"""Cost of work on housings, in figures."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Part


class PredictedCost(Part):
    """Predicted CPU seconds on the host that computed the result, and bytes of the largest working set."""

    cpu_seconds: float
    bytes: float


class HousingCost(Part):
    """Cost of work on a housing: bytes are null where the process had been as large before."""

    predicted_cpu_seconds: float
    predicted_bytes: float
    cpu_seconds: float
    bytes: float | None
