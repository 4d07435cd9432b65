"""The objective of a search that a complaint states: its harmonic at its load and speed."""

from __future__ import annotations

import math
from typing import Any

from dynamics.mechanism.passing import MESH, Passing
from lineofaction.gearbox.convert.complaint import Complaint, complaint_of, complaint_of_case, leading_shaft
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.case import Case
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.optimize import HeardObjectiveInput, Inputs
from lineofaction.gearbox.studies.scene_before_tables import scene_before_tables
from lineofaction.gearbox.units import RPM

_REMEDY = "Name the orders that count: the likeliest cause is no mesh whose flanks could change."


def of_case(case: Case, study: Inputs) -> Inputs:
    """Return a study that minimizes the harmonic of a case's complaint, at its torque.

    What the study names itself stays: an objective, or torques.
    """
    if case.complaint is None or "objective" in study.model_fields_set:
        return study
    complaint = complaint_of_case(case)
    objective = Inputs.ObjectiveInput(harmonic=_mesh_line(complaint).harmonic)
    changed: dict[str, Any] = {"objective": objective}
    if study.torque_n_m is None and (torques := tuple(complaint.torques.values())):
        changed["torque_n_m"] = torques
    return study.model_copy(update=changed)


def of_scene(scene: SceneInput, study: Inputs) -> Inputs:
    """Return a study that minimizes the level of the complaint of a scene: its mesh, order and speed.

    The cases of the scene are written out, or it has tables; what is heard is the bearing of the complaint,
    the microphone, or what the scene offers. A study that says what is heard stays as it is.
    """
    fields = scene.complaint
    if study.heard is not None or fields is None:
        return study
    before = scene_before_tables(scene) if has_cases(scene) else None
    if before is None:
        bound = "given, where meshes have tables in place of cases"
        raise BadInput.of("heard", None, bound, "Flanks of a case can change.")
    complaint = complaint_of(scene, before)
    line = _mesh_line(complaint)
    if complaint.speed is None:
        raise BadInput.of("complaint.speed_rpm", None, "given: a level depends on the speed", "Give a speed.")
    speed = complaint.turns[leading_shaft(before)] * complaint.speed / RPM
    microphone = fields.microphone_mm
    at_bearing = fields.bearing is not None and microphone is None
    heard = HeardObjectiveInput(
        speed_rpm=(speed,),
        orders=line.harmonic,
        counted_orders=(line.harmonic,),
        mesh=line.excitation.name,
        quantity="bearing_force" if at_bearing else None,
        bearing=fields.bearing if microphone is None else None,
        microphone_mm=microphone,
    )
    return study.model_copy(update={"heard": heard})


def has_cases(scene: SceneInput) -> bool:
    """Whether all tables of a scene follow from cases that are written out in it."""
    return all(isinstance(mesh.case, Case) for _, mesh in scene.with_database)


def _mesh_line(complaint: Complaint) -> Passing:
    """Return the likeliest harmonic of a mesh; raises `BadInput`: none is within the tolerance."""
    for line in complaint.within:
        if line.excitation.kind == MESH and math.isfinite(line.order):
            return line
    raise BadInput.of("complaint", complaint.order, "near a harmonic of a mesh", _REMEDY)
