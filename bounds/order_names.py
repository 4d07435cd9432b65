"""Names of orders: harmonics of a mesh, sidebands, orders of a shaft."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

SIDEBANDS = 3
"""Orders of a shaft beside a mesh order that count as its sidebands: eccentricity, ovality, three lobes."""
TOLERANCE = 1e-6
"""Largest distance of an order from a multiple of another, relative to that multiple."""


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
