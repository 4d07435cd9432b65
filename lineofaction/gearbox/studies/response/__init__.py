"""Speeds at which the forced response is looked for."""

from __future__ import annotations

from lineofaction.gearbox.schemas.figures import (
    Equilibrium,
    Excitations,
    Figures,
    Ledger,
    Part,
    ReductionCosts,
    Seconds,
)
from lineofaction.gearbox.schemas.studied import OverOrders


class Inputs(OverOrders):
    """Speeds at which the forced response is looked for."""


class Power(Part):
    """Mean power that errors of meshes and loads put in, where it is lost, and the rest over the input."""

    class PowerLoss(Part):
        """Mean power that a part loses by order, then by speed."""

        part: str
        kind: str
        loss_w: list[list[float]]

    input_w: dict[str, list[list[float]]]
    losses: list[PowerLoss]
    residual: float


class ResponseFigures(Figures):
    """Amplitudes of meshes and bearings, peaks, and the speeds at which flanks would part."""

    class MeshResponse(Part):
        """Amplitudes of a mesh by order, then by speed."""

        mean_force_n: float
        mean_stiffness_n_per_um: float
        static_transmission_error_um: list[float]
        load_moment_n_m: list[float]
        friction_force_n: list[float]
        dynamic_transmission_error_um: list[list[float]]
        mesh_force_n: list[list[float]]
        least_mesh_force_n: list[float]
        excitation_difference: list[float]

    class BearingResponse(Part):
        """Amplitudes of a bearing force by order, then by speed; root mean squares of all orders by speed.

        `left_out_rms_n` is the part of `rms_n` that orders of long tables make which are not listed, and
        `rms_error_n` what it may be off for them.
        """

        force_n: list[list[float]]
        rms_n: list[float]
        left_out_rms_n: list[float]
        rms_error_n: list[float]

    class PeakFigures(Part):
        """A peak over speed."""

        quantity: str
        name: str
        order: float
        speed_rpm: float
        frequency_hz: float
        amplitude_n: float
        amplification: float
        natural_frequency_hz: float

    leading_shaft: str
    speed_rpm: list[float]
    order: list[float]
    order_name: list[str]
    meshes: dict[str, MeshResponse]
    bearings: dict[str, BearingResponse]
    excitations: Excitations
    peaks: list[PeakFigures]
    parting_rpm: list[float]
    natural_frequency_hz: list[float]
    power: Power
    residual: float
    equilibrium: Equilibrium
    cpu_seconds: Seconds
    reduction_cost: ReductionCosts
    effect_ledger: Ledger
