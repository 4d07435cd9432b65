"""Names of orders: harmonics of a mesh, sidebands, orders of a shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from bounds.unit import engineering

SIDEBANDS = 3
"""Orders of a shaft beside a mesh order that count as its sidebands: eccentricity, ovality, three lobes."""
GEARS_OF_A_PAIR = ("pinion", "wheel")
"""Names of shafts that are common nouns: they have an article."""
TOLERANCE = 1e-6
"""Largest distance of an order from a multiple of another, relative to that multiple."""


def order_words(order: float, shaft: str, harmonic: str = "") -> str:
    """Return an order of a shaft with the harmonic that it is: "order 27.0 of the pinion, harmonic 1".

    Terminal, document and page name orders in these words alone.

    Parameters
    ----------
    order : float
        Per revolution of the shaft.
    shaft : str
        Name of the shaft.
    harmonic : str
        The harmonic in words, as "harmonic 1", or what else has this order; empty: not known.
    """
    number = engineering(order, 4)
    number += "" if "." in number or "e" in number else ".0"
    return ", ".join(filter(None, (f"order {number} of {shaft_words(shaft)}", harmonic)))


def shaft_words(shaft: str) -> str:
    """Return the name of a shaft as it stands in a sentence: "the pinion", "shaft 3"."""
    return f"the {shaft}" if shaft in GEARS_OF_A_PAIR else shaft


def order_name(order: float, mesh: Mapping[str, float], shaft: Mapping[str, float]) -> str:
    """Return the name of an order: of a mesh, a sideband of a mesh by a shaft, or of a shaft.

    Examples: "mesh 2" is the second harmonic of a mesh; "mesh 1 - pinion 1" is a sideband, at most
    `SIDEBANDS` orders of the shaft off; "pinion 11" is a ghost order, of 11 waves around a gear. Empty: none
    of these.

    Parameters
    ----------
    order : float
        > 0.
    mesh, shaft : mappings
        The order of each mesh frequency and of one turn of each shaft, > 0, by name; the first that fits
        gives the name.
    """
    for name, step in mesh.items():
        if _is_multiple(order / step):
            return f"{name} {round(order / step)}"
    sideband = min(_sidebands(order, mesh, shaft), key=lambda item: item[0], default=None)
    if sideband is not None:
        return sideband[1]
    for name, step in shaft.items():
        if _is_multiple(order / step):
            return f"{name} {round(order / step)}"
    return ""


def _sidebands(
    order: float, mesh: Mapping[str, float], shaft: Mapping[str, float]
) -> Iterator[tuple[int, str]]:
    """Yield number and name of each sideband that an order is; sideband 1 is the nearest to its harmonic."""
    for name, step in mesh.items():
        harmonic = round(order / step)
        for shaft_name, shaft_order in shaft.items():
            number = (order - harmonic * step) / shaft_order
            if harmonic and _is_multiple(number) and abs(round(number)) <= SIDEBANDS:
                sign = "-" if number < 0.0 else "+"
                yield abs(round(number)), f"{name} {harmonic} {sign} {shaft_name} {abs(round(number))}"


def _is_multiple(multiple: float) -> bool:
    return abs(multiple - round(multiple)) < TOLERANCE * max(abs(multiple), 1.0)
