"""Structural modification of a reduced housing: other damping, mounts, natural frequencies, kept modes.

Only the matrices of the reduced coordinates change. Each coordinate keeps its shape: the motion of the
surface and of points, and the sound, per unit of it. Axes: r, s reduced coordinates, m modes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.checks import integer, positive
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.types import FloatArray

STATIC_FREQUENCY_FACTOR = 30.0
"""Factor on the natural frequency f_k of a mode that is to follow statically: at a frequency f its inertia
force is (f/(30 f_k))^2 of its elastic force, 0.1 % up to f_k.
"""


def with_damping(housing: ReducedHousing, factor: float) -> ReducedHousing:
    """Return a housing whose damping is multiplied by a factor; the damping of its mounts stays.

    Raises `InputError`: the factor is not above zero.
    """
    positive("factor", factor)
    _, mounts = _mounts(housing)
    damping = mounts + factor * (housing.damping - mounts)
    return replace(
        housing,
        damping=damping,
        damping_ratio=factor * housing.damping_ratio,
        loss_factor=None if housing.loss_factor is None else factor * housing.loss_factor,
    )


def with_frequencies(housing: ReducedHousing, factor: float) -> ReducedHousing:
    """Return a housing whose natural frequencies would, on rigid or no mounts, be multiplied by a factor.

    The stiffness except that of the mounts is multiplied by the square of the factor. Damping ratios stay.
    Raises `InputError`: the factor is not above zero.
    """
    positive("factor", factor)
    springs, dampers = _mounts(housing)
    stiffness = springs + factor**2 * (housing.stiffness - springs)
    return _with_stiffness(housing, stiffness, (springs, dampers))


def with_mounts(housing: ReducedHousing, factor: float) -> ReducedHousing:
    """Return a housing with stiffness and damping of all its mounts times a factor.

    This is Galerkin's method over the reduced coordinates. It is exact where the modes of the reduction span
    the change; natural frequencies are upper bounds. Raises `InputError`: the factor is not above zero, or no
    mounts are known, because none of its feet has any or because the housing is given by matrices.
    """
    positive("factor", factor)
    if housing.mount_stiffness is None:
        raise InputError("mounts", None, "a housing reduced from its mesh with mounts at its feet")
    springs, dampers = _mounts(housing)
    stiffness = housing.stiffness + (factor - 1.0) * springs
    return _with_stiffness(housing, stiffness, (factor * springs, factor * dampers))


def with_modes(housing: ReducedHousing, count: int) -> ReducedHousing:
    """Return a housing of which all modes after the first `count` follow statically.

    Statics and rigid motions stay. The other modes retain a small inertia (`STATIC_FREQUENCY_FACTOR`), so
    that the mass matrix stays positive definite. Raises `InputError`: `count` is not from 1 to the number of
    modes.
    """
    integer("count", count, 1, len(housing.frequency))
    _, shape = housing.modes
    # For modes of unit modal mass, M is the sum of (M phi)(M phi)^T: a term times 1/30^2 is 30 times as high.
    impulse = housing.mass @ shape[:, count:]
    mass = housing.mass - (1.0 - STATIC_FREQUENCY_FACTOR**-2) * (impulse @ impulse.T)
    return replace(
        housing,
        mass=0.5 * (mass + mass.T),
        frequency=housing.frequency[:count],
        damping_ratio=housing.damping_ratio[:count],
    )


def _mounts(housing: ReducedHousing) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and damping of the mounts; zeros where none are known."""
    zeros = np.zeros_like(housing.stiffness)
    return (
        zeros if housing.mount_stiffness is None else housing.mount_stiffness,
        zeros if housing.mount_damping is None else housing.mount_damping,
    )


def _with_stiffness(
    housing: ReducedHousing, stiffness: FloatArray, mounts: tuple[FloatArray, FloatArray]
) -> ReducedHousing:
    """Return the housing with another stiffness: new modes, and damping by the same law.

    `mounts` are the stiffness and damping of its mounts. Without a loss factor of the material the damping
    ratio of mode k of the new housing is that of mode k of `housing`.
    """
    old_circular, old_shape = housing.modes
    _, old_dampers = _mounts(housing)
    loss = np.einsum("rm,rs,sm->m", old_shape, housing.damping - old_dampers, old_shape, optimize=True)
    ratio = loss / np.where(old_circular > 0.0, 2.0 * old_circular, np.inf)  # inf: no ratio at 0 rad/s
    springs, dampers = mounts
    modified = replace(
        housing,
        stiffness=stiffness,
        mount_stiffness=None if housing.mount_stiffness is None else springs,
        mount_damping=None if housing.mount_damping is None else dampers,
    )
    circular, shape = modified.modes
    # Frequencies rise: as many modes as `housing` has rigid motions (0 Hz) come first, and stay rigid.
    elastic = np.arange(circular.size) >= np.count_nonzero(housing.frequency == 0.0)
    if housing.loss_factor is not None:
        strain = np.einsum("rm,rs,sm->m", shape, stiffness - springs, shape, optimize=True)
        share = np.clip(strain / np.where(elastic, circular, 1.0) ** 2, 0.0, 1.0)
        ratio = 0.5 * housing.loss_factor * share
    ratio = np.where(elastic, ratio, 0.0)
    impulse = housing.mass @ shape
    damping = dampers + (impulse * (2.0 * ratio * circular)) @ impulse.T
    count = len(housing.frequency)
    hertz = np.where(elastic, circular, 0.0)[:count] / (2.0 * np.pi)
    return replace(modified, damping=damping, frequency=hertz, damping_ratio=ratio[:count])
