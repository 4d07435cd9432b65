"""STE databases of random pairs in closed form: spur and helical, with and without errors and deviations."""

from __future__ import annotations

import math
from dataclasses import asdict, replace

import numpy as np

from fe_contact.geometry import FlankModification, Gear, GearPair
from fe_contact.ste import Metadata, PairFacts, SteDatabase

POSITIONS = 48


def random_table(seed: int) -> SteDatabase:
    """Return the table of a pair that is drawn at random: 1 to 7 loads, 1 to 5 tooth pairs in contact."""
    rng = np.random.default_rng(seed)
    pair = _pair(rng)
    facts, torque = PairFacts.of(pair), np.sort(np.round(rng.uniform(1.0, 900.0, rng.integers(1, 8)), 1))
    force = torque / (facts.base_radius[0] * math.cos(facts.base_helix_angle))
    skew = 1e-6 * np.array([-20.0, 0.0, 40.0]) if rng.random() < 0.5 else np.zeros(1)
    change = 1e-3 * np.array([0.0, 0.1]) if rng.random() < 0.3 else np.zeros(1)
    position = np.arange(POSITIONS) / POSITIONS
    grid = (POSITIONS, force.size, skew.size, change.size)
    counts = np.broadcast_to(_pairs(rng, position)[:, None, None, None], grid)
    pairs = np.arange(int(counts.max()))
    ste = _ste(rng, position, force, grid[2:])
    helical = facts.base_helix_angle > 0.0
    centroid = 1e-3 * helical * np.sin(2.0 * np.pi * position)[:, None, None, None] - 50.0 * skew[:, None]
    return SteDatabase(
        position=position,
        force=force,
        torque=torque,
        misalignment=skew,
        center_distance_change=change,
        pair=pairs,
        static_transmission_error=ste,
        tangent_compliance=0.9 * ste / force[:, None, None],
        no_load_transmission_error=np.zeros((POSITIONS, *grid[2:])),
        load_share=(pairs < counts[..., None]) / counts[..., None],
        face_centroid=np.broadcast_to(centroid, grid),
        max_pressure=np.broadcast_to(1e7 * np.sqrt(force)[:, None, None], grid),
        pairs_in_contact=counts,
        status=np.zeros(grid, dtype=np.int8),
        error_estimate=ste * (math.nan if rng.random() < 0.2 else 10.0 ** rng.uniform(-4.0, -1.0)),
        residuals=np.zeros((*grid, 4)),
        facts=facts,
        metadata=Metadata(case={"pair": asdict(pair)} if rng.random() < 0.9 else {"name": "random"}),
    )


def _pair(rng: np.random.Generator) -> GearPair:
    """Draw a pair, in two of three cases with relief and crowning."""
    teeth = int(rng.integers(18, 60)), int(rng.integers(18, 90))
    helix = float(rng.choice([0.0, rng.uniform(0.1, 0.5)]))
    relief, crowning = rng.choice([0.0, 1.0, 1.0]) * rng.uniform(1e-6, 40e-6, 2)
    pinion = Gear(
        teeth=teeth[0],
        normal_module=3e-3,
        face_width=float(rng.uniform(0.01, 0.05)),
        bore_diameter=1.5e-3 * teeth[0],
        helix_angle=helix,
        modification=FlankModification(
            tip_relief=relief, tip_relief_length=1.5e-3, helix_crowning=crowning * (helix > 0.0)
        ),
    )
    return GearPair(
        pinion, replace(pinion, teeth=teeth[1], bore_diameter=1.5e-3 * teeth[1], helix_angle=-helix)
    )


def _pairs(rng: np.random.Generator, position: np.ndarray) -> np.ndarray:
    """Draw the number of pairs in contact, with one more on a part of the pitch or on all of it."""
    first, share = int(rng.integers(1, 5)), rng.choice([rng.uniform(0.1, 0.9), 1.0])
    return first + (np.abs(position - 0.5) < 0.5 * share).astype(int)


def _ste(
    rng: np.random.Generator, position: np.ndarray, force: np.ndarray, alignments: tuple[int, ...]
) -> np.ndarray:
    """Draw a ripple of some harmonics, from a thousandth to a fifth of the mean, changing with the load."""
    order = np.arange(1, 6)
    size = 10.0 ** rng.uniform(-3.0, -0.7) * rng.random(5) / order
    tones = size * np.cos(2.0 * np.pi * (position[:, None] * order + rng.random(5)))
    level = (force / force[-1])[:, None] ** rng.uniform(-0.3, 0.3, 5)
    shape = 1.0 + tones @ level.T
    mean = 4e-9 * force[-1] * (force / force[-1]) ** 0.9
    worse = 1.0 + 0.3 * rng.random(alignments)
    return (mean * shape)[:, :, None, None] * worse
