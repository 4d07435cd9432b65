"""Results of a stage under a load case: misalignment, load along the face, contact stress."""

from __future__ import annotations

import math

from dynamics.deflection import MeshAlignment
from lineofaction.gearbox.rexs.model import Attribute
from lineofaction.gearbox.studies.deflect.result import MeshFlanks
from lineofaction.gearbox.to_rexs.attributes import calculated
from lineofaction.gearbox.units import MM, UM

_PA_PER_MPA, _N_PER_M = 1e6, 1e3  # Pa in a MPa, N/m in a N/mm


def alignment_results(mesh: MeshAlignment, sense: int) -> tuple[Attribute, ...]:
    """Return the misalignment of a stage, mean over the mesh cycle.

    The attribute of ISO 6336 is its size without running-in allowance. A custom attribute has its sign: > 0
    where the gap between the flanks grows along u of gear 1's shaft. `sense` is +1 where the case's face
    positions count along that u, -1 against it.
    """
    return (
        calculated("effective_equivalent_misalignment_iso_6336_2019", abs(mesh.misalignment) / UM, "mum"),
        calculated("custom_misalignment", sense * mesh.misalignment / UM, "mum"),
    )


def flank_results(flanks: MeshFlanks, sense: int) -> tuple[Attribute, ...]:
    """Return the load along the face and derived figures, by increasing u of gear 1's shaft.

    Nodes count from the end of the face of the lower u. K_Hbeta is left out where the model is plane.
    `sense` is as of `alignment_results`.
    """
    order = slice(None, None, sense)
    along = sense * flanks.face_position[order]
    pattern = flanks.pattern[:, order] / _PA_PER_MPA
    face_load = flanks.face_load[order] / _N_PER_M
    factor = flanks.face_load_factor
    return (
        calculated("load_distribution_node_positions", ((along - along[0]) / MM).tolist(), "mm"),
        calculated("load_distribution_along_face_width", face_load.tolist(), "N / mm"),
        *(() if math.isnan(factor) else (calculated("face_load_factor_contact_stress", factor, "none"),)),
        calculated("custom_largest_contact_stress", flanks.largest_pressure / _PA_PER_MPA, "MPa"),
        calculated("custom_contact_pattern_roll_lengths", (flanks.roll_length / MM).tolist(), "mm"),
        calculated("custom_contact_pattern", pattern.ravel().tolist(), "MPa"),
        calculated("custom_transmission_error_mean", flanks.mean / UM, "mum"),
        calculated("custom_transmission_error_peak_to_peak", flanks.peak_to_peak / UM, "mum"),
        calculated("custom_transmission_error_harmonics", (flanks.harmonics / UM).tolist(), "mum"),
        calculated("custom_torque_on_driving_gear", flanks.torque, "N m"),
    )
