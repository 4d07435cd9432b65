"""Derivatives of curves in boundary units: per um, per mm of a length, per N m."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from fe_contact.microgeometry import CurveDerivatives, FlankDerivatives
from lineofaction.gearbox.convert.vocabulary import boundary_name
from lineofaction.gearbox.units import MM, UM, factor

Json = dict[str, Any]


def derivatives_json(derivatives: CurveDerivatives) -> Iterator[Json]:
    """Yield the derivatives of the curve at each torque."""
    names = [boundary_name(name) for name in derivatives.names]
    flanks = {gear: derivatives.on_flank(gear) for gear in ("pinion", "wheel")}
    for k in range(derivatives.torque.size):
        by = {}
        for a, name in enumerate(names):
            scale = factor(name) / UM
            harmonics = scale * derivatives.harmonics[a, :, k]
            by[name] = {
                "ste_um": (scale * derivatives.by[a, :, k]).tolist(),
                "mean_um": float(scale * derivatives.mean[a, k]),
                "peak_to_peak_um": float(scale * derivatives.peak_to_peak[a, k]),
                "harmonics_um": [float(value) if np.isfinite(value) else None for value in harmonics],
            }
        yield {"by": by} | {gear: _flank(flank, k) for gear, flank in flanks.items()}


def _flank(flank: FlankDerivatives, k: int) -> Json:
    """Return the grid of one flank at a torque, per um removed."""
    return {
        "roll_length_mm": (flank.roll_length / MM).tolist(),
        "face_position_mm": (flank.face_position / MM).tolist(),
        "mean_um": flank.mean[k].tolist(),
        "peak_to_peak_um": flank.peak_to_peak[k].tolist(),
    }
