"""What happens on the flanks of a live question: pressure over the flank, load over the face, K_Hbeta."""

from __future__ import annotations

from typing import Any

from fe_contact.analysis import LoadDistribution, pressure_map
from fe_contact.types import FloatArray
from lineofaction.gearbox.units import MM

Json = dict[str, Any]

_MPA = 1e6
_N_PER_MM = 1e3
_DIGITS = 5


def flanks_json(flanks: LoadDistribution) -> Json:
    """Return the results on the flanks; K_Hbeta is null in the plane, whose load is even by assumption."""
    roll, pressure = pressure_map(flanks, flanks.roll_length_1)
    load = flanks.face_load
    worst = int(load.max(axis=-1).argmax())
    over_face = flanks.face_position.size > 1
    return {
        "largest_pressure_mpa": float(flanks.clear_pressure.max() / _MPA),
        "edge_pressure_mpa": flanks.edge_pressure / _MPA,
        "k_h_beta": flanks.mean_face_load_factor if over_face else None,
        "roll_length_mm": _short(roll / MM),
        "face_position_mm": _short(flanks.face_position / MM),
        "pressure_mpa": [_short(row) for row in pressure / _MPA],
        "mean_load_n_per_mm": _short(load.mean(axis=0) / _N_PER_MM),
        "worst_load_n_per_mm": _short(load[worst] / _N_PER_MM),
        "worst_position": float(flanks.position[worst]),
    }


def _short(values: FloatArray) -> list[float]:
    """Return numbers of five digits: they are drawn."""
    return [float(f"{value:.{_DIGITS}g}") for value in values]
