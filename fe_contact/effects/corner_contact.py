"""Corner contact: loaded teeth bend until tip edges touch off the line of action, before A and after E."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from fe_contact.contact.model import ContactModel
from fe_contact.effects.effect import ContactScene, Verdict
from fe_contact.geometry import Toothing

_ALONG_EDGE = 33


@dataclass(frozen=True)
class CornerContact:
    """Tip edges on the mating flanks, with exact rigid gaps and the edge law of `hertz.edge_contact`."""

    name: ClassVar[str] = "corner_contact"
    needs: ClassVar[tuple[str, ...]] = ("position", "load", "curvature")
    adds: ClassVar[tuple[str, ...]] = ("candidates", "gap")
    cost: ClassVar[str] = "two more candidates a position; no finite-element work"
    sources: ClassVar[tuple[str, ...]] = ("docs/effects/corner_contact.md",)
    valid_for: ClassVar[str] = "sharp tip edges; rounding up to the size of the contact length"

    def called_for(self, scene: ContactScene) -> Verdict:
        """On unless tip relief larger than any deflection keeps the edges apart."""
        pair = scene.pair
        deflection = _largest_deflection(scene)
        relief = min(_least_tip_relief(gear) for gear in (pair.pinion, pair.wheel))
        clear = relief > 2.0 * deflection
        reason = (
            f"tip relief {1e6 * relief:.1f} um exceeds twice the bending of {1e6 * deflection:.1f} um"
            if clear
            else f"deflections up to {1e6 * deflection:.1f} um close the gap at the tip edges"
        )
        worth = "nothing while the edges stay clear" if clear else "mean and peak-to-peak STE about 2 %"
        return Verdict(not clear, reason, worth)

    def contribute(self, scene: ContactScene, model: ContactModel) -> ContactModel:
        """Let tip edges touch."""
        return replace(model, corner_contact=True)


def _least_tip_relief(gear: Toothing) -> float:
    """Least material removed at the tip edge, m: the edge must be clear all over the face."""
    face = np.linspace(-0.5, 0.5, _ALONG_EDGE) * gear.face_width
    return float(gear.modification.material_removed(gear, gear.tip_roll_length, face).min())


def _largest_deflection(scene: ContactScene) -> float:
    """Rough upper deflection in m: line load over 14 N/(mm um), about the stiffness of ISO 6336."""
    width = min(scene.pair.pinion.face_width, scene.pair.wheel.face_width)
    return float(scene.torque.max()) / scene.pair.pinion.base_radius / width / 14e9
