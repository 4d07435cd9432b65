"""What the handbooks advise against in the geometry of a pair; it can be made and computed all the same."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fe_contact.geometry import Gear, ParallelAxes, specific_sliding
from service.drawing.figure import number

Json = dict[str, Any]

_LEAST_TIP = 0.2
"""Tip thickness over module (Niemann/Winter, Maschinenelemente 2; 0.4 if case-hardened)."""
_LEAST_CLEARANCE = 0.12
"""Tip clearance over module (DIN 867: 0.1 to 0.3)."""
_LEAST_CONTACT_RATIO = 1.1
"""Transverse (Niemann/Winter)."""
_MOST_SLIDING = 4.0
"""Magnitude of the specific sliding at the ends of contact; wear and scuffing beyond (Niemann/Winter)."""


def pair_remarks(pair: ParallelAxes) -> list[Json]:
    """Return the remarks as warnings: `check`, `message`."""
    remarks = (*_gear("pinion", pair, 0), *_gear("wheel", pair, 1), *_mesh(pair))
    return [{"check": check, "message": message} for check, message in remarks]


def _gear(name: str, pair: ParallelAxes, index: int) -> Iterator[tuple[str, str]]:
    """Yield the remarks on one gear."""
    gear = (pair.pinion, pair.wheel)[index]
    module = gear.normal_module
    if isinstance(gear, Gear) and gear.form_point.undercut:
        yield (
            "undercut",
            f"pair.{name}: the tool cuts into the involute near the root. Raise its profile shift.",
        )
    if (tip := gear.tip_tooth_thickness / module) < _LEAST_TIP:
        yield (
            "tip_thickness",
            f"pair.{name}: the tooth is {number(tip, 2)} modules thick at its tip, below {_LEAST_TIP}.",
        )
    if (clearance := pair.tip_clearances[index] / module) < _LEAST_CLEARANCE:
        words = f"{number(clearance, 2)} modules of clearance at its tip, below {_LEAST_CLEARANCE}"
        yield "tip_clearance", f"pair.{name}: {words}. Lower its tip diameter."
    rolls = (pair.active_path.start, pair.active_path.end)
    worst = min(float(specific_sliding(pair, roll)[index]) for roll in rolls)
    if worst < -_MOST_SLIDING:
        words = f"specific sliding {number(worst, 3)} at the end of contact, beyond -{_MOST_SLIDING:g}"
        yield "specific_sliding", f"pair.{name}: {words}. Shift the profiles, or shorten the mating addendum."


def _mesh(pair: ParallelAxes) -> Iterator[tuple[str, str]]:
    """Yield the remarks on the mesh."""
    ratio = pair.active_contact_ratio
    if ratio < _LEAST_CONTACT_RATIO:
        yield (
            "contact_ratio",
            f"pair: transverse contact ratio {number(ratio, 4)}, below {_LEAST_CONTACT_RATIO}.",
        )
    if pair.normal_backlash <= 0.0:
        yield "backlash", "pair: no backlash. Give thickness_allowance_um, or a larger center distance."
