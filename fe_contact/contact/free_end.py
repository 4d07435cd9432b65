r"""Additional approach of a body near its free end beyond that of an endless half plane.

A line load that reaches the free end of a body acts on a quarter space. With its mirror image in the end
plane there is no shear in that plane; the normal stress that remains there is removed by further loads, which
amplify the image by a factor psi [1]_. On a half space the load would go on past the end, which is an image
of the factor 1. Hence the surface at the distance z from the end yields more by k p e, with
k = 2 (1 - nu^2)/(pi E), the line load p and

    e(z, h) = (psi - 1)/2 (constant - ln[z + sqrt(z^2 + (c h)^2)]),

where h is half the strip. It is the potential of the image, with c = exp(-1/4)/2 from the mean of ln|x - x'|
where x and x' are both distributed as a semi-elliptic pressure. The factor psi is fitted to finite elements
of a quarter space under a semi-elliptic load that is uniform along the strip (`benchmarks/quarter_space.py`);
without lateral contraction it is 1. Up to 5 strips from the end e differs from them by up to 0.02 for
nu = 0.3 and by up to 0.09 for 0.45, most at the end itself.

References
----------
.. [1] R. Guilbault, A fast correction for elastic quarter-space applied to 3D modeling of edge contact
   problems, Journal of Tribology 133 (2011) 031402.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.types import FloatArray

_MEAN_DISTANCE = 0.5 * math.exp(-0.25)
"""The constant c: exp of the mean of ln|x - x'| under a semi-elliptic pressure, over half its strip."""
_NARROWEST = 1e-9
"""Least strip over the distance from the end, in place of that of no load."""
SMOOTH = 2.0
"""Reference length near ends over that of the local law.

Over this distance the finite elements of slices do not describe a free end.
"""


class FreeEnds(NamedTuple):
    """Ends of one gear up to which its contact runs."""

    low: float
    high: float
    """`low`, `high`: Face positions of the ends of the body, m from the pinion's mid-face; infinite where the
    body goes on.
    """
    softness: float
    """(psi - 1)/2."""


ENDLESS = FreeEnds(-math.inf, math.inf, 0.0)


def end_softness(poissons_ratio: float) -> float:
    """Return (psi - 1)/2 of a material, fitted within 2 % at ratios from 0.1 to 0.45."""
    return poissons_ratio * (0.27 + 0.6 * poissons_ratio) / (1.0 - poissons_ratio)


def end_excess(
    ends: FreeEnds, face: FloatArray, length: float, narrow: FloatArray, wide: FloatArray | float
) -> FloatArray:
    """Return e of narrow strips less that of wide ones (P, m), as means over sections of the face.

    Parameters
    ----------
    face : ndarray, shape (m,)
        Middles of the sections, m.
    length : float
        Length of a section along the face, m.
    narrow, wide : ndarray, shape (P, m), or broadcasting to it
        Half strips, m.
    """
    shape = np.broadcast_shapes(face.shape, np.shape(narrow), np.shape(wide))
    total = np.zeros(shape)
    for end, side in ((ends.low, 1.0), (ends.high, -1.0)):
        if math.isfinite(end):
            inner, outer = (side * (face - end) + part * length for part in (-0.5, 0.5))
            inner = np.maximum(inner, 0.0)
            total += _image(inner, outer, wide) - _image(inner, outer, narrow)
    return np.asarray(ends.softness * total)


def _image(inner: FloatArray, outer: FloatArray, half: FloatArray | float) -> FloatArray:
    """Return the mean of ln[z + sqrt(z^2 + (c h)^2)] between distances from the end, m."""
    strip = np.maximum(_MEAN_DISTANCE * half, _NARROWEST * outer)

    def integral(z: FloatArray) -> FloatArray:
        root = np.hypot(z, strip)
        return np.asarray(z * np.log(z + root) - root)

    return (integral(outer) - integral(inner)) / (outer - inner)
