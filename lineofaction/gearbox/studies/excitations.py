"""Facts of a result about its scene: excitations with their errors, complaint, reductions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from typing import Any, TypeVar

import numpy as np

from bounds import order_name
from bounds.types import FloatArray, Json
from dynamics.assembly.assemble import System, assemble
from dynamics.errors import InputError
from dynamics.linearize import HarmonicResponse
from dynamics.linearize.operating_speeds import mesh_frequencies
from dynamics.mechanism.kinematics import Kinematics, solve_kinematics
from dynamics.mechanism.passing import MESH, excitations, turning_orders
from fe_contact.analysis.estimates.excitation_errors import excitation_errors
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.complaint import Complaint, complaint_of, leading_shaft
from lineofaction.gearbox.convert.operating_point import OPERATING_POINT, scene_point
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.studies.bodies import UNIT
from lineofaction.gearbox.studies.excitation import Excitation
from lineofaction.gearbox.studies.unit_bodies import bodies_of

Result = TypeVar("Result")
OFF_MESH = 6
"""Number of orders between the mesh orders that are listed for a mesh."""
LEADING = "leading"
"""Name among the facts of a result of the shaft whose orders are named."""


def excitations_of(response: HarmonicResponse, system: System, subject: TabledScene) -> list[Excitation]:
    """Return the excitations by harmonics of every mesh with a table, and by orders between harmonics.

    Of the latter those largest in transmission error, where it is above its error. Copies of a planet excite
    as the one that the scene names.
    """
    rate = mesh_frequencies(system, np.ones(1))[:, 0]
    step = rate / next((frequency for frequency in rate if frequency), 1.0)
    rows: list[Excitation] = []
    for mesh, table in subject.databases.items():
        index = response.mesh.index(mesh)
        if step[index]:
            largest_friction = (system.scene.meshes[index].friction or 0.0) * abs(response.mean_force[index])
            rows += _of_mesh(response, index, table, float(step[index]), largest_friction)
    return rows


def complaint_at_loads(system: System, subject: TabledScene) -> Complaint:
    """Return the complaint of a scene that has one, with torques and excitations at its loads.

    Excitations are the transmission error times the mean stiffness at the nominal mesh force, or the highest
    that is stored, and the stored alignment nearest to none: of meshes with a table and a load.
    """
    names, flanks = [mesh.name for mesh in system.scene.meshes], system.flanks
    torques, levels = {}, {}
    for mesh, table in subject.databases.items():
        index = names.index(mesh)
        torque = abs(float(flanks.nominal_force[index])) * table.geometry.base_radius[0]
        if torque > 0.0:
            skew, change = table.misalignment, table.center_distance_change
            curve = table.curve(
                force=min(table.geometry.normal_force(torque), float(table.force[-1])),
                misalignment=float(np.clip(0.0, skew[0], skew[-1])),
                center_distance_change=float(np.clip(0.0, change[0], change[-1])),
                allow_failed=True,
            )
            stiffness = float(flanks.mean_stiffness[index])
            torques[mesh] = torque
            levels[mesh] = tuple(stiffness * harmonic.value for harmonic in curve.harmonics)
    return complaint_of(subject.inputs, subject.scene, levels, torques)


def _of_mesh(
    response: HarmonicResponse, mesh: int, table: SteDatabase, step: float, largest_friction: float
) -> Iterator[Excitation]:
    """Yield the harmonics of a mesh, which are `step` apart in the orders of the response."""
    force = abs(float(response.mean_force[mesh]))
    torque = force * table.geometry.base_radius[0]
    errors = excitation_errors(table, table.geometry.normal_force(torque))
    slides = largest_friction * bool(np.any(response.friction_force[mesh]))

    def error(by_harmonic: FloatArray, harmonic: int | None, off_mesh: float = np.nan) -> float | None:
        value = off_mesh if harmonic is None else float(by_harmonic[harmonic - 1])
        return value if np.isfinite(value) else None

    def row(at: int, harmonic: int | None) -> Excitation:
        return Excitation(
            mesh=response.mesh[mesh],
            torque=torque,
            harmonic=harmonic,
            order=float(response.order[at]),
            transmission_error=float(abs(response.static_transmission_error[mesh, at])),
            error_of_transmission_error=error(errors.transmission_error, harmonic, errors.off_mesh),
            load_moment=float(abs(response.load_moment[mesh, at])),
            error_of_load_moment=error(force * errors.load_arm, harmonic),
            friction_force=float(abs(response.friction_force[mesh, at])),
            error_of_friction_force=error(slides * errors.friction, harmonic),
        )

    multiple = response.order / step
    is_harmonic = np.isclose(multiple, np.rint(multiple), rtol=1e-6)
    for harmonic in range(1, errors.load_arm.size + 1):
        for at in np.flatnonzero(is_harmonic & (np.rint(multiple) == harmonic))[:1].tolist():
            yield row(at, harmonic)
    size = np.where(is_harmonic, 0.0, np.abs(response.static_transmission_error[mesh]))
    for at in np.argsort(-size, kind="stable")[:OFF_MESH].tolist():
        if size[at] > np.nan_to_num(errors.off_mesh):
            yield row(at, None)


def with_scene_metadata(result: Result, subject: TabledScene) -> Result:
    """Return a result with the `scene_metadata` among its metadata."""
    changed: Any = result
    known: Result = replace(changed, metadata={**changed.metadata, **scene_metadata(subject)})
    return known


def scene_metadata(subject: TabledScene) -> Json:
    """Return the facts of a result about its scene.

    Its `reduction_cost`, the fields of the `WorkCost` of the reductions by housing: a file of modes may be
    without them. What is `turning`, by which orders are named. The bodies that its `unit` is drawn as. Of a
    scene with one its `complaint`, as plots mark it.
    """
    costs = {name: asdict(body.cost) for name, body in subject.housings.items() if body.cost is not None}
    kinematics = solve_kinematics(subject.scene)
    known = {
        "reduction_cost": costs,
        "turning": turning_orders(subject.scene, kinematics),
        LEADING: _leading(subject, kinematics),
        OPERATING_POINT: scene_point(subject.inputs),
        UNIT: bodies_of(subject),
    }
    if subject.inputs.complaint is None:
        return known
    return known | {"complaint": complaint_at_loads(assemble(subject.scene), subject).marks}


def _leading(subject: TabledScene, kinematics: Kinematics) -> Json:
    """Return the shaft whose orders are named, and the first mesh's order of it, 0: none of both turns."""
    complaint = subject.inputs.complaint
    shaft = (complaint and complaint.shaft) or leading_shaft(subject.scene)
    try:
        parts = excitations(subject.scene, kinematics, shaft, 1)
    except InputError:  # the shaft is at rest
        parts = ()
    return {"shaft": shaft, "mesh_order": next((part.rate for part in parts if part.kind == MESH), 0.0)}


def order_names(order: FloatArray, metadata: Json) -> list[str]:
    """Return the name of each order of a result (`bounds.order_name`); empty for files without `turning`."""
    turning = metadata.get("turning")
    return [] if turning is None else [order_name(value, **turning) for value in order.tolist()]
