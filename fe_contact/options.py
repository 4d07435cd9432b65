"""Options of a computation and of its run; light: neither mesher nor finite elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

from bounds import SiNote
from fe_contact.allowed_error import RELATIVE, AllowedError
from fe_contact.errors import InputError, increasing, integer, positive, within
from fe_contact.geometry import ParallelAxes
from fe_contact.types import FloatArray, Json
from model_studies import Progress, silent
from model_studies.progress import Report, TableFraction
from model_studies.workers import InProcess, Workers

LARGEST_DEVIATION = 0.01
"""Largest value of an axis, m. Larger ones are taken for micrometers given as meters."""
LARGEST_PERIOD = 1_000_000
Levels = Sequence[float] | FloatArray
OnPlan = Callable[[Mapping[str, float]], None]
"""Callback for the predicted CPU seconds of the stages of a table, in their order, before it is computed."""
LEVELS = ("draft", "standard", "fine")
"""Meshes of every pair, the coarsest first."""
MEDIUM = "medium"
"""Mesh between draft and standard that a tolerance may choose for relieved helical pairs alone."""
MESHES = ("draft", MEDIUM, "standard", "fine")
"""All meshes, the coarsest first."""
CHOICES = {
    "level": (None, *MESHES),
    "model": ("auto", "plane_strain", "plane_stress", "3d"),
    "receipt": ("full", "minimal"),
    "on_violation": ("repeat", "fail", "report"),
}


@dataclass(frozen=True)
class TableAxes:
    """The axes of a table of transmission error.

    Raises `InputError`: a value that cannot be used, by field name.
    """

    torques: Levels | None = None
    normal_forces: Levels | None = None
    """`torques`, `normal_forces`: Torques on the driving gear in N m, or normal forces F_bn in N: exactly
    one, increasing, > 0.
    """
    misalignments: Levels = (0.0,)
    center_distance_changes: Levels = (0.0,)
    """`misalignments`, `center_distance_changes`: Nodes of both axes, m, increasing. Misalignment is the tilt
    of the axes in the plane of action as growth of the gap over the common face width, zero at the pitch
    point in its middle.
    """
    pitches: int | None = None
    """Number of base pitches that the table covers if gears have pitch deviations; default: the full period.
    A smaller number closes the table on itself: at its seam teeth are adjacent that never mesh.
    """

    def __post_init__(self) -> None:
        if (self.torques is None) == (self.normal_forces is None):
            bound = "given, or normal_forces instead"
            raise InputError("torques", self.torques, bound, "Give exactly one of the two.")
        remedy = "Loads start above zero; the no-load curve is always in the table."
        positive(f"{self.loads_as}[0]", float(self._levels[0]), remedy)
        for name in ("misalignments", "center_distance_changes"):
            for i, value in enumerate(increasing(name, getattr(self, name))):
                ends = -LARGEST_DEVIATION, LARGEST_DEVIATION
                within(f"{name}[{i}]", float(value), *ends, SiNote("In m: 30 µm is 3e-5."))
        if self.pitches is not None:
            integer("pitches", self.pitches, 1, LARGEST_PERIOD)

    @property
    def loads_as(self) -> str:
        """Kind of the load: "torques" or "normal_forces"."""
        return "normal_forces" if self.torques is None else "torques"

    @property
    def _levels(self) -> FloatArray:
        return increasing(self.loads_as, getattr(self, self.loads_as))

    @property
    def misalignment(self) -> FloatArray:
        """Misalignments (M,), m."""
        return increasing("misalignments", self.misalignments)

    @property
    def center_distance_change(self) -> FloatArray:
        """Changes of the center distance (D,), m."""
        return increasing("center_distance_changes", self.center_distance_changes)

    def load(self, pair: ParallelAxes) -> FloatArray:
        """Return the load levels as normal forces F_bn of a pair (F,), N."""
        return self._levels if self.torques is None else pair.normal_force(self._levels)


@dataclass(frozen=True)
class OperatingPoint:
    """One load and one alignment of a pair, for results on flanks, roots and deformed gears."""

    torque: float | None = None
    normal_force: float | None = None
    """`torque`, `normal_force`: Torque on the driving gear in N m, or normal force F_bn in N; exactly one."""
    misalignment: float = 0.0
    center_distance_change: float = 0.0
    """`misalignment`, `center_distance_change`: Alignment in the terms of `TableAxes`, m."""

    @property
    def axes(self) -> TableAxes:
        """The axes of a table of this point alone."""
        return TableAxes(
            torques=None if self.torque is None else [self.torque],
            normal_forces=None if self.normal_force is None else [self.normal_force],
            misalignments=[self.misalignment],
            center_distance_changes=[self.center_distance_change],
        )


def _unplanned(_stages: Mapping[str, float]) -> None:
    """Take no note of a plan."""


@dataclass(frozen=True)
class Run:
    """Workers, cache and progress of a run. They change no bit of its results."""

    workers: Workers = InProcess()  # noqa: RUF009 (frozen)
    """Executor of condensation, contact, searches and samples: this process, a pool or a cluster. Receipts
    count the CPU time of all workers.
    """
    cache: Path | None = None
    """Directory of flank compliances: with it each gear is condensed once."""
    progress: Progress = silent
    """Callback for progress, called as progress(stage, fraction); studies of several tables start again with
    each table.
    """
    on_plan: OnPlan = _unplanned
    """Callback for the predicted CPU seconds by stage of each table, and of each pass of a table."""

    @property
    def silent(self) -> Run:
        """The same without reports of progress."""
        return replace(self, progress=silent, on_plan=_unplanned)

    def reporting(self, report: Report, *, refines: bool = False) -> Run:
        """Return the same for a table within the stage of a study.

        `report`: called with the fraction done of the table, by the predicted cost of its stages. `refines`:
        another pass may follow, as under a tolerance.
        """
        table = TableFraction(refines=refines)

        def progress(stage: str, fraction: float) -> None:
            report(table.at(stage, fraction))

        return replace(self, progress=progress, on_plan=table.plan)


@dataclass(frozen=True)
class AnalysisOptions:
    """Accuracy, model and effects of an analysis: a tolerance, a time budget, both, or a level.

    None of them means the level "standard". Raises `InputError`: a value that cannot be used, by field name,
    or a level together with a tolerance or a time budget.
    """

    tolerance: AllowedError | None = None
    """Tolerance of mean and peak-to-peak STE, for the errors that finer discretizations lower. A table is
    refined by its measured errors until it meets the tolerance, in at most four passes (`receipt["passes"]`).
    `receipt["tolerance"]` states whether it is met, or why not.
    """
    time_budget: float | None = None
    """CPU seconds that the run may take. With a tolerance, refinement ends before it would exceed them."""
    level: str | None = None
    """Level of the mesh: "draft", "medium", "standard" or "fine"."""
    model: str = "auto"
    """Contact model: "auto" (three dimensions where the scene acts across the face, else plane strain
    corrected for the finite face width), "plane_strain", "plane_stress" or "3d".
    """
    positions: int | None = None
    """Number of equally spaced positions of a table in a base pitch; default: nodes placed so that
    interpolation keeps 0.2 % of peak-to-peak.
    """
    effects: Mapping[str, str] = field(default_factory=dict)
    """Choice by effect name: "on", "off" or "auto"; effects that are not named are "auto"."""
    receipt: str = "full"
    """Receipt of a table. "full" measures its errors by source. "minimal" does not estimate errors: they are
    NaN, and the receipt states it.
    """
    on_violation: str = "repeat"
    """Action if the solution violates an assumption (`receipt["assumptions"]`): "repeat" enables the
    automatic effect that is needed and solves again, "fail" raises, "report" reports it.
    """

    def __post_init__(self) -> None:
        wishes = [name for name in ("tolerance", "time_budget") if getattr(self, name) is not None]
        if wishes and self.level is not None:
            bound = f"left out when {wishes[0]} is given"
            raise InputError("level", self.level, bound, "A level is a mesh, regardless of cost.")
        if self.time_budget is not None:
            positive("time_budget", self.time_budget, "Seconds.")
        for name, choices in CHOICES.items():
            if (value := getattr(self, name)) not in choices:
                raise InputError(name, value, f"one of {', '.join(filter(None, choices))}")
        if self.positions is not None:
            remedy = "64 resolve a spur pair; leave it out for adaptive nodes."
            integer("positions", self.positions, 8, 4096, remedy)

    @property
    def allowed(self) -> AllowedError:
        """Error that counts as small: the tolerance, or a part of each quantity without one."""
        return self.tolerance or RELATIVE

    @property
    def refines(self) -> bool:
        """Whether a table is refined by its measured errors: those of a minimal receipt are not known."""
        return self.tolerance is not None and self.receipt == "full"

    def at_level(self, level: str) -> AnalysisOptions:
        """Return the options with a level of mesh in place of a tolerance or a time budget."""
        return replace(self, tolerance=None, time_budget=None, level=level)

    def to_json(self) -> Json:
        """Return plain JSON as a request echoes it."""
        names = "time_budget", "level", "model", "positions", "receipt"
        accuracy: Json = {name: getattr(self, name) for name in names}
        accuracy["tolerance"] = None if self.tolerance is None else asdict(self.tolerance)
        effects = dict(sorted(self.effects.items()))
        return {"accuracy": accuracy, "effects": effects, "on_violation": self.on_violation}
