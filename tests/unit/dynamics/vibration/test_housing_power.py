"""Power of bearings in a housing: balance, the split between housing and mounts, the whole mesh's mounts."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
import scipy.sparse as sp
from lattice_meshes import tube
from scipy.sparse.linalg import spsolve

from dynamics.housings import (
    Bore,
    Foot,
    Material,
    MaterialDamping,
    MeshedHousing,
    ModalDamping,
    Mount,
    Plane,
    ReducedHousing,
    SeatBore,
)
from dynamics.housings.assembled_housing import assemble
from dynamics.housings.reduction import reduce_housing
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import housing_motion

STEEL = Material(210e9, 0.3, 7850.0)
STIFFNESS, DASHPOT = 2e7, 3e3
HERTZ = np.array([50.0, 400.0, 2000.0, 4000.0])


@dataclass(frozen=True)
class HousingPower:
    """Mean powers by harmonics, (...,) each, W."""

    input: FloatArray
    """Of the bearings, at the seats."""
    own: FloatArray
    """Lost by the damping of the housing's modes."""
    mounts: FloatArray
    """Lost in the dampers of the mounts: structure-borne power. Fixed feet take none."""

    @property
    def residual(self) -> float:
        """Power that is put in and lost nowhere, of the largest input."""
        missing = np.abs(self.input - self.own - self.mounts)
        return float(np.max(missing, initial=0.0) / max(np.max(np.abs(self.input), initial=0.0), 1e-300))


def housing_power(housing: ReducedHousing, frequency: FloatArray, force: ComplexArray) -> HousingPower:
    """Return where the power goes that bearings put into a housing.

    Parameters
    ----------
    housing : ReducedHousing
        With mass. Where `mount_damping` is None all its losses are its own.
    frequency : (...,) array
        Hz, any shape.
    force : (..., s) array
        Complex peak amplitudes on the motions of the seats, N and N m (`seat_forces`).

    Raises
    ------
    InputError
        As `housing_motion`.
    """
    motion = housing_motion(housing, frequency, force)
    rate = 2.0j * math.pi * np.asarray(frequency, dtype=float)[..., None] * motion
    put_in = 0.5 * np.real(np.sum(force * rate[..., : housing.motions].conj(), axis=-1))
    mounts = np.zeros_like(housing.damping) if housing.mount_damping is None else housing.mount_damping
    own, through = (_dissipated(matrix, rate) for matrix in (housing.damping - mounts, mounts))
    return HousingPower(np.asarray(put_in), own, through)


def _dissipated(damping: FloatArray, rate: ComplexArray) -> FloatArray:
    """Return the mean power of a damping matrix at velocities (..., r) of the coordinates, (...,) W."""
    return np.asarray(0.5 * np.real(np.einsum("...i,ij,...j->...", rate.conj(), damping, rate)))


def rows(diagonal):
    return tuple(map(tuple, np.diag(diagonal).tolist()))


@cache
def meshed(damping=None, *, dashpot=DASHPOT) -> MeshedHousing:
    lever = [1.0, 1.0, 1.0, 4e-3, 4e-3, 4e-3]
    mount = Mount(rows([STIFFNESS * a for a in lever]), rows([dashpot * a for a in lever]))
    seat = SeatBore("seat", Bore((0.0, 0.0, 0.075), (0.0, 0.0, 1.0), 0.08, 0.05))
    foot = Foot("base", Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), mount)
    mesh = tube(0.12, 0.08, 0.1, (12, 1, 2))
    return MeshedHousing(mesh, STEEL, (seat,), (foot,), modes=20, damping=damping or MaterialDamping(0.01))


@cache
def reduced(damping=None, *, dashpot=DASHPOT) -> ReducedHousing:
    return reduce_housing(meshed(damping, dashpot=dashpot))


def forces(seed=1):
    draw = np.random.default_rng(seed)
    return draw.normal(size=(HERTZ.size, 5)) + 1j * draw.normal(size=(HERTZ.size, 5))


def test_what_bearings_put_in_is_lost_in_the_housing_and_its_mounts():
    power = housing_power(reduced(), HERTZ, forces())
    assert power.residual < 1e-9
    assert np.all(power.own > 0.0) and np.all(power.mounts > 0.0)
    assert power.mounts[0] > 100.0 * power.own[0]  # a rigid body on its mount
    bare = housing_power(reduced(dashpot=0.0), HERTZ, forces())
    assert not np.any(bare.mounts) and bare.residual < 1e-9


def test_mounts_take_what_they_take_on_the_whole_mesh():
    """A housing without losses of its own: all power leaves through the mounts."""
    lossless = ModalDamping((0.0,))
    power, whole = housing_power(reduced(lossless), HERTZ, forces()), assemble(meshed(lossless))
    assert np.max(np.abs(power.own)) < 1e-9 * np.max(power.mounts)
    for index, hertz in enumerate(HERTZ):
        omega = 2.0 * math.pi * hertz
        dynamic = whole.stiffness + 1j * omega * whole.mounts[1] - omega**2 * whole.mass
        motion = spsolve(sp.csc_array(dynamic), whole.seats.T @ forces()[index])
        through = 0.5 * omega**2 * np.real(motion.conj() @ (whole.mounts[1] @ motion))
        assert power.mounts[index] == pytest.approx(through, rel=0.01)


def test_a_rigid_body_on_a_mount_loses_its_power_there():
    """m x'' + c x' + k x = F along the axis, far below the first mode of the tube."""
    housing, omega = reduced(), 2.0 * math.pi * 50.0
    push = np.array([[0.0, 0.0, 7.0, 0.0, 0.0]], dtype=complex)
    found = housing_power(housing, HERTZ[:1], push)
    moved = 7.0 / (STIFFNESS - omega**2 * housing.body.mass + 1j * omega * DASHPOT)
    assert found.mounts[0] == pytest.approx(0.5 * DASHPOT * omega**2 * abs(moved) ** 2, rel=2e-3)
