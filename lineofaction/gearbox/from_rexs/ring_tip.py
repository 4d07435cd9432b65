"""The tip of a ring gear whose file leaves it out: clear of the fillet of the mate."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from fe_contact.errors import FeContactError
from fe_contact.geometry import Gear
from lineofaction.gearbox.from_rexs.profile_shifts import ToothedPair
from lineofaction.gearbox.from_rexs.tooth_depth import ToothDepth
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM

_STEP = 0.01 * MM  # tip diameters are rounded up to it


def clearing_tip(pair: ToothedPair, depths: Sequence[ToothDepth], shifts: Mapping[int, float]) -> ToothDepth:
    """Return the ring gear's depth with a tip on the involute of its mate; `depths` are of pinion and ring.

    The tip meets the mate's form circle at the roll length l_F1 + a sin(alpha_wt) of the ring gear.
    """
    ring, depth = pair.wheel, depths[1]
    base = 0.5 * ring.reference_diameter * math.cos(ring.transverse_pressure_angle)
    tangent = pair.center_distance * math.sin(pair.working_pressure_angle)
    minimum = 2.0 * math.hypot(base, _form_roll_length(pair, depths[0], shifts) + tangent)
    if depth.tip_diameter > minimum:
        return depth
    tip = math.ceil(minimum / _STEP + 1e-3) * _STEP  # above the minimum by at least a thousandth of a step
    text = f"{tip / MM:.7g} mm, above {minimum / MM:.7g} mm = 2 sqrt(r_b2^2 + (l_F1 + a sin alpha_wt)^2),"
    text += f" where the tip meets the form circle of {pair.pinion.part.name}; d - 2 m_n (x + h_aP) would be"
    ring.part.say("tip_diameter", "defaulted", f"{text} {depth.tip_diameter / MM:.7g} mm")
    return replace(depth, tip_diameter=tip)


def _form_roll_length(pair: ToothedPair, depth: ToothDepth, shifts: Mapping[int, float]) -> float:
    gear, shift = pair.pinion, shifts[pair.pinion.part.id]
    try:
        return Gear(
            gear.teeth,
            gear.normal_module,
            gear.face_width,
            0.1 * gear.reference_diameter,  # any bore: the flank does not depend on it
            normal_pressure_angle=gear.pressure_angle,
            helix_angle=gear.helix_angle,
            profile_shift_coefficient=shift,
            dedendum_coefficient=depth.dedendum_coefficient,
            root_radius_coefficient=depth.root_radius_coefficient,
            tip_diameter=depth.tip_diameter,
            thickness_allowance=depth.thickness_allowance,
            tooth_thinning=depth.tooth_thinning,
        ).form_roll_length
    except FeContactError as error:
        raise BadInput.of(gear.part.location, gear.part.name, f"a gear that exists: {error}") from None
