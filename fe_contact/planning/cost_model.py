"""What a run will cost, stage by stage, before anything is computed.

Three dimensions: operations and numbers held follow from the elimination tree
(`fe_contact.compliance.cost_3d`). The plane: a fit of non-negative terms to 40 measured compliances, gears
of 17 to 140 teeth, modules of 1 to 8 mm, solid and deep bodies, meshes of 0.3 to 2 times the standard
refinement; all are met within 0.67 to 1.32. The contact: positions to assemble and points to solve.
Everything is then multiplied by how slow the host is and by what earlier runs say.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from fe_contact.compliance import PlaneHypothesis, free_ends_are_kept, is_kept, plane_is_kept, predict_cost
from fe_contact.contact import ContactModel, teeth_in_reach
from fe_contact.geometry import ParallelAxes, Toothing
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.planning.contact_cost import contact_seconds, expected_positions
from fe_contact.planning.discretisation import FaceDiscretisation, PlaneDiscretisation
from fe_contact.planning.host_speed import host_slowness
from fe_contact.planning.plan import Plan
from fe_contact.planning.run_log import corrections
from fe_contact.types import Json

STAGES = ("compliance", "contact", "error estimate")
PROCESS_BYTES = 350_000_000
"""Of a process with the libraries loaded."""

# CPU seconds of a gear in the plane: process of the mesher, hub mesh, sector factors, ring, hub freedoms
_MESHER, _HUB = 0.095, 0.025
_SECTOR, _RING, _HUB_FREEDOM, _DEPTH = 1.89e-9, 2.06e-7, 5.34e-5, 2.72e-6
_DEEP_RING = 9.4
"""Depth of a body in modules beyond which the mesh has a hub: three root circle pitches."""

_READ_PLANE, _READ_SOLID = 1.5e-3, {True: 0.02, False: 0.007}
"""CPU seconds to read what is kept of a gear in the plane, and over the face of a helical or a spur gear."""
_BYTES_PER_UNKNOWN = 9_000


@dataclass(frozen=True)
class Prediction:
    """Predicted cost of one run.

    Attributes
    ----------
    raw : dict
        CPU seconds by stage on this host.
    correction : dict
        Factor by stage from earlier runs, 1 without any.
    memory_bytes : int
        Largest resident memory of the process.
    positions : int
        Of the table, expected where they are placed adaptively.
    kind : str
        "plane" or "face": what `run_log` keeps apart.
    """

    raw: dict[str, float]
    correction: dict[str, float]
    memory_bytes: int
    positions: int
    kind: str

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
        return {"stages": self.stages, "cpu_seconds": self.cpu_seconds} | {
            name: value for name, value in asdict(self).items() if name not in ("raw", "kind")
        }


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
    pair : GearPair or InternalGearPair
    plan : Plan
    model : ContactModel
        For the base pitches of its period.
    alignments : (int, int)
        Numbers of misalignments and of centre distances.
    cache : Path, optional
        Directory of compliances, which cost nothing if they are there, and of what is known of the host.
    with_errors : bool
        Whether errors are estimated: a minimal receipt has no such stage.
    """
    made = plan.discretisation
    kind = "face" if isinstance(made, FaceDiscretisation) else "plane"
    fine = _compliance(pair, plan, cache, coarse=False)
    coarse = _compliance(pair, plan, cache, coarse=True) if with_errors else (0.0, 0.0)
    solve, check = contact_seconds(pair, plan, model, alignments, with_errors=with_errors)
    slowness = host_slowness(cache)
    # dense algebra has its own measurement of the host in it
    speed = slowness if kind == "plane" else 1.0
    raw = {
        "compliance": fine[0] * speed,
        "contact": solve * slowness,
        "error estimate": coarse[0] * speed + check * slowness,
    }
    known = corrections(cache)
    correction = {stage: known.get(log_name(kind, stage), 1.0) for stage in STAGES}
    memory = PROCESS_BYTES + int(max(fine[1], coarse[1]))
    return Prediction(raw, correction, memory, expected_positions(pair, plan), kind)


def _compliance(pair: ParallelAxes, plan: Plan, cache: Path | None, *, coarse: bool) -> tuple[float, float]:
    """CPU seconds and bytes of both gears' compliance; gears alike are computed once."""
    made = plan.discretisation
    bodies = plan.bodies(pair)
    recipes = made.coarse_recipes if coarse else made.recipes
    gears = list(dict.fromkeys(zip((body.right_handed() for body in bodies), recipes, strict=True)))
    if isinstance(made, FaceDiscretisation):
        costs = [_solid(gear, recipe, cache) for gear, recipe in gears if isinstance(recipe, SectorRecipe)]
    else:
        hypothesis = made.hypothesis
        costs = [
            _section(pair, gear, recipe, hypothesis, cache)
            for gear, recipe in gears
            if isinstance(recipe, MeshRecipe)
        ]
        if not coarse:
            costs += _free_ends(pair, bodies, made, cache)
    return sum(seconds for seconds, _ in costs), max((size for _, size in costs), default=0.0)


def _solid(gear: Toothing, recipe: SectorRecipe, cache: Path | None) -> tuple[float, float]:
    """One gear over the face."""
    if is_kept(gear, recipe, cache):
        return _READ_SOLID[gear.helix_angle != 0.0], 0.0
    predicted = predict_cost(gear, recipe)
    return predicted.seconds, float(predicted.bytes)


def _free_ends(
    pair: ParallelAxes,
    bodies: tuple[Toothing, Toothing],
    made: PlaneDiscretisation,
    cache: Path | None,
) -> list[tuple[float, float]]:
    """Return the cost of the solids that correct the plane: free at their ends, and held along the axis."""
    if made.finite_width is None:
        return []
    pairs = dict.fromkeys(zip(bodies, made.finite_width, strict=True))
    teeth = condensed_teeth(pair)
    found = [None if free_ends_are_kept(*of, teeth, cache) else predict_cost(*of) for of in pairs]
    return [(_READ_PLANE, 0.0) if cost is None else (2.0 * cost.seconds, float(cost.bytes)) for cost in found]


def _section(
    pair: ParallelAxes, gear: Toothing, recipe: MeshRecipe, hypothesis: PlaneHypothesis, cache: Path | None
) -> tuple[float, float]:
    """One gear in the plane."""
    if plane_is_kept(gear, recipe, hypothesis, condensed_teeth(pair), cache):
        return _READ_PLANE, 0.0
    return section_cost(gear, recipe)


def section_cost(gear: Toothing, recipe: MeshRecipe) -> tuple[float, float]:
    """CPU seconds and bytes of one gear in the plane on the reference host."""
    fineness = 0.05 * gear.normal_module / recipe.flank_size
    sector = 5000.0 * fineness**1.73
    depth = abs(gear.root_radius - gear.held_radius) / gear.normal_module
    if gear.web is not None or depth > _DEEP_RING:
        hub = gear.teeth * 235.0 * fineness**1.45 * min(1.0, gear.teeth / 60.0) ** 0.7
        seconds = _MESHER + _HUB + _HUB_FREEDOM * hub
    else:
        hub = gear.teeth * (25.0 + 5.0 * depth) * fineness**0.6
        seconds = _MESHER + _HUB_FREEDOM * hub + _DEPTH * depth * sector
    seconds += _SECTOR * sector**2 + _RING * gear.teeth * sector
    return seconds, _BYTES_PER_UNKNOWN * (sector + 0.3 * hub)


def condensed_teeth(pair: ParallelAxes) -> int:
    """Return the number of teeth in the plane that can touch at once, as many as both gears have."""
    fits = min(pair.pinion.teeth, pair.wheel.teeth)
    return min(teeth_in_reach(pair), fits - 1 + fits % 2)
