"""Inputs and figures of the study of a complaint about a sound."""

from __future__ import annotations

from lineofaction.gearbox.schemas.complaint import ComplaintFields
from lineofaction.gearbox.schemas.figures import Equilibrium, Figures, Ledger, Part, ReductionCosts, Seconds


class Inputs(ComplaintFields):
    """Fields of a complaint; case or scene supply the fields that are left out."""


class ComplaintFigures(Figures):
    """Excitations near the order of the complaint by likelihood, and modes near its frequency."""

    class PassingFigures(Part):
        """A harmonic of a mesh, a shaft or a bearing, or a sideband of one.

        Its force is that of the linear response; the excitation is transmission error times mean stiffness.
        """

        kind: str
        name: str
        part: str
        harmonic: int
        order: float
        frequency_hz: float | None
        distance_percent: float
        bearing: str
        force_n: float | None
        excitation_n: float | None

    class ModeFigures(Part):
        """A mode by which the frequency is amplified."""

        frequency_hz: float
        damping_ratio: float
        distance_percent: float
        amplification: float
        kind: str

    words: str
    shaft: str
    order: float
    frequency_hz: float | None
    speed_rpm: float | None
    tolerance_percent: float
    torque_n_m: dict[str, float]
    ranked_by: str
    passing: list[PassingFigures]
    nearest: list[PassingFigures]
    modes: list[ModeFigures]
    parting_percent: float
    equilibrium: Equilibrium | None
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger | None
