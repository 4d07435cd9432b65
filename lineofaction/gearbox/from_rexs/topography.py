"""The topographical modification of a flank: amounts at the nodes of a grid."""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.from_rexs.flank_modification import Modification, PlainFlank
from lineofaction.gearbox.from_rexs.gear_unit import Part

_AMOUNTS = "topographical_modification_amounts"

_DIAMETERS, _LENGTHS = "diameters_of_topographical_modification", "length_of_topographical_modification"


def topographical_modification(flank: PlainFlank, part: Part) -> Modification:
    """Return a topographical modification: an amount for each pair of a coordinate and a diameter.

    The three lists have an entry for each node. Between the nodes the amounts are linear, beyond them those
    of the border.
    """
    from scipy.interpolate import RegularGridInterpolator  # noqa: PLC0415 (start-up time)

    amounts = part.numbers(_AMOUNTS, "flank_grid")
    faces = part.numbers("coordinates_of_topographical_modification", "flank_grid, from the datum face")
    rolls = _roll_lengths(flank, part)
    if amounts is None or faces is None or rolls is None or not len(amounts) == len(faces) == len(rolls):
        counts = [None if entry is None else len(entry) for entry in (faces, rolls, amounts)]
        raise part.refusal(_AMOUNTS, counts, "as many coordinates, diameters and amounts")
    nodes = {(roll, face): amount for roll, face, amount in zip(rolls, faces, amounts, strict=True)}
    axes = [np.array(sorted({node[axis] for node in nodes})) for axis in (0, 1)]
    if len(nodes) != len(axes[0]) * len(axes[1]) or min(map(len, axes)) < 2 or len(nodes) != len(amounts):
        raise part.refusal(_AMOUNTS, len(amounts), "on a grid of coordinates and diameters")
    values = np.array([[nodes[roll, face] for face in axes[1]] for roll in axes[0]])
    surface = RegularGridInterpolator(tuple(axes), values)

    def removed(roll: FloatArray, face: FloatArray) -> FloatArray:
        inside = [np.clip(x, axis[0], axis[-1]) for x, axis in zip((roll, face), axes, strict=True)]
        return np.asarray(surface(np.stack(np.broadcast_arrays(*inside), axis=-1)))

    return Modification(part, removed, rolls=tuple(axes[0]), faces=tuple(axes[1]))


def _roll_lengths(flank: PlainFlank, part: Part) -> tuple[float, ...] | None:
    """Return the roll lengths in m of the nodes, stated by diameters or as roll lengths."""
    diameters = part.numbers(_DIAMETERS, "flank_grid, as roll lengths")
    if diameters is None:
        return part.numbers(_LENGTHS, "flank_grid")
    base = flank.gear.base_radius
    if min(abs(value) for value in diameters) <= 2.0 * base:
        raise part.refusal(_DIAMETERS, 1e3 * min(diameters), f"above {2e3 * base:.7g} mm")
    return tuple(float(np.sqrt((0.5 * value) ** 2 - base**2)) for value in diameters)
