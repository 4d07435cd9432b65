"""Division of the face width into layers of elements, finer towards both ends."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray, IntArray

RISE = 3  # groups of layers over which the thickness grows from an end to the middle


@dataclass(frozen=True)
class Layers:
    """Layers of elements, symmetric about mid-face or those above it.

    Attributes
    ----------
    ends : (L + 1,) array
        Axial positions of their ends, m; 0 is mid-face, increasing.
    kind : (L,) int array
        Layers of the same kind are equally thick, bit for bit.
    thickness : (kinds,) array
        Thickness of each kind, m.
    """

    ends: FloatArray
    kind: IntArray
    thickness: FloatArray


def layers_to_mid_face(width: float, count: int, growth: float = 1.0) -> Layers:
    """Divide the upper half of a face into layers that thicken from its end towards mid-face.

    Parameters
    ----------
    width : float
        Of the whole face, m.
    count : int
        Number of layers.
    growth : float
        Thickness of the layer at mid-face over that of the end layer.
    """
    kind = np.arange(count)[::-1]
    relative = growth ** (np.arange(count) / max(count - 1, 1))
    thickness = 0.5 * width * relative / relative.sum()
    ends = np.concatenate([[0.0], np.cumsum(thickness[kind])])
    ends[-1] = 0.5 * width
    return Layers(ends, kind, thickness)


def layers_across(width: float, count: int, group: int = 1, growth: float = 1.0) -> Layers:
    """Divide `width` into `count` layers.

    Parameters
    ----------
    width : float
        Face width, m.
    count, group : int
        Number of layers; every `group` successive ones are equally thick. `group` divides `count`.
    growth : float
        Thickness of a middle layer over that of an end layer.
    """
    number = np.arange(count // group)
    top = max(1, min(RISE, (len(number) - 1) // 2))
    kind = np.repeat(np.minimum(np.minimum(number, number[::-1]), top), group)
    relative = growth ** (np.arange(top + 1) / top)
    thickness = relative * width / relative[kind].sum()
    ends = np.concatenate([[0.0], np.cumsum(thickness[kind])]) - 0.5 * width
    ends[-1] = 0.5 * width
    return Layers(0.5 * (ends - ends[::-1]), kind, thickness)
