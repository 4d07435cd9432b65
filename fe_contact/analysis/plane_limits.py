"""What a plane model cannot hold: all that acts across the face."""

from __future__ import annotations

import numpy as np

from bounds import DEPTHS
from fe_contact.contact import ContactModel
from fe_contact.effects import ContactScene
from fe_contact.errors import InputError
from fe_contact.flank.modification import fields_of
from fe_contact.geometry import CLAMPED, FlankModification


def refuse_beyond_plane(scene: ContactScene, model: ContactModel) -> None:
    """Refuse what acts across the face where the model is a plane.

    Raises
    ------
    InputError
        Helix, flanks that vary along the face, shafts, misalignment; a web off mid-face or a seat of the bore
        where the model has rims or seats; by field name.
    """
    if model.across_face:
        return
    _refuse_face_effects(scene)
    if model.thin_rim:
        _refuse_web_off_center(scene)
    if model.bore_seat:
        _refuse_seats(scene)


def _refuse_face_effects(scene: ContactScene) -> None:
    """Refuse what varies or moves across the face."""
    pair, advice = scene.pair, "Use the 3-D model for it."
    if pair.pinion.helix_angle != 0.0:
        raise InputError("pinion.helix_angle", pair.pinion.helix_angle, "0 for a plane model", advice)
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        _refuse_varying_flanks(f"{name}.modification", gear.modification.along_face, advice)
        if pair.shafts[name == "wheel"] is not None:
            raise InputError(f"{name}.shaft", "given", "left out for a plane model", advice)
    if np.any(scene.misalignment != 0.0):
        raise InputError("misalignments", scene.misalignment.tolist(), "[0.0] for a plane model", advice)


def _refuse_varying_flanks(field: str, along_face: FlankModification, advice: str) -> None:
    """Refuse what a flank has along the face, by the amount that varies."""
    bound = "constant along the face for a plane model"
    for name in fields_of(*DEPTHS):
        if amount := getattr(along_face, name):
            raise InputError(f"{field}.{name}", amount, f"0: {bound}", advice)
    if along_face.flank_grid is not None:
        raise InputError(f"{field}.flank_grid.removed", along_face.flank_grid.removed, bound, advice)


def _refuse_web_off_center(scene: ContactScene) -> None:
    """Refuse a web that tilts its gear: the plane has no tilt."""
    for name, gear in (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel)):
        if gear.web is not None and gear.web.low + gear.web.high != 0.0:
            offset, advice = 0.5 * (gear.web.low + gear.web.high), "Use the 3-D model for it."
            raise InputError(f"{name}.blank.web_offset", offset, "0 for a plane model", advice)


def _refuse_seats(scene: ContactScene) -> None:
    """Refuse seats of bores: in the plane every bore is fixed."""
    for name, gear in (("pinion", scene.pair.pinion), ("wheel", scene.pair.wheel)):
        if gear.seat != CLAMPED:
            advice = "Use the 3-D model for it."
            raise InputError(f"{name}.seat", "given", "left out for a plane model", advice)
