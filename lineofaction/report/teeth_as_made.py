"""Flanks of all teeth of a gear as made, and of the tooth that deviates most, as maps."""

from __future__ import annotations

import numpy as np

from fe_contact.contact.model import ContactModel, MeetingTeeth
from fe_contact.effects import EFFECTS, ContactScene, compose
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray
from lineofaction.gearbox.units import DEGREE, MM, UM
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Panel, number

_ROLLS, _FACES = 41, 41  # points of a map over roll angle and face
_DECIMALS = 6
"""Decimals of a deviation in µm that are more than rounding."""
_LABEL = "material in excess, µm"
_UNLOADED = np.array([1.0])  # N: a scene needs a load; the gaps of teeth do not depend on it


def teeth_as_made(pair: ParallelAxes) -> tuple[Figure, ...]:
    """Return the maps of the gears whose teeth differ: pitch, run-out, waves and flanks together."""
    model, _ = compose(ContactScene(pair, _UNLOADED, EFFECTS), {})
    drawn = (_figure(pair, model, gear) for gear in sorted({term.gear for term in model.tooth_gaps}))
    return tuple(figure for figure in drawn if figure is not None)


def excess_of_teeth(
    pair: ParallelAxes, model: ContactModel, gear: int, roll: FloatArray, face: FloatArray
) -> FloatArray:
    """Return the excess of a gear's teeth towards the mate at the points of contact, (z, R, Z) in m.

    Parameters
    ----------
    gear : int
        0 is the pinion, 1 the wheel.
    roll, face : ndarray, shapes (R,), (Z,)
        Roll lengths, and distances from the mid-face of the gear, m.
    """
    toothing = (pair.pinion, pair.wheel)[gear]
    tooth = np.arange(toothing.teeth)[:, None, None]
    mate_face = face + (pair.axial_offset if gear else 0.0)
    teeth = MeetingTeeth(pair, tooth, roll[:, None], roll[:, None], mate_face)
    gaps = [term(teeth) for term in model.tooth_gaps if term.gear == gear]
    return -np.asarray(sum(np.broadcast_to(gap, (toothing.teeth, roll.size, face.size)) for gap in gaps))


def _figure(pair: ParallelAxes, model: ContactModel, index: int) -> Figure | None:
    """Return the maps of a gear; None where its teeth are as designed."""
    gear, name = (pair.pinion, pair.wheel)[index], ("pinion", "wheel")[index]
    first, last = sorted((gear.form_roll_length, gear.tip_form_roll_length))
    roll = np.linspace(first, last, _ROLLS)
    face = np.linspace(-0.5, 0.5, _FACES) * gear.face_width
    excess = np.round(excess_of_teeth(pair, model, index, roll, face) / UM, _DECIMALS)
    if not excess.any():
        return None
    shape = excess - excess.mean(axis=(1, 2), keepdims=True)
    worst = int(np.argmax(np.ptp(shape, axis=(1, 2))))
    angle = Axis(f"roll angle of the {name}, °")
    middle, maximum = excess[:, :, _FACES // 2], float(np.abs(excess).max())
    largest_shape = float(np.abs(shape[worst]).max())
    rolled = roll / gear.base_radius / DEGREE
    all_teeth = HeatMap(np.arange(1.0, gear.teeth + 1.0), rolled, middle.T, _LABEL, maximum, -maximum)
    panels = [Panel(Axis("tooth"), angle, title="All teeth at mid-face", shade=all_teeth)]
    if largest_shape > 0.0:
        worst_tooth = HeatMap(face / MM, rolled, shape[worst], _LABEL, largest_shape, -largest_shape)
        x = Axis("face position, mm (0 = mid-face)")
        panels.append(Panel(x, angle, title=f"Tooth {worst + 1} less its mean", shade=worst_tooth))
    return Figure(
        key=f"teeth_of_the_{name}",
        title=f"Flanks of the {name} as made",
        caption="Deviation from the designed flank along the line of action where a tooth touches its mate: "
        "pitch, run-out, waves and flanks of single teeth together. Teeth count in the order of meshing."
        + (f" Lower: tooth {worst + 1}, whose flank differs most." if largest_shape > 0.0 else ""),
        alternative=f"The teeth of the {name} stand between {number(float(middle.min()), 3)} and "
        f"{number(float(middle.max()), 3)} µm out at mid-face; the flank of tooth {worst + 1} differs by "
        f"{number(float(np.ptp(shape[worst])), 3)} µm over itself.",
        content=tuple(panels),
    )
