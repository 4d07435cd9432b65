"""Force extraction from tables that ask much of an interpolant."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from fe_contact.errors import InputError
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from lineofaction.hardcases.contact.contact_case import even_positions, max_relative
from lineofaction.hardcases.scene import Measured, Scenes, largest
from lineofaction.hardcases.tables import COMPLIANCE, PLAIN_TABLE, along, square_wave, table_of

SCENES = Scenes("table")

_SEED = 20260102

_FORCE = np.array([500.0, 1000.0, 2500.0, 5000.0])


@SCENES.add(
    "square_wave_ste",
    "STE doubles between two knots, at every load: any smooth interpolant wants to swing.",
    "No value leaves the wave's range, force grows with approach, and force and STE are inverse to each "
    "other.",
)
def _square_wave_ste() -> Sequence[Measured]:
    """Extract forces from an STE that jumps to its double between two knots."""
    position = even_positions(64)
    ste = square_wave(position)[:, None] * _FORCE
    table = table_of(position, _FORCE, ste, np.zeros(64))
    x = np.linspace(0.0, 1.0, 20_001)
    curve = table.ste(x, 2500.0)
    overshoot = max(
        float(curve.max() / (2500.0 * COMPLIANCE)) - 1.0, 1.0 - float(curve.min() / (1250.0 * COMPLIANCE))
    )
    depth = np.linspace(0.0, 1.2 * ste.max(), 400)
    force = table.force_at(x[::50, None], depth).force
    return (
        Measured("overshoot over the wave", overshoot, maximum=1e-12),
        *_inverse(table, x),
        Measured("least change of force as teeth approach, N", np.diff(force, axis=1).min(), minimum=-1e-9),
        _slope_error(table),
    )


@SCENES.add(
    "two_loads_only",
    "Two stored loads, or one, do not determine a curvature, and lift-off lies below them.",
    "Force and STE are inverse to each other; a linear table stays linear between its loads.",
)
def _two_loads() -> Sequence[Measured]:
    """Extract forces from a table of two loads, and of one."""
    position = even_positions(16)
    compliance = COMPLIANCE * (1.0 + 0.3 * np.cos(2.0 * np.pi * position))
    figures: list[Measured] = []
    for force in (np.array([1000.0, 3000.0]), np.array([3000.0])):
        table = table_of(position, force, compliance[:, None] * force, np.zeros(16))
        between = np.linspace(0.0, 3000.0, 31)[1:]
        straight = compliance[:, None] * between
        growth = np.diff(table.ste(position[:, None], between), axis=1)
        loads = f"{force.size} load" + "s" * (force.size > 1)
        stored = between >= table.force[0]
        figures += [
            *(
                Measured(f"{f.name}, {loads}", f.value, maximum=f.maximum, minimum=f.minimum)
                for f in _inverse(table, position)
            ),
            Measured(
                f"from the lowest load on, off the straight law, {loads}",
                max_relative(table.ste(table.position[:, None], between[stored]), straight[:, stored]),
                maximum=1e-12,
            ),
            Measured(f"least growth of STE with load, {loads}, m", growth.min(), minimum=1e-9),
        ]
    return figures


@SCENES.add(
    "force_at_lift_off",
    "The force sets in along a curve in position and approach; at it stiffness is zero by convention.",
    "Force and stiffness are zero at and below lift-off, continuous through it, and positive above.",
)
def _lift_off() -> Sequence[Measured]:
    """Move across lift-off, where the force sets in, with a gap that varies over the pitch."""
    position = even_positions(32)
    gap = 20e-6 * np.sin(2.0 * np.pi * position)
    ste = gap[:, None] + COMPLIANCE * _FORCE**0.9
    table = table_of(position, _FORCE, ste, gap)
    x = np.linspace(0.0, 1.0, 501)
    lift_off = table.ste(x, 0.0)
    below, at, above = (table.force_at(x, lift_off + step) for step in (-1e-12, 0.0, 1e-12))
    near = table.force_at(x, lift_off + 1e-9)
    return (
        Measured("force at and below lift-off, N", max(below.force.max(), at.force.max()), maximum=0.0),
        Measured(
            "stiffness at and below lift-off, N/m",
            max(below.stiffness.max(), at.stiffness.max()),
            maximum=0.0,
        ),
        Measured("force 1 pm above it, N", above.force.max(), maximum=1e-6, minimum=0.0),
        Measured("force 1 nm above it over the secant's", near.force.max() * COMPLIANCE / 1e-9, maximum=1.0),
        Measured("least force 1 nm above it, N", near.force.min(), minimum=1e-12),
        *_inverse(table, x),
    )


@SCENES.add(
    "queries_outside",
    "Positions of a million pitches, approaches far beyond the highest load, infinity and NaN.",
    "Position repeats; beyond the top the curve goes on straight and is flagged; inf and NaN are refused.",
)
def _queries_outside() -> Sequence[Measured]:
    """Query beyond every end of the table, far away, and with NaN."""
    position = even_positions(32)
    compliance = COMPLIANCE * (1.0 + 0.3 * np.cos(2.0 * np.pi * position))
    table = table_of(position, _FORCE, compliance[:, None] * _FORCE, np.zeros(32))
    x = np.linspace(0.0, 1.0, 101)[:-1]
    ste = table.ste(x, 2500.0)
    far = np.abs(table.ste(x + 1e6, 2500.0) / ste - 1.0).max()
    back = np.abs(table.ste(x - 12345.0, 2500.0) / ste - 1.0).max()
    top = table.ste(x, _FORCE[-1])
    beyond = table.force_at(x, 2.0 * top)
    inside = table.force_at(x, 0.99 * top)
    straight = _FORCE[-1] + table.force_at(x, top).stiffness * top
    refused = sum(
        _refused(table, *query) for query in ((np.nan, 1e-5), (0.0, np.nan), (np.inf, 1e-5), (0.0, np.inf))
    )
    return (
        Measured("a million pitches away, relative change", far, maximum=1e-9),
        Measured("12345 pitches back, relative change", back, maximum=1e-11),
        Measured(
            "beyond the top, off the straight continuation",
            max_relative(beyond.force, straight),
            maximum=1e-9,
        ),
        Measured("flags beyond the top", (beyond.validity != 0).sum(), minimum=x.size),
        Measured("flags inside", (inside.validity != 0).sum(), maximum=0.0),
        Measured("of four queries that are no numbers, refused", refused, minimum=4.0),
        *_along_the_axis(table, x),
    )


def _along_the_axis(table: SteDatabase, x: FloatArray) -> tuple[Measured, ...]:
    """Return figures on a table of three misalignments, queried at each, between two and beyond them."""
    misalignment, factor = np.array([-20e-6, 0.0, 30e-6]), np.array([1.2, 1.0, 1.5])
    names = ("static_transmission_error", "tangent_compliance", "no_load_transmission_error")
    scaled: dict[str, Any] = {name: along(getattr(table, name), factor) for name in names}
    scaled |= {name: along(getattr(table, name), np.ones(factor.size)) for name in PLAIN_TABLE}
    wide = replace(table, misalignment=misalignment, **scaled)
    ste = table.ste(x, 2500.0)
    at = [wide.ste(x, 2500.0, misalignment=m) / ste for m in misalignment]
    between = wide.ste(x, 2500.0, misalignment=15e-6) / ste
    force = [
        wide.force_at(x, f * ste, misalignment=m).force for m, f in zip(misalignment, factor, strict=True)
    ]
    beyond = wide.force_at(x, ste, misalignment=1e-3)
    return (
        Measured(
            "STE at each misalignment off the one stored for it",
            max_relative(np.array(at), factor[:, None]), maximum=1e-12,
        ),
        Measured("force likewise", max_relative(np.array(force), np.array(2500.0)), maximum=1e-9),
        Measured("STE between two misalignments over STE at the lower", between.min(), minimum=1.0),
        Measured("over that at the higher one", between.max() / 1.5, maximum=1.0),
        Measured("flags beyond the axis", (beyond.validity != 0).sum(), minimum=x.size),
    )  # fmt: skip


@SCENES.add(
    "nearly_parallel_curves",
    "Curves of neighboring loads lie a picometer apart over a wave of microns: where they cross a force "
    "has two values.",
    "Their order holds everywhere, and force and STE are inverse to each other.",
)
def _nearly_parallel() -> Sequence[Measured]:
    """Extract forces where the curves of three loads run a picometer apart over a square wave."""
    position = even_positions(48)
    force = 1000.0 + np.array([0.0, 1e-3, 2e-3, 1.0])
    ste = square_wave(position)[:, None] * force
    ste[:, 1:3] = ste[:, :1] + np.array([1e-12, 2e-12])
    table = table_of(position, force, ste, np.zeros(48))
    x = np.linspace(0.0, 1.0, 4001)
    levels = table.ste(x[:, None], np.r_[0.0, force])
    return (
        Measured("least distance of neighboring curves, m", np.diff(levels, axis=1).min(), minimum=1e-13),
        Measured(
            "curves off their knots, m",
            largest(table.ste(position[:, None], force) - ste),
            maximum=0.0,
        ),
        *_inverse(table, x),
    )


def _inverse(table: SteDatabase, x: FloatArray) -> tuple[Measured, ...]:
    """Return figures on force and STE as inverse functions between zero and the highest load."""
    rng = np.random.default_rng(_SEED)
    force = rng.uniform(0.0, float(table.force[-1]), x.size)
    deflection = table.ste(x, force)
    sample = table.force_at(x, deflection)
    # change of the force by 32 roundings of the deflection, at the largest stiffness of the table
    steepest = float(np.diff(table.force_table().level).max() / np.diff(table.force_table().deflection).min())
    rounding = 32.0 * np.spacing(np.abs(deflection)) * max(steepest, float(sample.stiffness.max()))
    difference = np.maximum(np.abs(sample.force - force) - rounding, 0.0) / table.force[-1]
    return (Measured("force of the STE of a force, off by", difference.max(), maximum=1e-9),)


def _slope_error(table: SteDatabase) -> Measured:
    """Return the difference of the stated stiffness from the difference quotient of forces."""
    rng = np.random.default_rng(_SEED)
    x, force = rng.uniform(0.0, 1.0, 500), rng.uniform(100.0, 4900.0, 500)
    deflection = table.ste(x, force)
    step = 1e-6 * deflection
    below, above = (table.force_at(x, deflection + sign * step).force for sign in (-1.0, 1.0))
    stiffness = table.force_at(x, deflection).stiffness
    difference = np.abs((above - below) / (2.0 * step) - stiffness) / stiffness.max()
    return Measured("stiffness off the difference of forces", difference.max(), maximum=1e-3)


def _refused(table: SteDatabase, position: float, deflection: float) -> bool:
    try:
        table.force_at(position, deflection)
    except InputError:
        return True
    return False
