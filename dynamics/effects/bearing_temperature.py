"""Steady temperatures change the play of bearings, and the preload of those that hold a shaft together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from bounds import engineering
from dynamics.bearings import RollingBearing
from dynamics.bearings.row_law import row_law
from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.mechanism.thermal_expansion import warmed_bearings
from dynamics.scene.scene import Scene
from dynamics.temperatures import WarmBearing
from host.optional_modules import scipy

MIN_CHANGE = 1e-12  # m
UNLOADED = 1e-9  # m; within it rows of a pair just touch


class BearingTemperature(RotorEffect):
    """Rows of bearings at temperature in place of the rows as drawn."""

    name = "bearing_temperature"
    in_statics = True
    cost = "none"

    def prepared(self, scene: Scene) -> Scene:
        """Return `scene` with its bearings at temperature."""
        return warmed_bearings(scene)

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect wherever temperatures change a bearing.

        Its influence is how far the shaft moves at a mesh as its rows yield more, or less, under their loads.
        """
        scene, name = rotor.mechanism.scene, rotor.rotor.shaft.name
        if scene.temperatures is None:
            return Verdict(False, False, "the scene has no temperatures", 0.0)
        rows = [row for row in _warm_rows(scene) if row.drawn.shaft == name]
        changed = [row for row in rows if _differs(row)]
        if not changed:
            return Verdict(False, False, "temperatures change no bearing with a row", 0.0)
        reasons = [*_plays(changed), *_pair(rows)]
        reasons += [f'"{row.drawn.name}" {ring} loose' for row in changed for ring in row.loose]
        return Verdict(True, True, "; ".join(reasons), _mesh_displacement(rotor, rows))


def _warm_rows(scene: Scene) -> Sequence[WarmBearing]:
    warm = warmed_bearings(scene).temperatures
    return list((warm.bearings or {}).values()) if warm else []


def _differs(row: WarmBearing) -> bool:
    changes = (
        row.warm.row.clearance - row.drawn.row.clearance,
        row_law(row.warm).shift - row_law(row.drawn).shift,
    )
    return bool(row.loose) or max(map(abs, changes)) > MIN_CHANGE


def _plays(rows: Sequence[WarmBearing]) -> Iterator[str]:
    """Yield the clearance of each row without contact angle in words; a negative clearance is a preload."""
    for row in rows:
        if row.drawn.row.contact_angle == 0.0:
            before, after = (1e6 * part.row.clearance for part in (row.drawn, row.warm))
            along = 1e6 * (row_law(row.warm).shift - row_law(row.drawn).shift)
            text = f'clearance of "{row.drawn.name}" {before:.4g} to {after:.4g} µm'
            text += ", a preload" if after < 0.0 else ""
            yield text + (f", rings {along:+.4g} µm apart along z" if along else "")


def _pair(rows: Sequence[WarmBearing]) -> Iterator[str]:
    """Yield the play or preload of rows that hold the shaft against each other, in words."""
    angled = [row for row in rows if row.drawn.row.contact_angle]
    if len({row.drawn.row.contact_angle > 0.0 for row in angled}) == 2:
        names = ", ".join(f'"{row.drawn.name}"' for row in angled)
        before = _state([row.drawn for row in angled])
        after = _state([row.warm for row in angled])
        yield f"pair {names}: {before} to {after}"


def _state(pair: Sequence[RollingBearing]) -> str:
    play, force = axial_state(pair)
    return f"preload {engineering(force, 4)} N" if play <= UNLOADED else f"play {1e6 * play:.4g} µm"


def axial_state(bearings: Sequence[RollingBearing]) -> tuple[float, float]:
    """Return play and preload of a shaft that nothing loads between rows with contact angles, m and N.

    The preload is the axial force of those that hold it along z; 0 where there is play.
    """
    # a row with a positive contact angle carries displacements along +z, one with a negative angle along -z
    ends: dict[float, list[float]] = {1.0: [], -1.0: []}
    for part in bearings:
        side = math.copysign(1.0, part.row.contact_angle)
        ends[side].append(side * part.row.clearance - row_law(part).shift)
    high, low = min(ends[1.0]), max(ends[-1.0])  # where the first row touches
    if high >= low:
        return high - low, 0.0

    def force(displacement: float, sides: tuple[float, ...] = (1.0, -1.0)) -> float:
        """Return the axial force of the rows whose contact angles have these signs, N."""
        opposed = (part for part in bearings if math.copysign(1.0, part.row.contact_angle) in sides)
        laws = (row_law(part) for part in opposed)
        return sum(
            float(law.loaded.evaluate((0.0, 0.0, displacement + law.shift, 0.0, 0.0)).force[2])
            for law in laws
        )

    rest = float(scipy.optimize.brentq(force, high, low, xtol=1e-15))
    return 0.0, force(rest, (1.0,))


def _mesh_displacement(rotor: LoadedRotor, rows: Sequence[WarmBearing]) -> float:
    """Return the largest change of the displacement at a mesh, linear between the bearings, m."""
    body = rotor.rotor
    changes, heights = [], []
    for row in rows:
        duty = rotor.mechanism.bearing_duty[row.drawn.name]
        changes.append(row_law(row.warm).deflection(duty) - row_law(row.drawn).deflection(duty))
        heights.append(body.shaft.origin[2] + row.drawn.position - float(body.center[2]))
    levers = [mesh.lever for mesh in rotor.meshes] or [0.0]
    line = np.polyfit(heights, changes, 1 if np.ptp(heights) > 0.0 else 0)
    return float(np.max(np.abs(np.polyval(line, levers))))
