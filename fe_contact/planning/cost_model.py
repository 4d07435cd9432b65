"""Prediction of the cost of a run, stage by stage.

Three dimensions: operations and numbers held follow from the elimination tree
(`fe_contact.compliance.cyclic_compliance`). The plane: a fit of non-negative terms to 40 compliances,
gears of 17 to 140 teeth, modules of 1 to 8 mm, solid and deep bodies, meshes of 0.3 to 2 times the standard
refinement; all are met within 0.67 to 1.32. The contact: positions to assemble and points to solve.
The sum is multiplied by the slowness of the host and by the corrections from earlier runs.

A constant without another unit is CPU seconds on the reference host of `model_studies.host_speed`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NamedTuple

from fe_contact.compliance import (
    PlaneHypothesis,
    free_ends_cached,
    predict_cost,
    section_cached,
    solid_cached,
)
from fe_contact.contact import ContactModel, teeth_in_reach
from fe_contact.contact.slices import POINTS
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.planning.cost_of_derivatives import ContactWork, CycleSeconds, solved_pitches
from fe_contact.planning.discretization import FaceDiscretization, PlaneDiscretization
from fe_contact.planning.plan import Plan
from fe_contact.sampled import ALIGNMENTS, LOADS, WIDE_INTERVALS, WIDE_PROBES, sampled_positions
from fe_contact.types import Json
from model_studies.host_speed import host_slowness
from model_studies.run_log import corrections

_PLANE_POSITION, _PLANE_POINT, _PLANE_CANDIDATE = 4e-5, 2e-6, 0.36e-6
_FACE_POSITION, _FACE_SLICE = 0.4e-6, 2.2e-5
"""CPU seconds of a position over the face: per slice of a tooth pair and square of the elements of a module
along the profile, and per slice.
"""
_FACE_CANDIDATE = 2e-6
_TOOTH_POINT, _BEGUN = 0.4e-6, 10e-6
"""CPU seconds in base pitches whose teeth differ: for the gaps of a touching point, and for the first load of
a set per carrying slice in addition to that of other loads.
"""
_TOUCHED = 14e-6
"""CPU seconds to find the touching point of a candidate on flanks that differ; met within 0.8 to 1.4."""
_FACE_TILT = 2.7
"""Cost of assembly with the change of the compliance along sloping flanks, over that without it."""
_PLANE_EXPECTED, _FACE_EXPECTED = (86.0, 0.37), (76.0, 0.25)
"""Final positions of the search at one load of a spur pair, and exponent of their growth with the number of
loads: handovers move with the load. Pairs at 1 to 12 loads are met within 10 %.
"""
_HANDED_OVER = 0.15
"""Overlap ratio over which teeth come into contact so gently that e times fewer positions are added."""
_ALLOWED = 1.5e-9
"""Interpolation error that the first positions keep where teeth are handed over gently, m. A smaller allowed
error needs more first positions in proportion. The ripple of helical pairs is small, so that a relative
tolerance without a floor allows less. Fitted to tables of eight helical pairs of overlap 0.25 to 2 at 1 to 16
loads: met within 0.6 to 1.5, under closer tolerances within 0.6 to 2.3; one more pair with a floor of 0.5 µm
at 0.6.
"""
_RIPPLE_STIFFNESS, _RIPPLE_OVERLAP = 2.8e10, 0.5
"""Line load over ripple, N/m^2, of a spur pair: half of the deflection of a pair of teeth; the overlap
ratio over which it falls by e."""
_AT_ONCE = 1.3
"""Additional cost of a point where all slices of a tooth touch at once, over the usual: 1.0 to 2.3."""
_UNLIKE = 1.4
"""Positions of a table whose teeth differ over those where teeth are alike, since each pitch has handovers of
its own: 64 to 248 positions for pairs of class 6. Run-out and waves leave the handovers alike.
"""
_TRIED_PER_NODE, _TRIED_PER_START = 9, 4
"""Positions that the search solves for each node that it adds, and for each node that it begins with."""
_ASSESSED = 3
"""Largest number of alignments that place the positions."""
_SOLVED_MIDDLES = 0.25
"""Part of the intervals between fixed positions whose middles are solved, at most."""
_PLANE_CHECK, _FACE_CHECK = 6e-3, 0.12
"""CPU seconds of the estimate of errors without its solutions; over the face those of the table too."""
_TABLE_POINT = 2e-6
"""CPU seconds to interpolate one point of a table."""
_STORED_POSITIONS, _STORED_PART = 320, 2.5
"""Positions whose compliance is held at once: of a search that begins with 64, and in parts of fixed ones."""
_POINT_NUMBERS = 25
"""Numbers in memory for each touching point."""

MAX_ROWS = 150_000
"""Most rows of a table: positions times alignments."""
POINTS_AT_ONCE = 2**18
"""Touching points of a part of the base pitches that is solved at once: enough that the rows of the
compliance, which are prepared once in each part, cost little."""
_PART_NUMBERS = 90
"""Numbers in memory for each touching point of such a part, with its solutions."""
_ROW_NUMBERS, _LOAD_NUMBERS = 150, 160
"""Numbers in memory for a row of a table, and for each load at it, its errors and force table included."""
STAGES = ("compliance", "contact", "error estimate")
PROCESS_BYTES = 210_000_000
"""Memory of a process with the libraries loaded and a small table, bytes."""
# CPU seconds of a gear in the plane: sector mesh, hub mesh, sector factors, ring, hub freedoms
_MESHER, _HUB = 0.036, 0.025
_SECTOR, _RING, _HUB_FREEDOM, _DEPTH = 1.89e-9, 2.06e-7, 5.34e-5, 2.72e-6
_DEEP_RING = 9.4
"""Depth of a body in modules beyond which the mesh has a hub: three root circle pitches."""
_READ_PLANE, _READ_SOLID = 1.5e-3, {True: 0.06, False: 0.02}
"""CPU seconds to read a cached compliance, in the plane, and over the face of a helical or a spur gear."""
_WORKING = 1.2
"""Memory of a condensation over the face over its largest working set: freed memory is not all used again."""
_READING = 1.25
"""Memory of a cached compliance over the face over its size: mirror image, and copies of blocks."""
_SECTOR_BYTES, _HUB_BYTES = 9_000, 12_000
"""Bytes for each freedom of a sector, and for each freedom of a hub with `_HUB_FREEDOMS` of them. The factors
of larger hubs have more entries for each freedom.
"""
_HUB_FREEDOMS, _FILL = 20_000, 0.33
# one gear over the face: mesher, factor, powers of layers and teeth, part of it for the coarse mesh
_SOLID_MESHER = 0.15
_SOLID_EFFORT = {
    "draft": (9.3e-5, 2.28, 1.11, 0.34),
    "medium": (9.7e-5, 2.43, 1.0, 0.3),
    "standard": (1.05e-4, 2.58, 0.89, 0.25),
    "fine": (7.3e-4, 2.35, 0.81, 0.19),
}
_FREE_ENDS = 0.35
"""CPU seconds of the solids that correct one gear for its finite width."""


def contact_seconds(
    pair: ParallelAxes,
    plan: Plan,
    model: ContactModel,
    alignments: tuple[int, int],
    *,
    with_errors: bool = True,
) -> tuple[float, float, float]:
    """Return CPU seconds of the search of positions, of the table, and of the solutions for its errors."""
    points, distances, loads = alignments[0] * alignments[1], alignments[1], plan.load.size
    period = model.period
    nodes, assessed = expected_positions(pair, plan, period, points), min(points, _ASSESSED)
    tried, window = expected_tries(pair, plan, period, points), plan.nodes.searched(period)
    work = unit_work(pair, plan, plan.discretization.slices)
    search = work.of(tried * distances, 0) + work.in_pitches(tried * assessed, (loads,), window)
    cycle = CycleSeconds.of(work, pair, period, nodes, (loads, plan.support.size))
    derived = with_errors and cycle.pays_in_table(period)
    table = work.of(nodes * distances, 0)
    table += points * (cycle.expected if derived else cycle.exact)
    table += _FACE_CHECK if plan.discretization.slices > 1 else 0.0
    if not with_errors:
        return search, table, 0.0
    solved = 1 + solved_pitches(period, in_table=True)[1] if derived else period
    return search, table, _errors(pair, plan, period, alignments, solved)


def _errors(pair: ParallelAxes, plan: Plan, period: int, alignments: tuple[int, int], solved: int) -> float:
    """Return CPU seconds of rougher solutions of a sample, of middles, and of held-out points of the axes.

    `solved` is the number of base pitches of the period that are solved.
    """
    discretization, loads = plan.discretization, plan.load.size
    tilts, distances = alignments
    nodes = expected_positions(pair, plan, period, tilts * distances)
    work = unit_work(pair, plan, discretization.slices)
    rougher = [work, *([work] if discretization.corrected else [])]
    if discretization.slices > 1:
        rougher.append(unit_work(pair, plan, discretization.coarse_slices))
    if plan.coarse_patch != plan.patch:
        rougher.append(work)
    sampled_loads, rows = min(loads, LOADS), sampled_positions(nodes).size
    sampled_tilts, sampled_distances = min(tilts, ALIGNMENTS), min(distances, ALIGNMENTS)
    assemblies, points = rows * sampled_distances, rows * sampled_tilts * sampled_distances
    seconds = sum(w.of(assemblies, 0) + w.in_pitches(points, (sampled_loads,), solved) for w in rougher)
    if plan.positions is not None or period > 1:
        middles, assessed = _SOLVED_MIDDLES * nodes, min(tilts * distances, _ASSESSED)
        in_pitches = work.in_pitches(middles * assessed, (sampled_loads,), solved)
        seconds += work.of(middles * distances, 0) + in_pitches
    validation_loads = (loads - 1) * (WIDE_PROBES if loads - 1 <= WIDE_INTERVALS else 1)
    validation = rows * (validation_loads + WIDE_PROBES * (tilts - 1) * sampled_loads)
    further_rows = rows * (distances - 1)
    seconds += work.of(further_rows, validation + further_rows * sampled_loads)
    seconds += _FACE_CHECK if discretization.slices > 1 else _PLANE_CHECK
    return seconds + _TABLE_POINT * nodes * period * tilts * distances * loads


def memory_of_contact(pair: ParallelAxes, plan: Plan, period: int, alignments: tuple[int, int]) -> float:
    """Return the bytes of compliance, touching points and table that are held at once."""
    stored = _STORED_POSITIONS if plan.positions is None else _STORED_PART * plan.positions
    count = _candidates(pair, plan.discretization.slices)
    points = count * (POINTS if plan.discretization.slices > 1 else 1)
    blocks = 2 if _with_tilt(pair, plan) else 1
    numbers = stored * (blocks * count**2 + _POINT_NUMBERS * points)
    if period > 1:
        rows = expected_positions(pair, plan, period, alignments[0] * alignments[1]) * period
        numbers += _PART_NUMBERS * min(rows * points, POINTS_AT_ONCE)
        loads = plan.load.size + plan.support.size
        numbers += rows * alignments[0] * alignments[1] * (_ROW_NUMBERS + _LOAD_NUMBERS * loads)
    return 8.0 * numbers


def _with_tilt(pair: ParallelAxes, plan: Plan) -> bool:
    """Whether the change of the compliance along the flanks is assembled, too: where patches follow them."""
    sloped = any(gear.modification.varies_along_profile for gear in (pair.pinion, pair.wheel))
    return sloped or not isinstance(plan.discretization, FaceDiscretization)


def _candidates(pair: ParallelAxes, slices: int) -> float:
    """Return about how many slices of tooth pairs a position has."""
    return float((pair.transverse_contact_ratio + pair.overlap_ratio + 1.0) * slices)


def unit_work(pair: ParallelAxes, plan: Plan, slices: int) -> ContactWork:
    """Return the work of one position and of one point at it, with this number of slices."""
    discretization = plan.discretization
    count, begun = _candidates(pair, slices), _BEGUN * pair.transverse_contact_ratio * slices
    if not isinstance(discretization, FaceDiscretization):
        point = _PLANE_POINT + _PLANE_CANDIDATE * count
        return ContactWork(_PLANE_POSITION, point, _TOOTH_POINT * count, begun, _TOUCHED * count)
    elements = max(pair.pinion.normal_module / recipe.flank_size for recipe in discretization.recipes)
    position = (_FACE_POSITION * elements**2 + _FACE_SLICE) * count
    tilted = _FACE_TILT * position if _with_tilt(pair, plan) else position
    at_once = 1.0 + _AT_ONCE * max(1.0 - pair.overlap_ratio, 0.0)
    point, pitch = at_once * _FACE_CANDIDATE * count, _TOOTH_POINT * POINTS * count
    return ContactWork(tilted, point, pitch, begun, _TOUCHED * count)


def expected_tries(pair: ParallelAxes, plan: Plan, period: int, alignments: int) -> int:
    """Return the positions at which the search usually solves; none if they are requested."""
    if plan.positions is not None:
        return 0
    added = max(expected_positions(pair, plan, period, alignments) - plan.nodes.start, 0)
    return _TRIED_PER_START * plan.nodes.start + _TRIED_PER_NODE * added


def expected_positions(pair: ParallelAxes, plan: Plan, period: int = 1, alignments: int = 1) -> int:
    """Return the positions in one base pitch: requested, or with which a search usually ends."""
    if plan.positions is not None:
        return plan.positions
    start, over_face = plan.nodes.start, isinstance(plan.discretization, FaceDiscretization)
    at_one_load, power = _FACE_EXPECTED if over_face else _PLANE_EXPECTED
    added = (at_one_load * plan.load.size**power - start) * math.exp(-pair.overlap_ratio / _HANDED_OVER)
    expected = start * (_finer(pair, plan) if over_face and period == 1 else 1.0) + added
    unlike = _unlike_teeth(pair.pinion) or _unlike_teeth(pair.wheel)
    times = _UNLIKE if period > 1 and unlike else 1.0
    return min(round(float(times * expected)), max_positions(plan, period * alignments))


def _unlike_teeth(gear: Toothing) -> bool:
    return bool(gear.tooth_flanks) or gear.pitch_deviation.period > 1


def _finer(pair: ParallelAxes, plan: Plan) -> float:
    """Return the factor of the first positions where no deviations add ripple."""
    lightest = float(plan.load.min()) / (pair.face_width * _RIPPLE_STIFFNESS)
    ripple = lightest * math.exp(-pair.overlap_ratio / _RIPPLE_OVERLAP)
    allowed = plan.nodes.tolerance * max(ripple, plan.nodes.least_ripple)
    halved = 2.0 ** math.floor(math.log2(plan.nodes.maximum / plan.nodes.start))
    return min(max(_ALLOWED / allowed, 1.0), halved) if allowed else halved


def max_positions(plan: Plan, times: int) -> int:
    """Return how many positions a search may end with; `times` is base pitches times alignments."""
    return max(min(plan.nodes.maximum, MAX_ROWS // times), plan.nodes.start)


class _Cost(NamedTuple):
    """CPU seconds of a compliance, bytes of the largest working set, and bytes that stay.

    A compliance that is not cached holds little in addition to its working set, and is counted there.
    """

    seconds: float
    working: float
    stored: float

    @classmethod
    def of(cls, parts: Iterable[_Cost]) -> _Cost:
        """Return the cost of parts one after the other."""
        costs = list(parts)
        working = max((cost.working for cost in costs), default=0.0)
        return cls(sum(cost.seconds for cost in costs), working, sum(cost.stored for cost in costs))


@dataclass(frozen=True)
class Prediction:
    """Predicted cost of one run."""

    parts: dict[str, dict[str, float]]
    """CPU seconds on this host by stage and part of it, in the order of the work."""
    correction: dict[str, float]
    """Factor by stage from earlier runs, 1 without any."""
    memory_bytes: int
    """Largest resident memory of the process."""
    positions: int
    """Number of positions of the table, expected where they are placed adaptively."""
    kind: str
    """Kind of the model, "plane" or "face": `run_log` corrects the two separately."""

    @property
    def raw(self) -> dict[str, float]:
        """CPU seconds by stage on this host, uncorrected."""
        return {stage: sum(parts.values()) for stage, parts in self.parts.items()}

    @property
    def stages(self) -> dict[str, float]:
        """CPU seconds by stage, corrected."""
        return {stage: seconds * self.correction[stage] for stage, seconds in self.raw.items()}

    @property
    def cpu_seconds(self) -> float:
        """CPU seconds of all stages."""
        return sum(self.stages.values())

    @property
    def logged(self) -> dict[str, float]:
        """Uncorrected times by the name under which the log keeps them."""
        return {log_name(self.kind, stage): seconds for stage, seconds in self.raw.items()}

    def to_json(self) -> Json:
        """Return plain JSON."""
        fields = {name: value for name, value in asdict(self).items() if name not in ("parts", "kind")}
        return {"stages": self.stages, "cpu_seconds": self.cpu_seconds} | fields


def log_name(kind: str, stage: str) -> str:
    """Return the name of a stage in the log of runs."""
    return f"{kind} {stage}"


def predict_run(
    pair: ParallelAxes,
    plan: Plan,
    model: ContactModel,
    alignments: tuple[int, int],
    cache: Path | None,
    *,
    with_errors: bool = True,
) -> Prediction:
    """Predict the cost of a table; nothing is meshed or solved.

    Parameters
    ----------
    model : ContactModel
        Model of the contact, whose period counts.
    alignments : (int, int)
        Numbers of misalignments and of center distances.
    cache : Path, optional
        Directory of compliances, which cost nothing if they are there, and of what is known of the host.
    with_errors : bool
        Whether errors are estimated: a minimal receipt has no such stage.
    """
    discretization = plan.discretization
    kind = "face" if isinstance(discretization, FaceDiscretization) else "plane"
    fine = _compliance(pair, plan, cache, coarse=False)
    coarse = _compliance(pair, plan, cache, coarse=True) if with_errors else _Cost(0.0, 0.0, 0.0)
    search, solve, check = contact_seconds(pair, plan, model, alignments, with_errors=with_errors)
    slowness = host_slowness(cache)
    # three dimensions: the cost of dense algebra is measured on this host
    speed = slowness if kind == "plane" else 1.0
    parts = {
        "compliance": {"bodies": fine.seconds * speed},
        "contact": {"positions": search * slowness, "table": solve * slowness},
        "error estimate": {"bodies": coarse.seconds * speed, "solutions": check * slowness},
    }
    known = corrections(cache)
    correction = {stage: known.get(log_name(kind, stage), 1.0) for stage in STAGES}
    positions = expected_positions(pair, plan, model.period, alignments[0] * alignments[1])
    memory = PROCESS_BYTES + memory_of_contact(pair, plan, model.period, alignments)
    memory += fine.stored
    memory += coarse.stored
    memory += max(fine.working, coarse.working)
    return Prediction(parts, correction, int(memory), positions, kind)


def _compliance(pair: ParallelAxes, plan: Plan, cache: Path | None, *, coarse: bool) -> _Cost:
    discretization = plan.discretization
    bodies = plan.bodies(pair)
    recipes = discretization.coarse_recipes if coarse else discretization.recipes
    gears = list(dict.fromkeys(zip((body.right_handed() for body in bodies), recipes, strict=True)))
    if isinstance(discretization, FaceDiscretization):
        solids = [(gear, recipe) for gear, recipe in gears if isinstance(recipe, SectorRecipe)]
        return _Cost.of(_solid(*solid, cache) for solid in solids)
    hypothesis = discretization.hypothesis
    costs = [
        _section(pair, gear, recipe, hypothesis, cache)
        for gear, recipe in gears
        if isinstance(recipe, MeshRecipe)
    ]
    return _Cost.of(costs if coarse else [*costs, *_free_ends(pair, bodies, discretization, cache)])


def _solid(gear: Toothing, recipe: SectorRecipe, cache: Path | None) -> _Cost:
    if size := solid_cached(gear, recipe, cache):
        return _Cost(_READ_SOLID[gear.helix_angle != 0.0], _READING * size, size)
    predicted = predict_cost(gear, recipe, cache=cache)
    return _Cost(predicted.seconds, _WORKING * predicted.bytes, 0.0)


def _free_ends(
    pair: ParallelAxes,
    bodies: tuple[Toothing, Toothing],
    discretization: PlaneDiscretization,
    cache: Path | None,
) -> Iterator[_Cost]:
    """Yield the cost of the solids that correct the plane: free at their ends, and held along the axis."""
    if discretization.finite_width is None:
        return
    teeth = condensed_teeth(pair)
    for gear, recipe in dict.fromkeys(zip(bodies, discretization.finite_width, strict=True)):
        if size := free_ends_cached(gear, recipe, teeth, cache):
            yield _Cost(_READ_PLANE, 0.0, size)
        else:
            predicted = predict_cost(gear, recipe, cache=cache)
            yield _Cost(2.0 * predicted.seconds, _WORKING * predicted.bytes, 0.0)


def _section(
    pair: ParallelAxes, gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, cache: Path | None
) -> _Cost:
    if size := section_cached(gear, recipe, hypothesis, condensed_teeth(pair), cache):
        return _Cost(_READ_PLANE, 0.0, size)
    return _Cost(*_section_cost(gear, recipe), 0.0)


def body_seconds(gear: Toothing, recipe: MeshRecipe | SectorRecipe, cache: Path | None) -> float:
    """Return the CPU seconds of the compliance of a gear that is not kept."""
    if isinstance(recipe, SectorRecipe):
        return predict_cost(gear.right_handed(), recipe, cache=cache).seconds
    return host_slowness(cache) * _section_cost(gear, recipe)[0]


def _section_cost(gear: Toothing, recipe: MeshRecipe) -> tuple[float, float]:
    """Return CPU seconds and bytes of one gear in the plane on the reference host, as fitted (see above)."""
    fineness = 0.05 * gear.normal_module / recipe.flank_size
    sector = 5000.0 * fineness**1.73
    depth = abs(gear.root_radius - gear.seat_radius) / gear.normal_module
    if gear.web is not None or depth > _DEEP_RING:
        hub = gear.teeth * 235.0 * fineness**1.45 * min(1.0, gear.teeth / 60.0) ** 0.7
        seconds = _MESHER + _HUB + _HUB_FREEDOM * hub
    else:
        hub = gear.teeth * (25.0 + 5.0 * depth) * fineness**0.6
        seconds = _MESHER + _HUB_FREEDOM * hub + _DEPTH * depth * sector
    seconds += _SECTOR * sector**2 + _RING * gear.teeth * sector
    return seconds, _SECTOR_BYTES * sector + _HUB_BYTES * hub * (hub / _HUB_FREEDOMS) ** _FILL


def condensed_teeth(pair: ParallelAxes) -> int:
    """Return the number of teeth in the plane that can touch at once, as many as both gears have."""
    fits = min(pair.pinion.teeth, pair.wheel.teeth)
    return min(teeth_in_reach(pair), fits - 1 + fits % 2)


def effort(pair: ParallelAxes, plan: Plan, model: ContactModel, alignments: tuple[int, int]) -> float:
    """Return the work of a run with nothing in the cache, CPU seconds of the host of the constants.

    Parameters are those of `predict_run`.
    """
    discretization = plan.discretization
    bodies = tuple(body.right_handed() for body in plan.bodies(pair))
    work = sum(contact_seconds(pair, plan, model, alignments))
    if isinstance(discretization, FaceDiscretization):
        factor, by_layers, by_teeth, coarse = _SOLID_EFFORT[plan.level]
        solids = []
        for gear, recipe in dict.fromkeys(zip(bodies, discretization.recipes, strict=True)):
            seconds = float(factor * recipe.layers**by_layers * gear.teeth**by_teeth)
            solids.append(2.0 * _SOLID_MESHER + (1.0 + coarse) * seconds)
        return work + sum(solids)
    for recipes in (discretization.recipes, discretization.coarse_recipes):
        sections = dict.fromkeys(zip(bodies, recipes, strict=True))
        work += sum(_section_cost(gear, recipe)[0] for gear, recipe in sections)
    return work + (_FREE_ENDS * len(dict.fromkeys(bodies)) if discretization.corrected else 0.0)
