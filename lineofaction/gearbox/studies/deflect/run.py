"""Deflection of a scene: bodies and meshes in agreement, and the results on the flanks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType

import numpy as np

from bounds import engineering, leftover
from bounds.types import Json
from dynamics.deflection import CaseDeflection, MeshAlignment, deflect
from dynamics.deflection.agreement import Agreement, in_agreement
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.analysis.flanks.pressure_map import pressure_map
from fe_contact.analysis.run_plan import predicted_designs
from fe_contact.options import Run
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import PLANE
from lineofaction.gearbox.convert.checked_case import across_face
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.bodies import UNIT
from lineofaction.gearbox.studies.computation import Means, SceneStudy, record_file
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.deflect import DeflectFigures, Inputs
from lineofaction.gearbox.studies.deflect.cases import check_cases, load_cases
from lineofaction.gearbox.studies.deflect.figures import figures_by_case, write_spectrum
from lineofaction.gearbox.studies.deflect.mesh_contact import DividedTables, MeshContact
from lineofaction.gearbox.studies.deflect.result import HARMONICS, GearboxDeflection, MeshFlanks, Outline
from lineofaction.gearbox.studies.motion import OfferedMotion, UnitMotion
from lineofaction.gearbox.studies.scene_before_tables import CASES
from lineofaction.gearbox.studies.unit_bodies import bodies_of
from model_studies.host_speed import host_slowness
from model_studies.progress import Progress, Report, by_cost
from model_studies.workers import divided, spent

ALONG_FACE, ALONG_PROFILE = 41, 40
GEARS, TABLES, CONTACTS = "gears", "tables by misalignment", "contacts"
"""Parts of the stage on the flanks, in the order in which they are done."""
FIRST_KNOTS, USUAL_PASSES = 2, 3
"""Tables beyond the first misalignments; passes, each with a table for every load case."""
CASE_SECONDS = 0.1
"""CPU seconds of one deflection of a scene under one load case, on the reference host; of two stages of gears
0.10 was measured, of one pair 0.07.
"""


class _DeflectStudy(SceneStudy[Inputs, DeflectFigures, GearboxDeflection]):
    inputs, answer, file = Inputs, DeflectFigures, record_file(("deflection", GearboxDeflection))
    writers = MappingProxyType({".toml": write_spectrum})

    def check(self, scene: SceneInput, inputs: Inputs) -> None:
        """Refuse load cases that are impossible or need missing parts, before tables are computed."""
        check_cases(scene, inputs.load_cases)

    def predicted(self, scene: SceneInput, inputs: Inputs, cache: Path | None) -> StudyCost:
        """Return the cost of deflections, tables of usual passes and flanks of every load case, by mesh.

        A table and a load distribution come with the solutions that measure their errors. Meshes whose load
        may vary over the face have passes, with a deflection each.
        """
        count = len(inputs.load_cases)
        seconds = CASE_SECONDS * host_slowness(cache)
        over_face = False
        cost = StudyCost((Work("deflections", seconds, count, "deflection"),))
        cases = [case for mesh in scene.meshes if isinstance(case := mesh.case, Case)]
        for case in {case.model_dump_json(): case for case in cases}.values():
            with boundary_errors():
                design = predicted = predicted_designs(CASES.of(case).checked, cache)
                if not design.across_face and case.accuracy.model not in PLANE:
                    predicted = predicted_designs(across_face(CASES.of(case)).checked, cache)
                    # otherwise the gears are those of its table
                    gears = Work(GEARS, predicted.all_bodies, stage="flanks")
                    cost += StudyCost((gears,), predicted.bytes)
            contact, knots = predicted.design + predicted.errors, _usual_tables(count)
            if predicted.across_face:
                over_face = True
                cost += StudyCost((Work(TABLES, contact, knots, "flanks"),))
            cost += StudyCost((Work(CONTACTS, contact, count, "flanks"),), predicted.bytes)
        if over_face:
            cost += StudyCost((Work("deflections", seconds, count * USUAL_PASSES, "flanks"),))
        return cost

    def compute(self, tabled: TabledScene, inputs: Inputs, means: Means) -> GearboxDeflection:
        began, scene = spent(means.workers) - tabled.seconds, tabled.scene
        with boundary_errors():
            cases = load_cases(inputs.load_cases)
            positions, workers = inputs.positions, means.workers
            first = deflect(scene, cases, positions, lambda done: means.report("deflection", done), workers)
            progress = self._progress_on_flanks(tabled, inputs, means)
            contacts = _contacts(tabled, first.cases, means.analysis, partial(progress, GEARS))
            across = {name: contact for name, contact in contacts.items() if contact.across_face}
            usual = _usual_tables(len(cases)) * len({id(contact) for contact in across.values()})
            tables = DividedTables(across, workers, _usual_seconds(tabled), partial(progress, TABLES), usual)
            agreed = in_agreement(scene, cases, positions, across, first, tables.complete, workers)
            flanks = tuple(_flanks(agreed, contacts, means, tables.seconds, partial(progress, CONTACTS)))
        written = {name: mesh.case.model_dump(mode="json") for name, mesh in _with_case(tabled) if mesh.case}
        return GearboxDeflection(
            deflection=agreed.deflection,
            flanks=flanks,
            passes=agreed.passes,
            change=agreed.change,
            agreed=agreed.reached,
            outline=Outline.of(scene),
            cases=written,
            seconds=spent(means.workers) - began,
            scene=scene_of(tabled.inputs),
            metadata={UNIT: bodies_of(tabled)},
        )

    def _progress_on_flanks(self, scene: TabledScene, inputs: Inputs, means: Means) -> Progress:
        """Return the progress of the parts of the stage on the flanks, by their planned cost."""
        plan = self.predicted(scene.inputs, inputs, means.analysis.cache)
        planned = [part for part in plan.parts if part.stage == "flanks"]
        # deflections of the passes stand between their tables
        part_of = {"deflections": TABLES}
        costs = dict.fromkeys((GEARS, TABLES, CONTACTS), 0.0)
        for work in planned:
            costs[part_of.get(work.name, work.name)] += work.seconds
        return by_cost(partial(means.report, "flanks"), costs)

    def _derived(self, result: GearboxDeflection) -> Json:
        return figures_by_case(result)

    def motions(self, result: GearboxDeflection) -> list[OfferedMotion]:
        """Return the deflection under every load case."""
        return [_offered_motion(result.outline.shafts, case) for case in result.deflection.cases]

    def failure(self, result: GearboxDeflection) -> str:
        """Say which load cases have no equilibrium, or how far meshes and bodies disagree."""
        unsolved = [case for case in result.deflection.cases if case.status != "converged"]
        if unsolved:
            names = ", ".join(f'"{case.name}" ({case.status.replace("_", " ")})' for case in unsolved)
            remedy = "Check that bearings hold every shaft that is loaded."
            return f"No equilibrium under load case {names}. {remedy}"
        if not result.agreed:
            change = leftover(result.change)
            return (
                f"Mesh loads and deflections disagree: misalignments still change by {change} of their size "
                f"after {result.passes} passes."
            )
        return ""


def _offered_motion(shafts: tuple[str, ...], case: CaseDeflection) -> OfferedMotion:
    lines = case.shafts
    state = "" if case.status == "converged" else f", {case.status.replace('_', ' ')}"
    name = f"{case.name}, {engineering(case.torque, 4)} N m{state}"

    def made() -> UnitMotion:
        return UnitMotion(shafts, lines.shaft, lines.position, lines.motion.astype(complex), oscillates=False)

    return OfferedMotion("under load", name, made)


def scene_of(inputs: SceneInput) -> Json:
    """Return a scene as it is kept with its deflection: without the cases of its meshes."""
    table: Json = inputs.model_dump(mode="json", exclude={"meshes": {"__all__": {"case", "case_file"}}})
    return table


def _with_case(scene: TabledScene) -> Iterator[tuple[str, MeshInput]]:
    """Yield the name and the input of every mesh whose case is known, copies of planets too."""
    by_name = {mesh.name: mesh for mesh in scene.inputs.meshes}
    tables = {id(mesh.table): by_name[mesh.name] for mesh in scene.scene.meshes if mesh.name in by_name}
    for mesh in scene.scene.meshes:
        known = by_name.get(mesh.name) or tables.get(id(mesh.table))
        if known is not None and known.case is not None:
            yield mesh.name, known


def _usual_tables(cases: int) -> int:
    """Return the usual number of tables of a mesh under so many load cases, one at each misalignment."""
    return FIRST_KNOTS + cases * USUAL_PASSES


def _contacts(
    scene: TabledScene, cases: tuple[CaseDeflection, ...], run: Run, report: Report
) -> dict[str, MeshContact]:
    """Return the contacts of all meshes with a case, by name, at the torques on their pinions."""
    torques: dict[str, list[float]] = {}
    inputs = dict(_with_case(scene))
    for case in cases:
        for mesh in case.meshes:
            if mesh.name in inputs:
                name = inputs[mesh.name].name
                radius = scene.databases[name].geometry.base_radius[0]
                torques.setdefault(name, []).append(mesh.force * radius)
    made: dict[str, MeshContact] = {}
    different = {known.name: known for known in inputs.values()}
    progress = by_cost(report, dict.fromkeys(different, 1.0))
    for name, mesh_input in different.items():
        assert isinstance(mesh_input.case, Case)
        of_mesh = run.reporting(partial(progress, name))
        made[name] = MeshContact.of(mesh_input.case, scene.databases[name], torques[name], of_mesh)
        progress(name, 1.0)
    return {name: made[known.name] for name, known in inputs.items()}


def _usual_seconds(scene: TabledScene) -> float:
    """Return the CPU seconds of a table at one misalignment, about those of the contact of one mesh."""
    stages = [table.metadata.receipt.get("stages", {}) for table in scene.databases.values()]
    return max((stage["contact"]["cpu_seconds"] for stage in stages if "contact" in stage), default=0.0)


def _flanks(
    agreement: Agreement,
    contacts: Mapping[str, MeshContact],
    means: Means,
    seconds: float,
    report: Report,
) -> Iterator[MeshFlanks]:
    """Yield the results on the flanks; each is predicted to take so many CPU seconds."""
    items = [
        (case.name, mesh)
        for case in agreement.deflection.cases
        for mesh in case.meshes
        if mesh.name in contacts
    ]
    flanks = divided(means.workers, _on_flanks, contacts, items, seconds * len(items))
    for done, mesh_flanks in enumerate(flanks, 1):
        yield mesh_flanks
        report(done / len(items))


def _on_flanks(contacts: Mapping[str, MeshContact], of: tuple[str, MeshAlignment]) -> MeshFlanks:
    """Return the results on the flanks of a mesh under a load case: one task."""
    case, mesh = of
    contact = contacts[mesh.name]
    across = contact.across_face
    torque = mesh.force * contact.pair.pinion.base_radius
    misalignment = mesh.misalignment if across else 0.0
    table, flanks = contact.solved(torque, misalignment, mesh.center_distance_change)
    at = {
        "torque": torque,
        "misalignment": misalignment,
        "center_distance_change": mesh.center_distance_change,
    }
    mean, ripple = table.mean(**at), table.peak_to_peak(**at)
    harmonics = table.harmonics(**at)[:HARMONICS]
    face, load = _along_face(flanks)
    roll, pattern = _pattern(flanks, *pressure_map(flanks, flanks.roll_length_1))
    arm = float(np.mean(table.load_arm))
    return MeshFlanks(
        mesh=mesh.name,
        case=case,
        torque=torque,
        mean=mean.value,
        mean_error=mean.error,
        peak_to_peak=ripple.value,
        peak_to_peak_error=ripple.error,
        harmonics=np.array([harmonic.value for harmonic in harmonics]),
        harmonics_error=np.array([harmonic.error for harmonic in harmonics]),
        face_load_factor=flanks.mean_face_load_factor if across else float("nan"),
        load_arm_difference=arm - mesh.load_arm if across else float("nan"),
        largest_pressure=float(flanks.clear_pressure.max()),
        face_position=face,
        face_load=load,
        roll_length=roll,
        pattern=pattern,
    )


def _along_face(flanks: LoadDistribution) -> tuple[FloatArray, FloatArray]:
    """Return evenly spaced positions along the face, m, and the mean load there, N/m."""
    half = 0.5 * flanks.slice_width
    ends = flanks.face_position[0] - half, flanks.face_position[-1] + half
    face = np.linspace(*ends, ALONG_FACE)
    return face, np.interp(face, flanks.face_position, flanks.face_load.mean(axis=0))


def _pattern(
    flanks: LoadDistribution, roll: FloatArray, pressure: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the contact pattern in cells about evenly spaced roll lengths and face positions.

    A cell has the largest pressure of what lies in it, of its nearest point where nothing does.
    """
    rows, face = np.linspace(roll[0], roll[-1], ALONG_PROFILE), _along_face(flanks)[0]
    along, across = np.abs(roll[:, None] - rows), np.abs(flanks.face_position[:, None] - face)
    pattern = pressure[np.ix_(along.argmin(axis=0), across.argmin(axis=0))]
    np.maximum.at(pattern, np.ix_(along.argmin(axis=1), across.argmin(axis=1)), pressure)
    return rows, pattern


RUN = _DeflectStudy()
