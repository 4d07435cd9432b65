"""Pairs that the full contact in plane strain is set up for."""

from __future__ import annotations

from fe_contact.geometry import CLAMPED, ParallelAxes, Toothing


def refusal(pair: ParallelAxes) -> str | None:
    """Say why a pair is not one of two clamped, solid spur gears; None if it is."""
    if pair.pinion.helix_angle != 0.0:
        return "helical: plane strain holds spur pairs only"
    if pair.shafts != (None, None):
        return "shafts: the bores are held rigidly"
    for gear in (pair.pinion, pair.wheel):
        if (reason := _of_gear(gear)) is not None:
            return reason
    return None


def _of_gear(gear: Toothing) -> str | None:
    """Say what of a gear it has no room for."""
    if gear.web is not None:
        return "rim, web and hub: one section stands for the whole face"
    if gear.seat != CLAMPED:
        return "seat of the bore: it is rigid"
    if gear.pitch_deviation.cumulative:
        return "pitch deviations: all teeth are alike"
    if gear.modification.varies_along_face:
        return "flanks that vary across the face"
    if gear.tip_form_roll_length != gear.tip_roll_length:
        return "rounded or chamfered tips: those of its meshes are sharp"
    return None
