"""Flexible shafts: they bend, shear, twist and stretch between gears and bearings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from bounds import engineering
from dynamics.bearings.seat import SEAT
from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.loads.load_course import mean_factor
from dynamics.mechanism.columns import column_count, elastic_columns, elastic_terms, section_rows, turn_row
from dynamics.mechanism.connections import gather_connections, general_bearings
from dynamics.mechanism.flank_gradients import approach, misalignment_gradient
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.rotor import Rotor
from dynamics.mechanism.sampling import shaft_resolution
from dynamics.scene.scene import Scene
from dynamics.shafts import Disc, ElasticShaft, PointOfApplication, elastic_shaft
from dynamics.shafts.shaft import OnShaft, on_length
from dynamics.types import FloatArray

SHARE = 0.05
"""Least displacement at a mesh, over the deflection of the mesh, at which a scene calls for the effect."""
ROUNDING = 1e-9  # misalignment over displacement, below which it is rounding
SINGULAR = 1e-13
"""Singular value of a stiffness over the largest one, below which nothing holds its motion."""
NOTHING_BENDS = (
    "forces act at one position of the shaft alone, or it is not held there: nothing bends or twists it"
)
"""Reason why a shaft without elastic coordinates is rigid."""


def _why_rigid(mechanism: Mechanism, index: int) -> str:
    """Return the reason why the shaft `index` cannot be flexible; empty where it can."""
    scene, rotor = mechanism.scene, mechanism.rotors[index]
    shaft = rotor.shaft
    if not shaft.sections:
        return "the shaft has no sections: its elasticity is not known"
    if rotor.frame is not None:
        return "left out: members of a planetary set are rigid"
    bent = [mesh for mesh in _meshes(mechanism, index) if scene.meshes[mesh].bent_shafts]
    if bent:
        return f'the table of "{scene.meshes[bent[0]].name}" has the bending of its shafts in it'
    # couplings are no parts of this check: a torsional one acts at the nearer end of the shaft
    parts: list[OnShaft] = [*scene.gears, *scene.discs, *scene.ground_bearings, *scene.drives, *scene.loads]
    parts += [*scene.speed_torques, *scene.forces, *scene.unbalances]
    for part in parts:
        if part.shaft == shaft.name and not on_length(part.position, shaft.length):
            return f'"{part.name}" at {part.position:g} m is off the shaft, which is {shaft.length:g} m long'
    return ""


def _elastic_of(mechanism: Mechanism, index: int) -> ElasticShaft:
    """Return the elastic coordinates of the shaft `index`, reduced to the points where forces act on it.

    A shaft bends if bearings hold it across the axis and in tilt, and the scene has these freedoms. It
    stretches if it may move along its axis. Its elements resolve motion up to the scene's highest frequency,
    by default up to `shaft_resolution`.
    """
    scene, rotor = mechanism.scene, mechanism.rotors[index]
    shaft = rotor.shaft
    supported = rotor.radial_stiffness > 0.0 and rotor.tilt_stiffness > 0.0
    bends = supported and {"x", "tilt_x"} <= mechanism.additions.possible
    drive = next((d for d in scene.drives if d.shaft == shaft.name and d.rigid), None)
    discs = tuple(Disc(rotor.on_shaft(body.position), body.inertia) for body in scene.mounted(shaft.name))
    return elastic_shaft(
        shaft.sections,
        discs,
        points=_points_of_application(mechanism, rotor, bends, _stretches(mechanism, rotor)),
        highest=scene.highest_frequency or shaft_resolution(scene, mechanism.kinematics),
        damping_ratio=shaft.damping_ratio,
        imposed=None if drive is None else rotor.on_shaft(drive.position),
    )


def _stretches(mechanism: Mechanism, rotor: Rotor) -> bool:
    """Return whether the shaft moves along its axis: a bearing holds it there, and the scene has the freedom.

    The scene has the freedom on request, or for a helical gear unless it is switched off.
    """
    scene, additions = mechanism.scene, mechanism.additions
    gears = {gear.name: gear for gear in scene.gears if gear.shaft == rotor.shaft.name}
    meshing = [name for mesh in scene.meshes for name in (mesh.driver, mesh.driven) if name in gears]
    helical = any(gears[name].base_helix_angle != 0.0 for name in meshing)
    called_for = helical or "z" in additions.requested
    return rotor.axial_stiffness > 0.0 and "z" in additions.possible and called_for


def _points_of_application(
    mechanism: Mechanism, rotor: Rotor, bends: bool, stretches: bool
) -> tuple[PointOfApplication, ...]:
    """Return the points of a shaft where gears, bearings, couplings, drives and loads act.

    A shaft that does not bend or stretch takes no forces across or along its axis at any of them.
    """
    scene, name = mechanism.scene, rotor.shaft.name
    laws = mechanism.bearings
    tilting = general_bearings(scene, mechanism.rotors) | {law.name for law in laws if law.tilts}
    holding = {law.name for law in laws if law.holds_axis}

    def all_forces(position: float) -> PointOfApplication:
        return PointOfApplication(
            rotor.on_shaft(position), across=bends, tilt=bends, along=stretches, turn=True
        )

    points = [all_forces(gear.position) for gear in scene.gears if gear.shaft == name]
    for bushing in rotor.bushings:
        along = stretches and (bushing.axial_stiffness > 0.0 or bushing.is_general or bushing.name in holding)
        tilt = bends and bushing.name in tilting
        position = rotor.on_shaft(bushing.position)
        points.append(PointOfApplication(position, across=bends, tilt=tilt, along=along))
    for coupling in _couplings(scene, rotor):
        if coupling.joins_all:
            points.append(all_forces(coupling.position))
        else:
            points.append(PointOfApplication(rotor.on_shaft(coupling.position), turn=True))
    torques: list[OnShaft] = [*scene.drives, *scene.loads, *scene.speed_torques]
    points += [
        PointOfApplication(rotor.on_shaft(part.position), turn=True) for part in torques if part.shaft == name
    ]
    applied: list[OnShaft] = [*scene.forces, *scene.unbalances]
    points += [all_forces(part.position) for part in applied if part.shaft == name]
    return tuple(points)


class _CouplingOnShaft(NamedTuple):
    """An end of a coupling on a shaft."""

    position: float
    """Position along the shaft, m from its left end."""
    joins_all: bool
    """Whether the coupling joins all displacements and rotations, by a stiffness matrix; else the rotation
    about the axis alone.
    """


def _couplings(scene: Scene, rotor: Rotor) -> list[_CouplingOnShaft]:
    """Return the ends of couplings on the shaft of a rotor."""
    z = {shaft.name: shaft.origin[2] for shaft in scene.shafts}
    return [
        _CouplingOnShaft(
            position=z[coupling.first] + coupling.position - rotor.shaft.origin[2],
            joins_all=coupling.stiffness is not None,
        )
        for coupling in scene.couplings
        if rotor.shaft.name in (coupling.first, coupling.second)
    ]


@dataclass(frozen=True)
class _Bending(Verdict):
    """A verdict on a shaft with its elastic coordinates."""

    elastic: ElasticShaft | None = None
    """Elastic coordinates by which the influence is assessed; None: the shaft is rigid."""


class FlexibleShafts(RotorEffect):
    """Elastic coordinates of every shaft with sections, and the rigid freedoms that bending needs."""

    name = "flexible_shafts"
    in_statics = True
    cost = "five to thirty freedoms per shaft, all in one block"

    def verdicts(self, rotors: Sequence[LoadedRotor]) -> Sequence[Verdict]:
        """Call for the effect where the nominal force deflects a shaft by a share of its mesh deflection."""
        mechanism, flanks = rotors[0].mechanism, rotors[0].flanks
        refusals, elastic = [], []
        for index in range(len(rotors)):
            refusal = _why_rigid(mechanism, index)
            part = None if refusal else _elastic_of(mechanism, index)
            if part is not None and part.mass.size == 0:
                refusal, part = NOTHING_BENDS, None
            refusals.append(refusal)
            elastic.append(part)
        verdicts = [_Bending(on=False, possible=False, reason=text, influence=0.0) for text in refusals]
        if any(part is not None for part in elastic):
            flexible = _with_elastic(mechanism, elastic)
            stiffness = _support_stiffness(flexible)
            for index, part in enumerate(elastic):
                if part is not None:
                    verdicts[index] = _influence(flexible, flanks, index, stiffness, part)
        return verdicts

    def extend(self, mechanism: Mechanism, decision: Sequence[Verdict | None]) -> Mechanism:
        """Return the mechanism with the elastic coordinates of the shafts that the effect is on for."""
        elastic = [verdict.elastic if isinstance(verdict, _Bending) else None for verdict in decision]
        return mechanism if all(part is None for part in elastic) else _with_elastic(mechanism, elastic)


def _with_elastic(mechanism: Mechanism, elastic: Sequence[ElasticShaft | None]) -> Mechanism:
    pairs = zip(mechanism.rotors, elastic, strict=True)
    rotors = tuple(replace(rotor, elastic=part) for rotor, part in pairs)
    return replace(mechanism, rotors=replace(mechanism.rotors, rotors=rotors))


def _influence(
    mechanism: Mechanism, flanks: Flanks, index: int, stiffness: FloatArray, elastic: ElasticShaft
) -> _Bending:
    """Assess the bending of the shaft `index` by the nominal forces, its neighbors at rest.

    The influence is the displacement of the flexible shaft less that of the rigid one on the same bearings.
    """
    scene, rotors = mechanism.scene, mechanism.rotors
    across = [0, 1, 3, 4] if rotors[index].bending_freedoms else []  # x, y, tilt_x, tilt_y, if it bends
    along = [2] if elastic.extension.mass.size else []  # z
    rigid = [6 * index + kind for kind in (*across, *along)]  # the freedoms that bearings hold
    coordinates = elastic_columns(rotors, index)
    axes = np.array([*rigid, *range(coordinates.start, coordinates.stop)])
    rows = {
        mesh: approach(scene, rotors, mesh, mechanism.lines[mesh])[axes] for mesh in _meshes(mechanism, index)
    }
    force = _loads(mechanism, index)[axes] - sum(
        (mechanism.nominal_force[mesh] * row for mesh, row in rows.items()), start=np.zeros(axes.size)
    )
    displacement = np.linalg.lstsq(stiffness[np.ix_(axes, axes)], force, rcond=SINGULAR)[0]
    rigid_stiffness, rigid_force = stiffness[np.ix_(rigid, rigid)], force[: len(rigid)]
    displacement[: len(rigid)] -= np.linalg.lstsq(rigid_stiffness, rigid_force, rcond=SINGULAR)[0]
    loads: list[OnShaft] = [*scene.forces, *scene.unbalances]
    if not rows and scene.shafts[index].name in [part.shaft for part in loads]:
        reason = "loads act on the shaft, which no mesh measures"
        return _Bending(on=True, possible=True, reason=reason, influence=0.0, elastic=elastic)
    approach_change, share, misalignment = 0.0, 0.0, 0.0
    for mesh, row in rows.items():
        change = abs(float(row @ displacement))
        deflection = float(mechanism.nominal_force[mesh] / flanks.mean_stiffness[mesh])
        sense = mechanism.kinematics.mesh_sense[mesh]
        gradient = misalignment_gradient(scene, rotors, mesh, mechanism.lines[mesh], sense)[axes]
        approach_change = max(approach_change, change)
        misalignment = max(misalignment, abs(float(gradient @ displacement)))
        share = max(share, change / deflection if deflection > 0.0 else 0.0)
    misalignment = misalignment if misalignment > ROUNDING * approach_change else 0.0
    reason = (
        f"the nominal force bends and twists the shaft by {engineering(1e6 * approach_change)} µm along the "
        f"line of action, {engineering(100.0 * share)} % of the mesh deflection, and misaligns the gear by "
        f"{engineering(1e6 * misalignment)} µm over the face"
    )
    return _Bending(
        on=share > SHARE, possible=True, reason=reason, influence=approach_change, elastic=elastic
    )


def _meshes(mechanism: Mechanism, index: int) -> list[int]:
    """Return the indices of the meshes with a gear on the shaft `index`."""
    scene, name = mechanism.scene, mechanism.scene.shafts[index].name
    pairs = [(scene.gear(mesh.driver).shaft, scene.gear(mesh.driven).shaft) for mesh in scene.meshes]
    return [mesh for mesh, pair in enumerate(pairs) if name in pair]


def _loads(mechanism: Mechanism, index: int) -> FloatArray:
    """Return torques and standing forces on the shaft `index` at t = 0 as forces on all freedoms, (N,)."""
    scene, rotors = mechanism.scene, mechanism.rotors
    force = np.zeros(column_count(rotors))
    for load in scene.loads:
        if load.shaft == scene.shafts[index].name:
            torque = -mechanism.kinematics.sense[index] * float(load.torque(0.0))
            force += torque * turn_row(rotors, index, load.position)
    for part in scene.forces:
        if part.shaft == scene.shafts[index].name and part.turns_with is None:
            rows = section_rows(rotors, index, rotors[index].shaft.origin[2] + part.position)
            wrench = np.array([*part.force, *part.moment])
            force += float(mean_factor(part.course, 0.0, 0.0)) * (wrench @ rows)
    return force


def _support_stiffness(mechanism: Mechanism) -> FloatArray:
    """Return the stiffness of bearings, at their typical load, and of shafts over all freedoms, (N, N)."""
    rotors = mechanism.rotors
    joined = gather_connections(mechanism.scene, rotors)
    supports, seats = joined.supports, joined.seats
    total = supports.matrix(supports.stiffness, supports.motion, supports.motion)
    springs, _ = elastic_terms(rotors)
    total += seats.motion.T @ seats.stiffness @ seats.motion + np.diag(springs)
    for index, rotor in enumerate(rotors):
        for stiffness, lever in rotor.typical_stiffness:
            rows = section_rows(rotors, index, rotor.center[2] + lever)[:SEAT]  # the shaft turns freely
            total += rows.T @ stiffness @ rows
    return total
