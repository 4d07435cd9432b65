"""Division of the face width into layers of elements, finer towards both ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_contact.types import FloatArray, IntArray

RISE = 3  # groups of layers over which the thickness grows from an end to the middle

TOLERATED = 0.3  # groups by which a part of the face may be longer than its number of groups

DIGITS = 12  # decimals of thickness over face width in which layers of one kind agree


@dataclass(frozen=True)
class Layers:
    """Layers of elements over the face or its upper half; symmetric unless a web or a seat is not."""

    ends: FloatArray
    """Axial positions of the ends of layers, m; 0 is mid-face, increasing. Shape (L + 1,)."""
    kind: IntArray
    """Kind of each layer: layers of one kind are equally thick, bit for bit. Shape (L,)."""
    thickness: FloatArray
    """Thickness of each kind, m. Shape (kinds,)."""


def layers_to_mid_face(width: float, count: int, growth: float = 1.0, breaks: Sequence[float] = ()) -> Layers:
    """Divide the upper half of a face of `width` into layers that thicken from its end towards mid-face.

    The layer at mid-face is `growth` times as thick as the end layer. A layer ends at each of `breaks`,
    increasing axial positions above 0, m.
    """
    if len(breaks):
        below = [-z for z in reversed(breaks)]
        layers = _broken_layers(width, 0.5 * width / count, 1, growth, [*below, 0.0, *breaks])
        middle = len(layers.kind) // 2
        return Layers(layers.ends[middle:], layers.kind[middle:], layers.thickness)
    kind = np.arange(count)[::-1]
    relative = growth ** (np.arange(count) / max(count - 1, 1))
    thickness = 0.5 * width * relative / relative.sum()
    ends = np.concatenate([[0.0], np.cumsum(thickness[kind])])
    ends[-1] = 0.5 * width
    return Layers(ends, kind, thickness)


def layers_across(
    width: float, count: int, group: int = 1, growth: float = 1.0, breaks: Sequence[float] = ()
) -> Layers:
    """Divide `width` into `count` layers of which every `group` successive ones are equally thick.

    `group` divides `count`; a middle layer is `growth` times as thick as an end layer. A group ends at
    each of `breaks`, increasing axial positions, m. Each part of the face between breaks has at least one
    group, about as thick as without breaks; so there may be more than `count` layers.
    """
    if len(breaks):
        return _broken_layers(width, width * group / count, group, growth, breaks)
    number = np.arange(count // group)
    top = max(1, min(RISE, (len(number) - 1) // 2))
    kind = np.repeat(np.minimum(np.minimum(number, number[::-1]), top), group)
    relative = growth ** (np.arange(top + 1) / top)
    thickness = relative * width / relative[kind].sum()
    ends = np.concatenate([[0.0], np.cumsum(thickness[kind])]) - 0.5 * width
    ends[-1] = 0.5 * width
    return Layers(0.5 * (ends - ends[::-1]), kind, thickness)  # symmetric to the last bit


def _broken_layers(width: float, usual: float, group: int, growth: float, breaks: Sequence[float]) -> Layers:
    """Divide each part of the face between breaks; `usual` is the thickness of a group without breaks."""
    corners = [-0.5 * width, *breaks, 0.5 * width]
    ends, thickness = [corners[:1]], []
    for i, (low, high) in enumerate(pairwise(corners)):
        number = np.arange(max(1, math.ceil((high - low) / usual - TOLERATED)))
        top = max(1, min(RISE, len(number) - 1))
        relative = np.ones(len(number))
        if i == 0:
            relative = growth ** (np.minimum(number, top) / top)
        elif i == len(corners) - 2:
            relative = growth ** (np.minimum(number[::-1], top) / top)
        parts = np.repeat(relative / relative.sum() * (high - low) / group, group)
        thickness.append(parts)
        ends.append([*(low + np.cumsum(parts))[:-1], high])
    rounded = np.round(np.concatenate(thickness) / width, DIGITS)
    _, first, kind = np.unique(rounded, return_index=True, return_inverse=True)
    return Layers(np.concatenate(ends), kind, np.concatenate(thickness)[first])
