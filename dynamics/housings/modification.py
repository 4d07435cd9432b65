"""Structural modification of a reduced housing: other damping, mounts, natural frequencies, kept modes.

The coordinates stay as they are, and with them the motion of surface and points and what they radiate.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.checks import integer, positive
from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.types import FloatArray

RAISED = 30.0
"""Factor on the natural frequency of a mode that is to follow statically: its inertia is below
(f/(30 f_k))^2 of its stiffness, 0.1 % up to f_k."""


def with_damping(housing: ReducedHousing, factor: float) -> ReducedHousing:
    """Return a housing with its damping, but for that of the mounts, times a factor.

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
    """Return a housing whose natural frequencies, but for its mounts, are times a factor.

    Its stiffness is times the square; damping ratios stay as they are. Raises `InputError`: the factor is not
    above zero.
    """
    positive("factor", factor)
    springs, dampers = _mounts(housing)
    stiffness = springs + factor**2 * (housing.stiffness - springs)
    return _renewed(housing, stiffness, (springs, dampers))


def with_mounts(housing: ReducedHousing, factor: float) -> ReducedHousing:
    """Return a housing with stiffness and damping of all its mounts times a factor.

    By Galerkin's method over the reduced coordinates: exact where the modes kept span the change; natural
    frequencies are upper bounds. Raises `InputError`: the factor is not above zero, or no mounts are known:
    none of its feet has any, or it is given by matrices.
    """
    positive("factor", factor)
    if housing.mount_stiffness is None:
        raise InputError("mounts", None, "a housing reduced from its mesh with mounts at its feet")
    springs, dampers = _mounts(housing)
    stiffness = housing.stiffness + (factor - 1.0) * springs
    return _renewed(housing, stiffness, (factor * springs, factor * dampers))


def with_modes(housing: ReducedHousing, count: int) -> ReducedHousing:
    """Return a housing of which modes behind the first `count` follow statically.

    Statics and rigid motions stay as they are. The inertia of the other modes is hardly any (`RAISED`), so
    that the mass stays positive definite. Raises `InputError`: `count` is not from 1 to the number of modes
    kept.
    """
    integer("count", count, 1, len(housing.frequency))
    impulse = housing.mass @ housing.modes[1][:, count:]
    mass = housing.mass - (1.0 - RAISED**-2) * (impulse @ impulse.T)
    return replace(
        housing,
        mass=0.5 * (mass + mass.T),
        frequency=housing.frequency[:count],
        damping_ratio=housing.damping_ratio[:count],
    )


def _mounts(housing: ReducedHousing) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and damping of the mounts; zeros where none are known."""
    none = np.zeros_like(housing.stiffness)
    return (
        none if housing.mount_stiffness is None else housing.mount_stiffness,
        none if housing.mount_damping is None else housing.mount_damping,
    )


def _renewed(
    housing: ReducedHousing, stiffness: FloatArray, mounts: tuple[FloatArray, FloatArray]
) -> ReducedHousing:
    """Return a housing of other stiffness with the modes of it, damped by the law of the housing.

    `mounts` are the stiffness and damping of its mounts. Where the material does not damp, each mode keeps
    the ratio of its number.
    """
    circular, shape = housing.modes
    material_damping = housing.damping - _mounts(housing)[1]  # without that of the mounts
    loss = np.einsum("rm,rs,sm->m", shape, material_damping, shape, optimize=True)
    ratio = loss / np.where(circular > 0.0, 2.0 * circular, np.inf)
    varied = replace(
        housing,
        stiffness=stiffness,
        mount_stiffness=None if housing.mount_stiffness is None else mounts[0],
        mount_damping=None if housing.mount_damping is None else mounts[1],
    )
    circular, shape = varied.modes
    elastic = np.arange(circular.size) >= np.count_nonzero(housing.frequency == 0.0)
    if housing.loss_factor is not None:
        strain = np.einsum("rm,rs,sm->m", shape, stiffness - mounts[0], shape, optimize=True)
        share = np.clip(strain / np.where(elastic, circular, 1.0) ** 2, 0.0, 1.0)
        ratio = 0.5 * housing.loss_factor * share
    ratio = np.where(elastic, ratio, 0.0)
    impulse = housing.mass @ shape
    damping = mounts[1] + (impulse * (2.0 * ratio * circular)) @ impulse.T
    count = len(housing.frequency)
    hertz = np.where(elastic, circular, 0.0)[:count] / (2.0 * np.pi)
    return replace(varied, damping=damping, frequency=hertz, damping_ratio=ratio[:count])
