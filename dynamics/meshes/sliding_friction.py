"""Compiled Coulomb friction of sliding flanks: against the sliding velocity, never driving.

Tooth pairs touch at a distance y from the pitch point along the line of action, > 0 in recess. sigma is the
mean of sign(y) weighted by the load shares of the pairs, kappa that of abs(y) in m (`sliding_share`,
`sliding_lever` of `MeshTable`). So the part (1 + sigma)/2 of the load is in recess and slides by v + kappa w,
the rest is in approach and slides by v - kappa w: v is the sliding velocity at the pitch point in m/s, w the
relative angular velocity in rad/s. d, m and a are deflection, misalignment and change of the center distance,
m.
"""

from __future__ import annotations

from typing import NamedTuple

from dynamics.kernels.compiled import inner

CREEP_SPEED = 1e-3
"""Sliding speed from which friction has its full size, m/s; below it, friction passes smoothly through zero.

So flanks that would stick creep at up to this speed. A pair of 4 mm module at 10 rpm slides ten times as fast
at the ends of contact.
"""


class Lever(NamedTuple):
    """A quantity of the table with its derivatives in d, m and a."""

    value: float
    d: float
    m: float
    a: float


class Sliding(NamedTuple):
    """Friction over the normal force, for a coefficient of friction of 1."""

    along: Lever
    """Force along the sliding at the pitch point, 1; its derivatives are in 1/m."""
    about: Lever
    """Moment about the pitch point, m; its derivatives are in 1."""
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

    `running`: take the directions of gears that run in the sense of the scene, whatever slip and spin are.
    """
    kappa, sigma = lever.value, min(max(share.value, -1.0), 1.0)
    ahead, behind = 0.5 * (1.0 + sigma), 0.5 * (1.0 - sigma)  # parts of the load in recess and approach
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
