"""A small cast housing on mounts around the gear pair, by its mesh: reduced in about a second.

An eccentric tube, so that all its modes couple to its four seats, which stand one behind the other.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
from geared_scenes import gear_pair_scene, square_wave_table, with_bushings, with_mesh
from lattice_meshes import lattice_mesh
from scipy.stats.qmc import Sobol
from surface_motions import normal_displacement

from dynamics.acoustics import Air, LevelBand, ModalResistance, OrderPower, Range
from dynamics.housings import (
    GRAY_CAST_IRON,
    Bore,
    BoundedPlane,
    Box,
    Foot,
    MaterialDamping,
    MeshedHousing,
    Mount,
    Plane,
    ReducedHousing,
    SeatBore,
    reduced_housing,
    scene_housing,
)
from dynamics.housings.modification import with_damping
from dynamics.noise import GUESSES, SoundBand, SoundModel, forced_power

NAMES = ("input.left", "input.right", "output.left", "output.right")
EFFECTS = {"lateral": "on", "axial": "on", "tilt": "on", "housing_modes": "on"}
BORE, WALL, LENGTH, SEAT = 0.20, 0.020, 0.25, 0.05
COARSE, MESH, FINE = (16, 1, 5), (32, 1, 10), (40, 1, 10)
MOUNT = np.diag([4e7, 4e7, 6e7, 4e5, 4e5, 4e5])
LOSS = 1e-5
"""Damping over stiffness of the mounts, s."""
LOSS_FACTOR = 0.02


WALLS = Range(0.975, 1.0, 1.01)
"""Factor on natural frequencies of castings, by their modulus; with the 0.5 % by which those of `FINE` are
below those of `MESH` the usual range."""


def meshed(cells=COARSE, modes=24, mount=1.0, frequency=1.0) -> MeshedHousing:
    def place(unit):
        angle = -2.0 * np.pi * unit[:, 0]
        wall = WALL * (1.0 + 0.4 * np.cos(angle) + 0.3 * np.sin(2.0 * angle))
        radius = 0.5 * BORE + wall * unit[:, 1]
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), LENGTH * unit[:, 2]], axis=1)

    seats = tuple(
        SeatBore(name, Bore((0.0, 0.0, SEAT * (index + 1.5)), (0.0, 0.0, 1.0), BORE, SEAT))
        for index, name in enumerate(NAMES)
    )
    below = BoundedPlane(Plane((0.0, 0.0, 0.0), (0.0, 0.0, -1.0)), Box((-1e-6, -1.0, -1.0), (1.0, 1.0, 1.0)))
    matrices = (tuple(map(tuple, (part * mount * MOUNT).tolist())) for part in (1.0, LOSS))
    return MeshedHousing(
        lattice_mesh(cells, place, closed=True),
        replace(GRAY_CAST_IRON, youngs_modulus=frequency**2 * GRAY_CAST_IRON.youngs_modulus),
        seats,
        (Foot("base", below, Mount(*matrices)),),
        modes=modes,
        damping=MaterialDamping(LOSS_FACTOR),
    )


def plane_waves(housing: ReducedHousing, low=20.0, high=20e3) -> ModalResistance:
    """Return the resistance of all its surface by the equivalent radiated power."""
    motion, area = normal_displacement(housing.surface)
    matrix = Air().impedance * (motion.T * area) @ motion
    frequency = np.geomspace(low, high, 120)
    return ModalResistance(frequency, np.broadcast_to(matrix, (120, *matrix.shape)).astype(complex))


def sound_model(housing: ReducedHousing) -> SoundModel:
    part = replace(scene_housing(housing, "case"), seat_positions=None)
    scene = replace(gear_pair_scene(square_wave_table(), effects=EFFECTS), housings=(part,))
    return SoundModel(scene, {"case": housing}, {"case": plane_waves(housing)})


def undamped_elsewhere() -> SoundModel:
    """Return the pair in a housing whose material alone damps."""
    whole = meshed()
    free = replace(whole, feet=tuple(replace(foot, mount=Mount(foot.mount.stiffness)) for foot in whole.feet))
    model = sound_model(reduced_housing(free))
    scene = with_bushings(with_mesh(model.scene, damping=0.0), damping_ratio=0.0)
    return replace(model, scene=scene)


def blind_levels(band: SoundBand, speed, cells, castings: int, cases: int, seed: int = 5) -> list[OrderPower]:
    """Return the powers of cases that are even over the usual ranges, on other meshes with more modes.

    `castings` reductions, each with mounts and natural frequencies of its own, are shared by the cases.
    """
    reduced = [
        reduced_housing(meshed(cells, 40, mount, frequency))
        for mount, frequency in _drawn((GUESSES["mount_stiffness"].usual, WALLS), castings, seed)
    ]
    guessed = [GUESSES[name].usual for name in ("housing_damping", "bearing_stiffness", "mesh_damping")]
    powers = []
    for case, (lossy, stiffer, damped) in enumerate(_drawn(guessed, cases, seed)):
        model = sound_model(with_damping(reduced[case % castings], lossy))
        (mesh,), (bushing, *_) = model.scene.meshes, model.scene.bushings
        directions = ("radial_stiffness", "axial_stiffness")
        scene = with_bushings(model.scene, **{name: stiffer * getattr(bushing, name) for name in directions})
        scene = with_mesh(scene, damping_ratio=damped * mesh.damping_ratio)
        order, power = forced_power(replace(model, scene=scene), speed, int(band.order[-1]))
        assert np.array_equal(order, band.order)
        powers.append(power)
    return powers


def _drawn(ranges, cases: int, seed: int) -> list[list[float]]:
    """Return values that are even over the ranges, spread evenly: a count of few cases is off by little."""
    shares = Sobol(len(ranges), seed=seed).random(cases).tolist()
    return [[span.at(share) for span, share in zip(ranges, row, strict=True)] for row in shares]


def covered(band: SoundBand, powers: list[OrderPower]) -> SimpleNamespace:
    weighted = np.array([power.weighted_level for power in powers])
    total = np.array([power.total_weighted_level for power in powers])
    mean = 10.0 * np.log10([np.trapezoid(10.0 ** (row / 10.0), band.speed) for row in total])
    mean -= 10.0 * np.log10(np.ptp(band.speed))
    loudest = np.searchsorted(band.speed, band.loudest_speed)
    there = weighted[:, np.arange(band.order.size), loudest]
    levels = {"largest": weighted.max(axis=2), "there": there, "total": total}
    shares = {kind: _inside(getattr(band, kind), values) for kind, values in levels.items()}
    return SimpleNamespace(
        largest_total=_inside((band.largest_total,), total.max(axis=1)[:, None])[0],
        mean_total=_inside((band.mean_total,), mean[:, None])[0],
        **shares,
    )


def _inside(bands: tuple[LevelBand, ...], levels) -> np.ndarray:
    low, high = ([getattr(band, end) for band in bands] for end in ("low", "high"))
    return np.mean((levels >= low) & (levels <= high), axis=0)
