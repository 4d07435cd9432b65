"""Study of a complaint: the likely mesh and harmonic, other excitations near it, modes within reach.

The parting of a linear response is the share of the mean mesh force by which flanks would have to pull:
above 0 they lift off, and the response does not hold. A mode is within reach of the complaint if it amplifies
the frequency of the complaint at least by `REACH`.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from bounds.brief import brief
from bounds.types import Json
from dynamics.assembly.assemble import System, assemble
from dynamics.errors import InputError, SolveError
from dynamics.influence.neglected_check import response_cost
from dynamics.linearize import ForcedResponse, ModalAnalysis, forced_response, modal_analysis
from dynamics.linearize.transfer import parting_share
from dynamics.mechanism.passing import Passing
from dynamics.scene import Scene
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.complaint import (
    Complaint,
    complaint_of,
    complaint_of_case,
    leading_shaft,
    sentence,
)
from lineofaction.gearbox.convert.operating_point import OPERATING_POINT, scene_point
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.complaint import ComplaintInput, with_options
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.complaint import ComplaintFigures, Inputs
from lineofaction.gearbox.studies.computation import Computation, Means, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.excitations import complaint_at_loads, with_scene_metadata
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.modes.run import modes_cost
from lineofaction.gearbox.studies.scene_before_tables import scene_before_tables, sized
from model_studies import in_unit
from model_studies.record import under_key
from model_studies.result_record import ResultRecord

REACH = 2.0
"""Least amplification by a mode within reach, 6 dB: response of the mode over its static response."""
RESOLVED = 1.5
"""Frequency up to which flexible shafts are resolved, over that of the complaint. A mode above it amplifies
less than `REACH`."""
MAX_ORDERS = 100
"""Highest order up to which the linear response is computed; above it bearing forces are not known."""
_CASE_SECONDS = 1e-3
"""CPU seconds of the answer about a case."""
_ASSEMBLIES = 3
"""Number of times that a study assembles a scene."""
ROUNDING = 1e-6
"""Rounding error of an order that is a whole number."""
NEAREST = 5
"""Number of excitations nearest to the complaint that are listed."""
PAIR_ALONE: Json = {"equilibrium": None, "effect_ledger": None, "parting": 0.0}
"""Metadata of the answer about a case, which has no equilibrium, no effects and no parting."""


@dataclass(frozen=True)
class NearMode:
    """A mode within reach; `distance` is relative, positive above the complaint."""

    frequency: float = field(metadata=in_unit("hz"))
    damping_ratio: float
    distance: float
    amplification: float
    kind: str


@dataclass(frozen=True)
class OrderForce:
    """The amplitude of an order of the linear response on a bearing; NaN where it is not known."""

    bearing: str
    force: float = field(metadata=in_unit("n"))


@brief
@dataclass(frozen=True)
class AnsweredComplaint(ResultRecord):
    """The answer to a complaint: forces and modes near its order."""

    complaint: Complaint
    forces: tuple[OrderForce, ...]
    """Forces of the orders within the tolerance, in the sequence of the complaint."""
    modes: tuple[NearMode, ...]
    """Modes near the frequency, the most amplified first; empty without a speed, and for a case."""
    metadata: Json = field(metadata=under_key("facts"))


class _ComplaintStudy(
    Computation[
        CheckedCase | SceneInput, CheckedCase | TabledScene, Inputs, ComplaintFigures, AnsweredComplaint
    ]
):
    inputs, answer, file = Inputs, ComplaintFigures, record_file(("complaint", AnsweredComplaint))

    def narrowed(self, subject: CheckedCase | SceneInput, inputs: Inputs) -> CheckedCase | SceneInput:
        """Return the case or the scene with its complaint, of which options replace fields."""
        written = subject.case if isinstance(subject, CheckedCase) else subject
        fields = with_options(written.complaint, inputs)
        if not fields:
            bound, remedy = "given by the file or by options", "For example frequency_hz and speed_rpm."
            raise BadInput.of("complaint", None, bound, remedy)
        try:
            complaint = validated(ComplaintInput, fields)
        except BadInput as error:
            raise error.within("complaint") from None
        changed = {**dict(written), "complaint": complaint}
        if isinstance(subject, CheckedCase):
            return CheckedCase(validated(Case, changed))
        return validated(SceneInput, changed)

    def normalized(self, _subject: CheckedCase | SceneInput, _inputs: Inputs) -> Json:
        """Return no inputs: the complaint is part of the case or the scene (`narrowed`)."""
        return {}

    def check(self, subject: CheckedCase | SceneInput, _inputs: Inputs) -> None:
        """Refuse a case without any excitation at the complaint; a scene is checked when it is read."""
        if isinstance(subject, CheckedCase):
            complaint_of_case(subject.case)

    def predicted(
        self, subject: CheckedCase | SceneInput, _inputs: Inputs, _cache: Path | None
    ) -> StudyCost | None:
        """Return the cost of the modes and of the response at one speed; a case has neither."""
        if isinstance(subject, CheckedCase):
            return StudyCost((Work("orders", _CASE_SECONDS),))
        with boundary_errors():
            before = scene_before_tables(subject)
        if before is None:
            return None
        complaint = complaint_of(subject, before)
        speed, highest = _leading_speed(complaint, before), _highest_order(complaint)
        with boundary_errors():
            system = sized(subject, _reach(complaint))
            began = cpu_seconds()
            assemble(before)
            assembly = Work("assembly", cpu_seconds() - began, _ASSEMBLIES)
            cost = StudyCost((assembly,)) + modes_cost(system, len(speed))
        if speed and highest <= MAX_ORDERS:
            with suppress(InputError, SolveError):  # nothing excites: the orders are named all the same
                lines = response_cost(system, np.array(speed), highest).speed
                cost += StudyCost((Work("lines", lines),))
        return cost

    def known_before(self, subject: CheckedCase | SceneInput, _inputs: Inputs) -> str:
        """Return the mesh and the harmonic of the complaint of a scene, which turns on teeth alone."""
        if isinstance(subject, CheckedCase):
            return ""
        with boundary_errors():
            before = scene_before_tables(subject)
        return "" if before is None else f"{sentence(complaint_of(subject, before))}."

    def compute(self, made: CheckedCase | TabledScene, _inputs: Inputs, means: Means) -> AnsweredComplaint:
        if isinstance(made, CheckedCase):
            return _of_pair(made.case, means)
        subject = made.steady
        with boundary_errors():
            system = assemble(subject.scene)
        complaint = complaint_at_loads(system, subject)
        with boundary_errors():
            speed = _leading_speed(complaint, subject.scene)
            modes = modal_analysis(system, speed, highest_frequency=_reach(complaint))
        means.report("modes", 1.0)
        response = _response(system, complaint, speed)
        forces = tuple(_force(response, order, complaint.bearing) for order in _orders(complaint))
        metadata = modes.metadata | {"parting": _parting(response)}
        answer = AnsweredComplaint(complaint, forces, _near_modes(modes, complaint), metadata)
        answer = with_scene_metadata(answer, subject)
        if complaint.speed is None:
            return answer
        point = scene_point(subject.inputs, (complaint.shaft, complaint.speed))
        return replace(answer, metadata={**answer.metadata, OPERATING_POINT: point})

    def figures(self, result: AnsweredComplaint) -> Json:
        complaint = result.complaint
        unknown_force = OrderForce("", np.nan)
        within = zip(complaint.within, result.forces, strict=True)
        return figures_of(
            ComplaintFigures,
            complaint,
            result.metadata,
            words=sentence(complaint),
            tolerance_percent=100.0 * complaint.tolerance,
            torque=complaint.torques,
            parting_percent=100.0 * result.metadata.get("parting", 0.0),
            passing=[(force, _figures_of(line, complaint)) for line, force in within],
            nearest=[(unknown_force, _figures_of(line, complaint)) for line in complaint.passing[:NEAREST]],
            modes=[(mode, {"distance_percent": 100.0 * mode.distance}) for mode in result.modes],
        )


def _of_pair(case: Case, means: Means) -> AnsweredComplaint:
    """Return the answer about a case: orders near the complaint, without forces and modes."""
    began, complaint = cpu_seconds(), complaint_of_case(case)
    means.report("modes", 1.0)
    forces = tuple(OrderForce("", np.nan) for _ in complaint.within)
    metadata = PAIR_ALONE | {"seconds": {"complaint": cpu_seconds() - began}}
    return AnsweredComplaint(complaint, forces, (), metadata)


def _figures_of(line: Passing, complaint: Complaint) -> Json:
    excitation = line.excitation
    named = {"kind": excitation.kind, "name": excitation.name, "part": excitation.part}
    return named | {
        "harmonic": line.harmonic,
        "order": line.order,
        "frequency": complaint.hertz(line.order),
        "distance_percent": 100.0 * line.distance,
        "excitation": complaint.level(line),
    }


def _reach(complaint: Complaint) -> float | None:
    """Return the frequency up to which flexible shafts are resolved, Hz; None: by their default."""
    return None if complaint.frequency is None else RESOLVED * complaint.frequency


def _leading_speed(complaint: Complaint, scene: Scene) -> list[float]:
    """Return the speed of the leading shaft at the complaint, rad/s; empty without a speed, or at rest."""
    if complaint.speed is None or not any(part.speed.extreme for part in scene.references):
        return []
    return [complaint.turns[leading_shaft(scene)] * complaint.speed]


def _near_modes(modes: ModalAnalysis, complaint: Complaint) -> tuple[NearMode, ...]:
    """Return the modes within reach, at the speed or at rest, that of the largest amplification first."""
    if complaint.frequency is None:
        return ()
    names = ("frequency", "damping_ratio", "strain_energy", "kinetic_energy")
    turning = modes.speed.size > 0
    columns = (getattr(modes, name)[0] if turning else getattr(modes, f"natural_{name}") for name in names)
    near = []
    for hertz, damping, strain, kinetic in zip(*columns, strict=True):
        if hertz > 0.0:
            ratio = complaint.frequency / float(hertz)
            size = 1.0 / np.hypot(1.0 - ratio**2, 2.0 * float(damping) * ratio)
            if size >= REACH:
                kind = modes.kind(strain, kinetic)
                near.append(NearMode(float(hertz), float(damping), 1.0 / ratio - 1.0, float(size), kind))
    return tuple(sorted(near, key=lambda mode: -mode.amplification))


def _orders(complaint: Complaint) -> list[float]:
    """Return the orders of the excitations within the tolerance, in orders of the linear response."""
    return [line.order * complaint.per_pitch for line in complaint.within]


def _highest_order(complaint: Complaint) -> int:
    return max(int(np.ceil(max(_orders(complaint)) - ROUNDING)), 1)


def _response(system: System, complaint: Complaint, speed: Sequence[float]) -> ForcedResponse | None:
    """Return the linear response up to the orders that pass; None: without a speed, or nothing excites."""
    highest = _highest_order(complaint)
    if not speed or highest > MAX_ORDERS:
        return None
    try:
        return forced_response(system, speed, highest)
    except InputError:  # nothing excites, or no common period: the orders are named all the same
        return None


def _parting(response: ForcedResponse | None) -> float:
    """Return the share of the mean mesh force by which flanks would pull in a linear response; 0: none."""
    if response is None:
        return 0.0
    return parting_share(response.least_mesh_force[:, 0], response.mean_force)


def _force(response: ForcedResponse | None, order: float, bearing: str | None) -> OrderForce:
    """Return the amplitude of an order on a bearing, by default on the bearing with the largest."""
    unknown = OrderForce(bearing or "", np.nan)
    if response is None or not response.bearing:
        return unknown
    (columns,) = np.nonzero(np.isclose(response.order, order, rtol=ROUNDING))
    if not columns.size:
        return unknown
    force = response.bearing_force[:, :3, 0, columns[0]]  # three forces of each bearing at the only speed
    size = np.sqrt(np.sum(np.abs(force) ** 2, axis=1))
    b = int(np.argmax(size)) if bearing is None else response.bearing.index(bearing)
    return OrderForce(response.bearing[b], float(size[b]))


RUN = _ComplaintStudy()
