"""Results of a cylindrical stage: contact ratios, stiffness over the mesh, transmission error."""

from __future__ import annotations

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.ste import Curve, SteDatabase
from lineofaction.gearbox.convert.case import boundary_errors
from lineofaction.gearbox.rexs import Attribute
from lineofaction.gearbox.to_rexs.calculated import calculated
from lineofaction.gearbox.units import UM

POSITIONS = 64
"""Positions of the curves in one base pitch."""
_N_PER_MM = 1e3


def stage_results(
    pair: ParallelAxes, database: SteDatabase, torque: float | None = None
) -> tuple[Attribute, ...]:
    """Return the attributes of a ``cylindrical_stage``.

    REXS has no attribute of the transmission error: it stands in custom ones, along the transverse line of
    action, > 0 where the driven gear lags, over positions of the driving gear in transverse base pitches; 0:
    the reference pair touches at the pitch point.

    Parameters
    ----------
    pair : ParallelAxes
        The gears of the stage.
    database : SteDatabase
        Of the same gears.
    torque : float, optional
        On gear 1, N m; the largest stored by default.

    Raises
    ------
    BadInput
        The torque is outside what is stored.
    JobFailed
        The table has failed points.
    """
    at = np.arange(POSITIONS * database.period) / POSITIONS
    load = float(database.torque[-1]) if torque is None else torque
    with boundary_errors():
        curve = database.curve(torque=load, at=at)
        stiffness = np.asarray(database.force_at(at, curve.ste).stiffness)
    return (*_contact_ratios(pair), *_mesh(curve, stiffness))


def _contact_ratios(pair: ParallelAxes) -> tuple[Attribute, ...]:
    """Return the contact ratios between the tip circles."""
    return (
        calculated("radial_contact_ratio", pair.transverse_contact_ratio, "none"),
        calculated("overlap_contact_ratio", pair.overlap_ratio, "none"),
        calculated("total_contact_ratio", pair.total_contact_ratio, "none"),
    )


def _mesh(
    curve: Curve, stiffness: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> tuple[Attribute, ...]:
    """Return tangent stiffness and transmission error over the mesh at the curve's load."""
    harmonics = [estimate.value / UM for estimate in curve.harmonics]
    return (
        calculated("meshing_stiffness_characteristic", (stiffness / _N_PER_MM).tolist(), "N / mm"),
        calculated("custom_mesh_positions", curve.position.tolist(), "none"),
        calculated("custom_torque_on_driving_gear", curve.torque, "N m"),
        calculated("custom_transmission_error", (curve.ste / UM).tolist(), "mum"),
        calculated("custom_transmission_error_mean", curve.mean.value / UM, "mum"),
        calculated("custom_transmission_error_peak_to_peak", curve.peak_to_peak.value / UM, "mum"),
        calculated("custom_transmission_error_harmonics", harmonics, "mum"),
    )
