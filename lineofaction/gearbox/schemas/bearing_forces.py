"""Where the bearing forces of a study of housings come from."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import Part


class BearingForces(Part):
    """A linear response, or orders of a run: how its windows hold. Lists are by order, then by window."""

    source: str
    time_s: list[float] | None = None
    window_pitches: int | None = None
    windows_left_out: int | None = None
    speed_change: list[float] | None = None
    smearing: list[list[float]] | None = None
    remainder: dict[str, list[float]] | None = None
    other_housings: list[str] | None = None
