"""Refusal of requests that their model does not hold.

A plane model holds nothing that acts across the face; a model in three dimensions holds no sectors of gears.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bounds import DEPTHS
from fe_contact.contact import ContactModel
from fe_contact.effects import ContactScene, LedgerEntry
from fe_contact.errors import InputError
from fe_contact.flank.modification import fields_of
from fe_contact.geometry import FlankModification


def refuse_beyond_plane(scene: ContactScene, model: ContactModel, ledger: Sequence[LedgerEntry]) -> None:
    """Refuse parts of a request that act across the face where the model is a plane.

    These are helix, flanks that vary along the face, shafts, misalignment, and what the effects refuse. A
    model in three dimensions refuses sectors between cut planes.
    """
    if model.across_face:
        for name, gear in scene.gears.items():
            if gear.sector_teeth is not None:
                bound = "left out for a model in three dimensions"
                raise InputError(f"{name}.sector_teeth", gear.sector_teeth, bound, "Its rings are whole.")
        return
    pair, remedy = scene.pair, "Use the 3-D model for it."
    if pair.pinion.helix_angle != 0.0:
        raise InputError("pinion.helix_angle", pair.pinion.helix_angle, "0 for a plane model", remedy)
    for (name, gear), shaft in zip(scene.gears.items(), pair.shafts, strict=True):
        _refuse_varying_flanks(f"{name}.modification", gear.modification.along_face, remedy)
        if shaft is not None:
            raise InputError(f"{name}.shaft", "given", "left out for a plane model", remedy)
    if np.any(scene.misalignment != 0.0):
        raise InputError("misalignments", scene.misalignment.tolist(), "[0.0] for a plane model", remedy)
    for entry in ledger:
        if entry.on:
            scene.effect(entry.name).refuse_plane(scene)


def _refuse_varying_flanks(field: str, along_face: FlankModification, remedy: str) -> None:
    bound = "constant along the face for a plane model"
    for name in fields_of(*DEPTHS):
        if amount := getattr(along_face, name):
            raise InputError(f"{field}.{name}", amount, f"0: {bound}", remedy)
    if along_face.flank_grid is not None:
        raise InputError(f"{field}.flank_grid.removed", along_face.flank_grid.removed, bound, remedy)
