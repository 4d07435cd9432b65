"""Errors of the excitations at one load of a table: transmission error, load arm, sense of sliding."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from fe_contact.analysis.estimates.half_position_errors import errors_by_halves
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES, METHOD, all_sources, errors_by_source
from fe_contact.ste.curve_quantities import FIRST_HARMONIC, HARMONICS, MEAN, OFF_MESH, mean_of_curves
from fe_contact.ste.extraction import sliding_sums
from fe_contact.ste.operating_point import OperatingPoint
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class ExcitationErrors:
    """Errors (20,) of the amplitudes of the mesh harmonics, >= 0; NaN: not estimated."""

    transmission_error: FloatArray
    load_arm: FloatArray
    """`transmission_error`, `load_arm`: Errors in m. Those of the transmission error contain the model error.
    """
    friction: FloatArray
    """Error of the friction force over the largest one, the coefficient of friction times the mesh force."""
    off_mesh: float
    """Error of the transmission error in any order that is no mesh order, m."""


def excitation_errors(table: SteDatabase, force: float) -> ExcitationErrors:
    """Return the errors at a normal force in N, of the alignments of the table the largest.

    Beyond the stored loads they are those of the nearest. Load shares err at most by the part by which the
    mean transmission error does, if one pair's errs and that of the other does not: by it the friction errs,
    and by what half of the positions miss.
    """
    at = float(np.clip(force, table.force[0], table.force[-1]))
    of_ste, of_arm, of_shares = (np.zeros(HARMONICS) for _ in range(3))
    of_load = 0.0
    mean = mean_of_curves(table.position, table.static_transmission_error, table.period)
    for m, d in product(range(table.misalignment.size), range(table.center_distance_change.size)):
        sources = _source_errors(table, at, m, d)
        errors = all_sources(sources)
        of_ste, of_load = (
            np.maximum(of_ste, errors[FIRST_HARMONIC:]),
            np.maximum(of_load, errors[OFF_MESH]),
        )
        of_mesh = all_sources(np.delete(sources, AT_NODES.index(METHOD), axis=0))[MEAN]
        of_shares = np.maximum(of_shares, of_mesh / np.interp(at, table.force, mean[:, m, d]))
        if table.load_arm_error.size:
            arms = all_sources(table.load_arm_error[:, FIRST_HARMONIC:, :, m, d])
            of_arm = np.maximum(of_arm, [np.interp(at, table.force, curve) for curve in arms])
    unknown = np.full(HARMONICS, np.nan)
    sliding, _ = sliding_sums(table)
    between = errors_by_halves(table.position, sliding.reshape(len(sliding), -1), table.period).curves
    by_load = between.reshape(-1, *sliding.shape[1:]).max(axis=(2, 3))
    between_positions = np.array([np.interp(at, table.force, curve) for curve in by_load[FIRST_HARMONIC:]])
    arm = of_arm if table.load_arm_error.size else unknown
    return ExcitationErrors(of_ste, arm, np.hypot(of_shares, between_positions), float(of_load))


def _source_errors(table: SteDatabase, force: float, m: int, d: int) -> FloatArray:
    """Return the errors (sources, 23) of the transmission error by source at an alignment, m.

    An interval of loads that was not assessed, as of condensed gears, adds nothing.
    """
    if not table.curve_error.size:
        return np.full((len(AT_NODES), FIRST_HARMONIC + HARMONICS), np.nan)
    alignment = float(table.misalignment[m]), float(table.center_distance_change[d])
    errors = errors_by_source(table, OperatingPoint(force, *alignment))
    between = np.nan_to_num(errors[len(AT_NODES) :])
    return np.concatenate([errors[: len(AT_NODES)], between])
