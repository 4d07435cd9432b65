"""A gear pair from few arguments; rules of thumb give the rest of its data."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from fe_contact.geometry import Gear
from fe_contact.geometry.backlash import reference_center_distance
from fe_contact.geometry.balanced_shifts import balanced_shifts
from lineofaction.cli.options import PairWishes
from lineofaction.gearbox.units import DEGREE, MM

OVERLAP = 1.5
"""Overlap ratio that a helical face width makes."""
LOAD = 60.0
"""Tangential force over face width and module, N/mm^2: roughly the endurable load of hardened gears."""
_FRACTIONS = (0.1, 0.25, 0.5, 0.75, 1.0)
"""Torques of a case over the torque of `LOAD`."""
_BORE = 0.45
"""Bore diameter over root diameter."""
_RIM = 3.0
"""Modules between the ring's root circle and the outside of its rim."""


@dataclass(frozen=True)
class GearSketch:
    """A gear as its case file has it, in mm and um."""

    teeth: int
    shift: float
    """Profile shift in modules."""
    bore: float
    """Diameter of the bore; of a ring gear, the outside diameter of the rim."""
    allowance: float
    """Thinning of the teeth, which makes the backlash; 0: the case file leaves it out."""


@dataclass(frozen=True)
class PairSketch:
    """A pair as its case file has it, in mm, um, deg and N m."""

    module: float
    helix: float
    width: float
    center_distance: float
    pinion: GearSketch
    wheel: GearSketch
    torque: tuple[float, ...]
    ring_addendum: float | None = None

    @property
    def internal(self) -> bool:
        """Whether the wheel is a ring gear, which then has the addendum `ring_addendum`."""
        return self.ring_addendum is not None

    @property
    def relief(self) -> tuple[float, float]:
        """Tip relief in um, near the deflection of teeth under `LOAD`, and its length in mm: 0.4 modules."""
        return round(5.0 + 5.0 * self.module), round(0.4 * self.module, 2)

    @property
    def crowning(self) -> float:
        """Lead crowning in um: a fifth of the face width in mm, at least 3."""
        return max(3, round(0.2 * self.width))


def external_pair(wishes: PairWishes, *, teeth: int, ratio: float, helix: float, module: float) -> PairSketch:
    """Return an external pair; the keywords are values for missing wishes."""
    module = wishes.module or module
    helix = helix if wishes.helix is None else wishes.helix
    first = wishes.teeth or teeth
    second = _hunting_teeth(first, wishes.ratio or ratio)
    width = wishes.width or face_width(module, helix)
    pinion, wheel = (blank_table(count, module, helix, width) for count in (first, second))
    distance = _round_up(reference_center_distance(pinion, wheel) / MM, 0.5 if module >= 1.0 else 0.1)
    shifts = balanced_shifts(pinion, wheel, distance * MM)
    allowance = float(round(20.0 * module + 10.0))
    gears = [
        GearSketch(gear.teeth, round(shift, 4), bore_diameter(gear, shift), allowance)
        for gear, shift in zip((pinion, wheel), shifts, strict=True)
    ]
    return PairSketch(module, helix, width, distance, gears[0], gears[1], _torques(pinion))


def internal_pair(wishes: PairWishes, *, teeth: int, ratio: float, module: float) -> PairSketch:
    """Return a pinion in a ring gear, without profile shift."""
    module = wishes.module or module
    helix, first = wishes.helix or 0.0, wishes.teeth or teeth
    width = wishes.width or face_width(module, helix)
    return ring_pair(module, helix, width, first, round(first * (wishes.ratio or ratio)))


def ring_pair(module: float, helix: float, width: float, teeth: int, ring_teeth: int) -> PairSketch:
    """Return a pinion in a ring gear of these numbers of teeth; lengths in mm, angles in deg."""
    pinion = blank_table(teeth, module, helix, width)
    transverse = module / math.cos(helix * DEGREE)
    rim = _round_up(transverse * ring_teeth + 2.0 * module * (1.25 + _RIM), 1.0)
    allowance = float(round(20.0 * module + 10.0))
    distance = 0.5 * transverse * (ring_teeth - teeth)
    return PairSketch(
        module,
        helix,
        width,
        distance,
        GearSketch(teeth, 0.0, bore_diameter(pinion), 0.0),
        GearSketch(ring_teeth, 0.0, rim, 2.0 * allowance),  # the ring alone makes the backlash
        _torques(pinion),
        _ring_addendum(pinion, ring_teeth, distance),
    )


def _ring_addendum(pinion: Gear, ring_teeth: int, distance: float) -> float:
    """Return the addendum in modules of a ring whose tip meets the pinion on its involute, at most 0.9."""
    ratio = ring_teeth / pinion.teeth
    tangent = distance * MM * math.sin(pinion.transverse_pressure_angle)
    minimum = math.hypot(ratio * pinion.base_radius, tangent + pinion.form_roll_length)
    largest = (ratio * pinion.reference_radius - minimum) / pinion.normal_module
    return min(0.9, math.floor(20.0 * (largest - 0.02)) / 20.0)  # 0.02 modules to spare, steps of 1/20


def _hunting_teeth(teeth: int, ratio: float) -> int:
    """Return the teeth of the wheel nearest to a ratio that have no divisor in common with the pinion's."""
    wished = teeth * ratio
    counts = sorted(range(max(4, int(wished) - 4), int(wished) + 6), key=lambda count: abs(count - wished))
    return next((count for count in counts if math.gcd(count, teeth) == 1), counts[0])


def face_width(module: float, helix: float) -> float:
    """Return a face width in mm: 10 modules, for helical gears the width of the overlap `OVERLAP`."""
    if not helix:
        return float(math.ceil(10.0 * module))
    return float(math.ceil(OVERLAP * math.pi * module / math.sin(abs(helix) * DEGREE)))


def blank_table(teeth: int, module: float, helix: float, width: float) -> Gear:
    """Return a gear without profile shift, from which a sketch is measured; it may be undercut."""
    return Gear(
        teeth,
        normal_module=module * MM,
        face_width=width * MM,
        bore_diameter=0.1 * teeth * module * MM,  # no measure of a sketch depends on it
        helix_angle=helix * DEGREE,
    )


def bore_diameter(gear: Gear, shift: float = 0.0) -> float:
    """Return the bore of a gear in mm."""
    shifted = replace(gear, profile_shift_coefficient=round(shift, 4))
    diameter = 2.0 * _BORE * shifted.root_radius / MM
    return float(math.floor(diameter)) if diameter > 5.0 else round(diameter, 2)


def _torques(pinion: Gear) -> tuple[float, ...]:
    """Return torques in N m up to the torque of `LOAD`, with two digits each."""
    module, width = pinion.normal_module / MM, pinion.face_width / MM
    highest = LOAD * width * module * pinion.reference_radius
    return tuple(float(f"{part * highest:.2g}") for part in _FRACTIONS)


def _round_up(value: float, step: float) -> float:
    return round(math.ceil(value / step - 1e-9) * step, 6)
