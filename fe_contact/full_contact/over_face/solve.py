"""Full finite-element contact over the face: positions x torques x misalignments."""

from __future__ import annotations

from collections.abc import Sequence

from fe_contact.checks import finite
from fe_contact.errors import InputError
from fe_contact.full_contact.condensation.resolution import Resolution
from fe_contact.full_contact.condensation.solve import Report, contact_tables, resolutions
from fe_contact.full_contact.condensation.table import FullContactTable
from fe_contact.full_contact.over_face.face_model import WholeFace
from fe_contact.full_contact.validity import refusal_over_face
from fe_contact.geometry import ParallelAxes

USUAL = Resolution(per_half_width=2.5, layers=7)


def solve_full_contact_over_face(
    pair: ParallelAxes,
    torques: Sequence[float],
    positions: Sequence[float],
    misalignments: Sequence[float] = (0.0,),
    resolution: Resolution = USUAL,
    *,
    estimate_error: bool = False,
    report: Report | None = None,
) -> tuple[FullContactTable, ...]:
    """Solve the contact of a spur pair in three dimensions with all teeth, bodies and the contact resolved.

    The plane mesh of a position, extruded: 15-node wedges over half the face, the halves joined by an even
    and an odd problem. One condensation of each gear serves all torques and misalignments, which enter with
    the modification of the flanks through the gap.

    Parameters
    ----------
    pair : GearPair
        Spur, clamped, solid, of equal faces; any modification of sharp-tipped flanks (`refusal_over_face`).
    torques : sequence of float
        On gear 1, N m, > 0.
    positions : sequence of float
        By the driving gear, base pitches.
    misalignments : sequence of float
        Growth of the gap over the face in the plane of action, zero at mid-face, m.
    resolution : Resolution, optional
    estimate_error : bool
        Solve on a mesh with fewer layers and larger elements too, and state the difference as error.
    report : callable, optional
        Called with the fraction done before each position.

    Returns
    -------
    tuple of FullContactTable
        One for each misalignment, which share CPU seconds evenly.

    Raises
    ------
    InputError
        A pair that it does not hold, a torque that is not positive, a misalignment that is no number.
    """
    if (reason := refusal_over_face(pair)) is not None:
        raise InputError("pair", "this pair", f"one that full contact over the face holds; {reason}")
    if len(misalignments) == 0:
        raise InputError("misalignments", "none", "at least one number")
    for misalignment in misalignments:
        finite("misalignments", misalignment, "In m: 30 um is 30e-6.")
    meshes = resolutions(resolution, estimate_error=estimate_error)
    model = WholeFace(tuple(float(misalignment) for misalignment in misalignments))
    return contact_tables(model, pair, torques, positions, meshes, report)
