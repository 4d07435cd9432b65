r"""Contact of a smooth flank with the tip edge of its partner.

Along the tip gear's flank, measured inwards from its edge, the gap is g(x) = phi x + x^2/(2R). Contact
spreads over 0 <= x <= c; the pressure is singular at the edge and vanishes at c. Inverting the half-plane
equation with that end behavior [1]_ gives

    q(x) = (E*/2) sqrt((c - x)/x) [phi + (x + c/2)/R],      p = (pi E* c/4) (phi + 3c/(4R)).

The approach at the edge is the mean of -ln x under q. Written like the Hertz result it needs only an
equivalent half-width b_eff: sqrt((c-x)/x) and sqrt(x(c-x)) are Beta(1/2, 3/2) and Beta(3/2, 3/2) densities
whose mean logarithms are ln c - 1 - 2 ln 2 and ln c + 1/2 - 2 ln 2, while a Hertz strip has ln b - 1/2 - ln
2. Nothing is fitted.

A contact on the line of action at arc distance t from the edge has phi = -t/R (and the rigid gap t^2/(2R)
at the edge). As long as c > 2t the edge cuts the Hertz strip off; at c = 2t both laws agree in value and
slope. The derivation is in docs/theory/hertz.md.

The body with the edge is a wedge there and yields more than a half plane: `wedge_softness`.

References
----------
.. [1] K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, sections 2.7 and 5.5.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.types import FloatArray


def edge_contact_length(
    line_load: ArrayLike, slope: ArrayLike, radius: ArrayLike, modulus: float
) -> FloatArray:
    """Contact length c in m from the edge.

    Parameters
    ----------
    line_load : array_like
        p in N/m, >= 0.
    slope : array_like
        phi in rad, angle between the two flanks at the edge, positive = they open away from the edge.
    radius : array_like
        Relative radius R in m.
    modulus : float
        Contact modulus E* in Pa.
    """
    p, phi, r = (np.asarray(v, dtype=float) for v in (line_load, slope, radius))
    root = np.sqrt(phi**2 + 12.0 * p / (math.pi * modulus * r)) + np.abs(phi)
    opening = phi > 0.0  # there root - phi would cancel
    flat = 8.0 * p / (math.pi * modulus * np.where(opening, root, 1.0))
    return np.asarray(np.where(opening, flat, 2.0 / 3.0 * r * root), dtype=float)


def edge_half_width(length: ArrayLike, slope: ArrayLike, radius: ArrayLike) -> FloatArray:
    """Equivalent Hertz half-width b_eff in m of an edge contact of length c > 0.

    ln b_eff = ln(c/2) + 1/2 + w, w the mean of the two parts of the pressure weighted by their resultants.
    """
    c, phi, r = (np.asarray(v, dtype=float) for v in (length, slope, radius))
    singular, regular = phi * r + 0.5 * c, 0.25 * c  # resultants of the two parts, up to a factor
    w = (-singular + 0.5 * regular) / (singular + regular)
    return np.asarray(0.5 * c * np.exp(0.5 + w), dtype=float)


def wedge_softness(angle: float) -> float:
    """Return how much more a wedge yields to a force at its edge than a half plane does; 1 at an angle of pi.

    A force p at the apex, normal to a face, moves what is r away by -k_w p ln(r) plus a constant.
    This is k_w/k, k = 2 (1 - nu^2)/(pi E) that of the half plane, by the radial stresses in a wedge.

    Parameters
    ----------
    angle : float
        Of the material between the faces, rad.
    """
    half = 0.5 * angle
    along, across = half + 0.5 * math.sin(angle), half - 0.5 * math.sin(angle)
    return 0.5 * math.pi * (math.sin(half) ** 2 / along + math.cos(half) ** 2 / across)
