"""Placement of the solid of a STEP file in a scene, by bores that fit the scene's bearings.

Shafts of a scene are parallel to z. A candidate puts the axes of two bores on two shafts that are equally far
apart. The solid is then turned about z and moved along z until as many bearings as possible sit in bores;
lengths in m.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.housings import Bore
from dynamics.types import FloatArray
from lineofaction.gearbox.convert.placement import Placement
from lineofaction.gearbox.from_step.candidates import NEAR, PARALLEL, Bearings, placements
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.units import MM, as_typed

_ALIKE = 1e-3
"""Placements are equally good if the largest distances between bearings and middles of their bores differ by
less, m."""
_FEWEST = 3
"""Least number of bearings in bores that determines a placement. The bearings of one shaft leave the angle
about that shaft open."""

_WHERE = "Say where the file stands: --origin-mm, and --x-axis and --z-axis where it is turned."


@dataclass(frozen=True)
class Seated:
    """A placement, with the bore of every bearing that sits in one by the bearing's name."""

    bores: Mapping[str, Bore]
    placement: Placement
    bearings: Bearings

    @property
    def order(self) -> tuple[int, float]:
        """Minus the number of bearings in bores, and the largest offset along z, m; least for the best."""
        off = [abs(bore.position[2] - self.bearings[name][2]) for name, bore in self.bores.items()]
        return -len(self.bores), max(off, default=0.0)


def placed_bore(bore: Bore, placement: Placement) -> Bore:
    """Return a bore where it is in the scene."""
    x, y, z = map(float, placement.points(bore.position))
    u, v, w = map(float, placement.axes @ np.array(bore.axis))
    return Bore((x, y, z), (u, v, w), bore.diameter, bore.length)


def seated(bores: Sequence[Bore], bearings: Bearings, placement: Placement) -> Seated:
    """Return the bores that bearings are in; of several the one whose middle is nearest."""
    placed = [placed_bore(bore, placement) for bore in bores]
    by_bearing = {}
    for name, (x, y, z) in bearings.items():
        about = [bore for bore in placed if _holds(bore, x, y, z)]
        if about:
            by_bearing[name] = min(about, key=lambda bore: abs(bore.position[2] - z))
    return Seated(by_bearing, placement, bearings)


def _holds(bore: Bore, x: float, y: float, z: float) -> bool:
    axial = np.hypot(*bore.axis[:2]) < PARALLEL
    centered = np.hypot(bore.position[0] - x, bore.position[1] - y) < NEAR
    return bool(axial and centered and abs(bore.position[2] - z) < 0.5 * bore.length)


def best_seating(bores: Sequence[Bore], bearings: Bearings) -> Seated:
    """Return the placement with most bearings in bores; the file's own counts unless another has more.

    Raises `BadInput` naming ``step_file``: no placement has three bearings of two shafts in bores, or several
    are equally good.
    """
    as_drawn = seated(bores, bearings, Placement())
    if len(as_drawn.bores) == len(bearings):
        return as_drawn
    best = sorted(
        [as_drawn, *(seated(bores, bearings, candidate) for candidate in placements(bores, bearings))],
        key=lambda candidate: candidate.order,
    )
    first = best[0]
    places = [bore.position for bore in first.bores.values()]
    shafts = {(round(place[0] / NEAR), round(place[1] / NEAR)) for place in places}
    if len(first.bores) < _FEWEST or len(shafts) < 2:
        at = ", ".join(f"{name} at {_in_mm(position)}" for name, position in bearings.items())
        bound = f"a solid with bores about bearings of at least two shafts, three bearings in all: {at}"
        raise BadInput.of("step_file", _listed(bores), bound, _WHERE)
    rivals = [candidate for candidate in best if _rival(candidate, first)]
    if rivals:
        ways = "; or ".join(_options(candidate.placement) for candidate in (first, *rivals[:3]))
        bound = f"one that fits the bearings in one way only: {1 + len(rivals)} are equally good"
        raise BadInput.of("step_file", f"{len(first.bores)} bearings in bores", bound, f"Choose: {ways}.")
    return first


def _listed(bores: Sequence[Bore]) -> str:
    entries = [f"{as_typed(bore.diameter, MM):g} at {_in_mm(bore.position)}" for bore in bores[:8]]
    return f"{len(bores)} bores, mm: {'; '.join(entries)}" if bores else "no bore"


def _in_mm(position: Sequence[float] | FloatArray) -> str:
    return " ".join(f"{as_typed(float(np.round(value, 9)), MM):g}" for value in position)


def _options(placement: Placement) -> str:
    fields = placement.fields or {"origin_mm": [0.0, 0.0, 0.0]}
    options = []
    for name, values in fields.items():
        digits = ",".join(f"{value:.9g}" for value in values)
        options.append(f"--{name.replace('_', '-')} {digits}")
    return " ".join(options)


def _rival(other: Seated, first: Seated) -> bool:
    """Whether another placement is as good as the first, and not the same."""
    same_axes = np.allclose(other.placement.axes, first.placement.axes, atol=1e-3)
    same_origin = np.allclose(other.placement.origin, first.placement.origin, atol=_ALIKE)
    good = len(other.bores) == len(first.bores) and other.order[1] < first.order[1] + _ALIKE
    return other is not first and good and not (same_axes and same_origin)
