"""Pairs and axes that the full contact is set up for, in the plane and over the face."""

from __future__ import annotations

from collections.abc import Sequence

from fe_contact.errors import InputError, finite, positive
from fe_contact.geometry import CLAMPED, ParallelAxes, Toothing


def refusal(pair: ParallelAxes) -> str | None:
    """Say why a pair is not one of two clamped, solid spur gears alike all along the face; None if it is."""
    if (reason := _spur(pair) or _of_pair(pair)) is not None:
        return reason
    if any(gear.modification.varies_along_face for gear in (pair.pinion, pair.wheel)):
        return "flanks that vary across the face"
    return None


def refusal_over_face(pair: ParallelAxes) -> str | None:
    """Say why a pair is not one of two clamped, solid spur gears of equal faces; None if it is."""
    return _spur(pair) or _of_pair(pair) or _of_faces(pair)


def refusal_helical(pair: ParallelAxes) -> str | None:
    """Say why a pair is not one of two clamped, solid external gears of equal faces; None if it is."""
    if (reason := _of_pair(pair)) is not None:
        return reason
    if pair.internal:
        return "ring gear: in the frame that turns with the helix it is set up for external pairs"
    return _of_faces(pair)


def _of_faces(pair: ParallelAxes) -> str | None:
    """Say why the faces of a pair cannot be meshed in the same layers."""
    widths = (pair.pinion.face_width, pair.wheel.face_width)
    if max(widths) - pair.face_width > 1e-9 * pair.face_width:
        return "unlike or offset faces: both are meshed in the same layers"
    return None


def _spur(pair: ParallelAxes) -> str | None:
    if pair.pinion.helix_angle != 0.0:
        return "helical: its meshes are plane ones, which hold spur pairs only"
    return None


def _of_pair(pair: ParallelAxes) -> str | None:
    """Return why the meshes of sections cannot hold a pair; None if they can."""
    if pair.shafts != (None, None):
        return "shafts: the bores are held rigidly"
    for gear in (pair.pinion, pair.wheel):
        if (reason := _of_gear(gear)) is not None:
            return reason
    return None


def _of_gear(gear: Toothing) -> str | None:
    """Return why the meshes of sections cannot hold a gear; None if they can."""
    if gear.web is not None:
        return "rim, web and hub: one section stands for the whole face"
    if gear.sector_teeth is not None:
        return "sector: the whole gear is meshed"
    if gear.seat != CLAMPED:
        return "seat of the bore: it is rigid"
    if not gear.pitch_deviation.neutral or gear.deviates:
        return "deviations of single teeth: all teeth are alike"
    if gear.tip_form_roll_length != gear.tip_roll_length:
        return "rounded or chamfered tips: those of its meshes are sharp"
    return None


def check_axes(
    torques: Sequence[float], positions: Sequence[float], misalignments: Sequence[float] = (0.0,)
) -> None:
    """Refuse an axis without a number, torques that are not positive, and values that are no numbers."""
    axes = {"torques": torques, "positions": positions, "misalignments": misalignments}
    for name, values in axes.items():
        if len(values) == 0:
            raise InputError(name, "none", "at least one number")
    for torque in torques:
        positive("torques", torque, "On gear 1, in N m.")
    for position in positions:
        finite("positions", position, "By the driving gear, in base pitches.")
    for misalignment in misalignments:
        finite("misalignments", misalignment, "In m: 30 µm is 30e-6.")
