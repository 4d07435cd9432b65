"""Compiled Coulomb friction of sliding flanks: against the sliding velocity, never driving."""

from __future__ import annotations

from typing import NamedTuple

from dynamics.kernels.compiled import inner

CREEP_SPEED = 1e-3
"""Sliding speed from which on friction has its full size, m/s; below, it passes smoothly through zero. Flanks
that stick in truth creep at up to it. A pair of 4 mm module at 10 rpm slides ten times as fast at the ends of
contact.
"""


class Lever(NamedTuple):
    """A quantity of the table with its derivatives in d, m and a."""

    value: float
    d: float
    m: float
    a: float


class Sliding(NamedTuple):
    """Friction over the normal force along sliding at the pitch point and about the axis, mu = 1."""

    along: Lever
    """1; its derivatives 1/m."""
    about: Lever
    """m; its derivatives 1."""
    along_rate: float
    mixed_rate: float
    about_rate: float
    """`along_rate`, `mixed_rate`, `about_rate`: Derivatives of `along` in v, s/m; of `along` in w and of
    `about` in v, s; of `about` in w, m s.
    """


@inner
def _direction(speed: float) -> tuple[float, float]:
    """Return the direction of sliding at `speed` (m/s), from -1 to 1, and its derivative."""
    s = speed / CREEP_SPEED
    if s >= 1.0:
        return 1.0, 0.0
    if s <= -1.0:
        return -1.0, 0.0
    return 0.5 * s * (3.0 - s * s), 1.5 * (1.0 - s * s) / CREEP_SPEED


@inner
def sliding_force(share: Lever, lever: Lever, slip: float, spin: float, running: bool) -> Sliding:
    """Return the friction at sigma = `share`, kappa = `lever`, v = `slip` and w = `spin`.

    `running`: with the directions of gears that run in the sense of the scene, whatever slip and spin are.
    """
    kappa, sigma = lever.value, min(max(share.value, -1.0), 1.0)
    ahead, behind = 0.5 * (1.0 + sigma), 0.5 * (1.0 - sigma)
    if running:
        up, up_rate, down, down_rate = 1.0, 0.0, -1.0, 0.0
    else:
        up, up_rate = _direction(slip + kappa * spin)
        down, down_rate = _direction(slip - kappa * spin)
    rate, turned = ahead * up_rate + behind * down_rate, ahead * up_rate - behind * down_rate
    along, about = ahead * up + behind * down, ahead * up - behind * down
    by_share, by_lever = 0.5 * (up - down), spin * turned
    about_share, about_lever = 0.5 * kappa * (up + down), about + kappa * spin * rate
    return Sliding(
        Lever(
            along,
            by_share * share.d + by_lever * lever.d,
            by_share * share.m + by_lever * lever.m,
            by_share * share.a + by_lever * lever.a,
        ),
        Lever(
            kappa * about,
            about_share * share.d + about_lever * lever.d,
            about_share * share.m + about_lever * lever.m,
            about_share * share.a + about_lever * lever.a,
        ),
        rate,
        kappa * turned,
        kappa * kappa * rate,
    )


@inner
def scaled(lever: Lever, factor: float) -> Lever:
    """Return `factor` times `lever`."""
    return Lever(factor * lever.value, factor * lever.d, factor * lever.m, factor * lever.a)
