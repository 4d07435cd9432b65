"""Random cases: what is requested, how each is measured, and the kind of its end."""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, Literal

import numpy as np

from fe_contact.analysis.analyze import analyze
from fe_contact.analysis.studies.frontier import warm_up
from fe_contact.geometry import (
    FlankGrid,
    FlankModification,
    Gear,
    GearPair,
    InternalGearPair,
    ParallelAxes,
    RingGear,
)
from fe_contact.material import Material
from fe_contact.ste import SteDatabase
from lineofaction.hardcases.contact.laws import LARGEST_RESIDUAL, MAX_ITERATIONS
from lineofaction.hardcases.scene import HardScene, Measured, Outcome, largest

_NODES = (2, 12)
"""Fewest nodes of an axis, and one more than the most."""


def _with_random_grid(gear: Gear, random: np.random.Generator, size: float, across_face: bool) -> Gear:
    """Return the gear with a grid of its own, `size` modules high; in the plane all as mid-face."""
    profile, face = (int(count) for count in random.integers(*_NODES, 2))
    heights = random.uniform(0.0, size * gear.normal_module, (profile, face if across_face else 1))
    grid = FlankGrid(
        tuple(np.linspace(gear.form_roll_length, gear.tip_roll_length, profile)),
        tuple(np.linspace(-0.5, 0.5, face) * gear.face_width),
        tuple(map(tuple, np.broadcast_to(heights, (profile, face)).tolist())),
    )
    return replace(gear, modification=replace(gear.modification, flank_grid=grid))


# Random requests from the whole input space: where gears live, one field astray, or all of them.


Kind = Literal["plane", "face"]
Fields = dict[str, Any]

_LINE_LOAD = 10e6
"""Nominal force over face width and module in Pa, for steel; loads run from 1e-4 to 1e3 times it."""
_ASTRAY = ((0.0, 0.4), (0.06, 0.4), (0.5, 0.2))
"""Chances that a field is drawn from everywhere, and how often each chance is taken."""
_INTERNAL, _FREE_FORM = 0.25, 0.15
"""Part of the cases with a ring gear; part of the external gears with a free-form flank."""


class _Draw:
    """Random numbers, and whether a field strays from where gears live."""

    def __init__(self, kind: Kind, seed: int) -> None:
        self.random = np.random.default_rng([seed, len(kind)])
        self.across_face = kind == "face"
        chances, weights = zip(*_ASTRAY, strict=True)
        self.chance = float(self.random.choice(chances, p=weights))

    def between(self, usual: tuple[float, float], anywhere: tuple[float, float]) -> float:
        return float(self.random.uniform(*(anywhere if self.random.random() < self.chance else usual)))

    def power(self, usual: tuple[float, float], anywhere: tuple[float, float]) -> float:
        return float(10.0 ** self.between(usual, anywhere))

    def sometimes(self, part: float) -> bool:
        return bool(self.random.random() < part)


def random_request(kind: Kind, seed: int) -> tuple[ParallelAxes, Fields]:
    """Return the pair and the other arguments of `analyze` that `seed` picks; a refusal is as good an end."""
    draw = _Draw(kind, seed)
    rack = _rack(draw)
    pinion = _gear(draw, rack)
    pair = _internal(draw, rack, pinion) if draw.sometimes(_INTERNAL) else _external(draw, rack, pinion)
    if draw.sometimes(0.5):
        # gears of an internal pair part, or come closer, the other way round
        change = draw.between((0.0, 0.15), (-0.3, 0.8)) * pair.wheel.sign
        pair = replace(pair, center_distance=pair.center_distance + change * pinion.normal_module)
    return pair, _arguments(draw, pair)


def _external(draw: _Draw, rack: Fields, pinion: Gear) -> GearPair:
    if draw.sometimes(0.3):
        return GearPair(pinion, replace(pinion, helix_angle=-pinion.helix_angle))
    return GearPair(pinion, _gear(draw, rack | {"helix_angle": -rack["helix_angle"]}))


def _internal(draw: _Draw, rack: Fields, pinion: Gear) -> InternalGearPair:
    module = pinion.normal_module
    teeth = round(pinion.teeth * draw.between((1.6, 4.0), (0.8, 8.0)))
    shift = draw.between((-0.3, 0.2), (-2.0, 2.0))
    root = (teeth / math.cos(rack["helix_angle"]) + 2.0 * (rack["dedendum_coefficient"] - shift)) * module
    width = pinion.face_width * draw.between((0.8, 1.2), (0.1, 3.0))
    fields: Fields = {
        "teeth": teeth,
        "face_width": width,
        "rim_diameter": draw.between((1.08, 1.5), (0.9, 3.0)) * root,
        "profile_shift_coefficient": shift,
        "addendum_coefficient": draw.between((0.6, 0.9), (0.2, 2.0)),
        "cutter_teeth": round(draw.between((18.0, 35.0), (5.0, 100.0))),
        "thickness_allowance": draw.between((0.0, 0.1), (0.0, 0.5)) * module * draw.sometimes(0.5),
        "material": _material(draw),
        "modification": _modification(draw, module, width),
    }
    return InternalGearPair(pinion, RingGear(**(rack | fields)))


def _rack(draw: _Draw) -> Fields:
    helical = draw.sometimes(0.7 if draw.across_face else 0.03)
    return {
        "normal_module": draw.power((-3.7, -1.4), (-5.0, -0.5)),
        "normal_pressure_angle": math.radians(draw.between((14.5, 25.0), (3.0, 40.0))),
        "helix_angle": draw.between((0.001, 0.6), (0.0, 1.0)) if helical else 0.0,
        "dedendum_coefficient": draw.between((1.15, 1.45), (0.3, 2.5)),
        "root_radius_coefficient": draw.between((0.0, 0.3), (0.0, 0.6)),
    }


def _gear(draw: _Draw, rack: Fields) -> Gear:
    module = float(rack["normal_module"])
    teeth = round(draw.power((1.0, 1.8), (0.3, 3.5)))
    shift = draw.between((-0.2, 0.5), (-2.0, 2.0))
    root = (teeth / math.cos(rack["helix_angle"]) + 2.0 * (shift - rack["dedendum_coefficient"])) * module
    width = module * draw.power((0.3, 1.3), (-2.0, 2.0))
    fields: Fields = {
        "teeth": teeth,
        "face_width": width,
        "bore_diameter": draw.between((0.1, 0.8), (0.02, 1.1)) * max(root, module),
        "profile_shift_coefficient": shift,
        "addendum_coefficient": draw.between((0.8, 1.1), (0.2, 2.0)),
        "thickness_allowance": draw.between((0.0, 0.1), (0.0, 0.5)) * module * draw.sometimes(0.5),
        "material": _material(draw),
        "modification": _modification(draw, module, width),
    }
    gear = Gear(**(rack | fields))
    if not draw.sometimes(_FREE_FORM):
        return gear
    return _with_random_grid(gear, draw.random, draw.power((-4.5, -2.3), (-6.0, -0.5)), draw.across_face)


def _material(draw: _Draw) -> Material:
    if draw.sometimes(0.6):
        return Material()
    return Material(draw.power((9.0, 11.5), (7.0, 13.0)), draw.between((0.2, 0.45), (0.0, 0.52)))


def _modification(draw: _Draw, module: float, width: float) -> FlankModification:
    """Return flanks with none, some or all of the simple modifications, in proportion to the module."""
    size = module * draw.power((-4.5, -2.3), (-6.0, -0.5))

    def or_none(value: Callable[[], float]) -> float:
        return value() if draw.sometimes(0.3) else 0.0

    fields: Fields = {"profile_crowning": or_none(lambda: size), "profile_slope": or_none(lambda: -size)}
    if draw.sometimes(0.4):
        fields |= {"tip_relief": size, "tip_relief_length": draw.between((0.02, 0.8), (0.0, 3.0)) * module}
        fields["tip_relief_shape"] = "linear" if draw.sometimes(0.5) else "parabolic"
    if draw.across_face:
        fields |= {"helix_crowning": or_none(lambda: size), "helix_slope": or_none(lambda: size)}
        if draw.sometimes(0.2):
            fields |= {"end_relief": size, "end_relief_length": draw.between((0.05, 0.4), (0.0, 1.0)) * width}
    return FlankModification(**fields)


def _arguments(draw: _Draw, pair: ParallelAxes) -> Fields:
    module = pair.pinion.normal_module
    softest = min(gear.material.youngs_modulus for gear in (pair.pinion, pair.wheel))
    nominal = _LINE_LOAD * pair.face_width * module * softest / 210e9
    low, high = np.sort([draw.between((-3.0, 0.5), (-4.0, 3.0)) for _ in range(2)])
    count = int(draw.random.integers(1, 6))
    in_plane = str(draw.random.choice(["plane_strain", "plane_strain", "plane_stress", "auto"]))
    arguments: Fields = {
        "normal_forces": (nominal * np.geomspace(10.0**low, 10.0**high, count)).tolist(),
        "level": "draft",
        "positions": 16 if draw.across_face else 32,
        "receipt": "minimal",
        "model": "3d" if draw.across_face else in_plane,
    }
    if draw.across_face and draw.sometimes(0.6):
        arguments["misalignments"] = [0.0, module * draw.power((-4.5, -1.5), (-6.0, 0.0))]
    if draw.sometimes(0.2):
        arguments["center_distance_changes"] = [0.0, module * draw.between((0.0, 0.1), (-0.5, 1.0))]
    return arguments


# One case of the sweep: a table that obeys the conditions of contact, within the time it was predicted.


_SLACK = 3.0
"""How many times its predicted time a case may take, on a host that is busy with other things."""
_START = 3.0
"""Seconds on top: a prediction knows no start-up and no compilation."""
_HANGS = 3600.0
"""Elapsed seconds after which a case counts as hanging; the longest take minutes of CPU time."""


def sweep_case(kind: Kind, seed: int) -> HardScene:
    return HardScene(
        f"{kind}_{seed}",
        "sweep",
        "Anything may come.",
        "A converged table with residuals below tolerance, within its predicted time, or one clear refusal.",
        partial(_measure, kind, seed),
        _HANGS,
    )


def _measure(kind: Kind, seed: int) -> Sequence[Measured]:
    """Compute the table that `seed` picks; what a process does once is done before."""
    warm_up(across_face=kind == "face")
    pair, arguments = random_request(kind, seed)
    return assessed(pair, arguments)


def assessed(pair: ParallelAxes, arguments: Mapping[str, Any]) -> Sequence[Measured]:
    """Analyze a pair and assess the table by what every table must obey."""
    table = analyze(pair, **arguments)
    receipt = table.metadata.receipt
    predicted = float(receipt["prediction"]["cpu_seconds"])
    spent = float(receipt["cpu_seconds"])
    return (
        Measured("failed points", table.n_failed, maximum=0.0),
        Measured("points", table.status.size),
        Measured("largest residual", receipt["residuals_max"], maximum=LARGEST_RESIDUAL),
        Measured("most iterations", receipt["newton_iterations_max"], maximum=MAX_ITERATIONS),
        Measured("values that are no numbers", _none(table), maximum=0.0),
        Measured("least growth of STE with load, relative", _growth(table), minimum=0.0),
        Measured("load shares off one", largest(table.load_share.sum(axis=-1) - 1.0), maximum=1e-9),
        Measured("least load share", table.load_share.min(), minimum=-1e-12),
        Measured("force at lift-off, N", _force_at_lift_off(table), maximum=0.0),
        Measured("CPU time, s", spent, maximum=_SLACK * predicted + _START),
        Measured("predicted CPU time, s", predicted),
        Measured("points whose contact outgrew its patch", receipt["patch_outgrown_points"]),
    )


def _none(table: SteDatabase) -> int:
    names = (
        "static_transmission_error",
        "tangent_compliance",
        "no_load_transmission_error",
        "load_share",
        "face_centroid",
        "load_arm",
        "max_pressure",
    )
    return sum(int(np.count_nonzero(~np.isfinite(getattr(table, name)))) for name in names)


def _growth(table: SteDatabase) -> float:
    """Return the least growth of STE from load to load over the elastic deflection."""
    lift_off = table.no_load_transmission_error[:, None]
    elastic = np.concatenate([lift_off, table.static_transmission_error], axis=1) - lift_off
    return float((np.diff(elastic, axis=1) / elastic[:, -1:]).min())


def _force_at_lift_off(table: SteDatabase) -> float:
    """Return the largest force that the table gives where the flanks just touch, N."""
    deflection = table.no_load_transmission_error[:, 0, 0]
    return float(np.max(table.force_at(table.position, deflection).force))


# The outcome of a random case.


LONGEST_REFUSAL = 500
"""Characters of a refusal that is still one clear error."""
_REFUSAL = re.compile(r"(InputError|InfeasibleGeometry): .* = .*: must be .+")


def kind_of_end(outcome: Outcome) -> str:
    """Return "table" (sound), "refusal" (one clear error) or what it should not be.

    That is "unsound" (a figure out of its bounds), "unclear" (a refusal that is long, or names no field and
    bound), "mesh" and "solve" (errors of the library that are no refusals), "hang", "crash" or "exception".
    """
    if outcome.passed:
        return "table"
    text = outcome.ended_by
    if not text:
        return "unsound"
    if text.startswith(("InputError: ", "InfeasibleGeometry: ")):
        clear = len(text) < LONGEST_REFUSAL and "\n" not in text and _REFUSAL.fullmatch(text)
        return "refusal" if clear else "unclear"
    ends = {
        "MeshError: ": "mesh",
        "SolveError: ": "solve",
        "not done after": "hang",
        "its process ended": "crash",
    }
    return next((end for start, end in ends.items() if text.startswith(start)), "exception")
