"""The force elements of tooth flanks: in the plane of the gears, and in space where effects ask for it.

A flank in the plane has one local coordinate, its deflection. In space it has further rows, for misalignment,
center distance and sliding. Entries of flanks are all driving flanks, then the coast flanks.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from dynamics.assembly.model import Model
from dynamics.effects.force_terms import CENTER_DISTANCE, MISALIGNMENT, SLIDING, FlankInSpace, FlankTerms
from dynamics.forces.elements import Element
from dynamics.forces.laws import Law
from dynamics.mechanism.flank_gradients import approach, middle_from_driver
from dynamics.mechanism.line_of_action import line_of_action
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.spatial_flank import SpatialFlankLaws
from dynamics.types import FloatArray


def spatial_flank_elements(model: Model) -> tuple[tuple[Element, ...], SpatialFlankLaws]:
    """Return the elements of all flanks, and the laws of those in space.

    A flank is in space where an effect adds terms to its force. The kinematic motion makes flanks slide but
    does not change their deflection.
    """
    mechanism, law, plain = model.mechanism, model.flanks.law, flank_elements(model)
    elements: list[Element] = []
    grids: list[MeshTable] = []
    columns: dict[str, list[Any]] = {name: [] for name in SpatialFlankLaws._fields[1:]}
    for entry, element in enumerate(plain):
        flank = FlankInSpace(mechanism, element.mesh, coast=entry >= len(mechanism.lines))
        in_plane = FlankTerms(model.flanks.tables[entry])
        mesh, terms = mechanism.scene.meshes[element.mesh], in_plane
        for effect in model.ledger.on_mesh(mesh.name):
            terms = effect.contribute(terms, flank)
        if terms is in_plane:
            elements.append(element)
            continue
        # the coast flank sees the misalignment from the other side
        fixed = (-mesh.misalignment if flank.coast else mesh.misalignment, mesh.center_distance_change)
        rows, first = _rows_in_space(element, terms, fixed, mechanism.vectors)
        elements.append(Element(Law.SPATIAL_FLANK, len(grids), element.mesh, *rows))
        grids.append(terms.table)
        fields = {
            "damping": law.damping[entry],
            "reach": law.reach[entry],
            "row": first,
            "fixed": fixed,
            "follows": terms.follows,
            "per_face": terms.per_face,
            "mid_face": middle_from_driver(mechanism.scene, flank.index, flank.line, flank.sense),
            "friction": terms.friction,
            "radius": mechanism.scene.gear(mesh.driver).base_radius,
            "running": False,  # friction follows the sliding velocity
        }
        for name, value in fields.items():
            columns[name].append(value)
    return tuple(elements), SpatialFlankLaws.packed(grids, columns)


def _rows_in_space(
    element: Element, terms: FlankTerms, fixed: tuple[float, float], vectors: FloatArray
) -> tuple[tuple[FloatArray, FloatArray, FloatArray], list[int]]:
    """Return gradient, offset and drift of the rows of a flank, and the first row of each kind; -1: none.

    The first of all rows is the deflection, as `element` has it in the plane. `fixed` holds misalignment and
    center-distance change of the mesh, m, as the flank sees them.
    """
    offset_of = {MISALIGNMENT: fixed[0], CENTER_DISTANCE: fixed[1], SLIDING: 0.0}
    gradient, offset, slides, first = [element.gradient], [float(element.offset[0])], [False], []
    for kind, rows in enumerate(terms.rows):
        first.append(-1 if rows is None else len(offset))
        if rows is not None:
            gradient.append(rows)
            offset += [offset_of[kind]] * len(rows)
            slides += [kind == SLIDING] * len(rows)
    all_rows = np.concatenate(gradient)
    drift = np.where(np.array(slides)[:, None], all_rows @ vectors.T, 0.0)
    return (all_rows, np.array(offset), drift), first


def flank_elements(model: Model) -> tuple[Element, ...]:
    """Return one element per entry of ``flanks.law``: all driving flanks, then the coast flanks.

    The coordinate of a driving flank is the transmission error. A coast flank pushes along the line of action
    of the opposite sense; its coordinate is the approach along that line less the backlash. A smaller center
    distance closes both flanks.
    """
    mechanism = model.mechanism
    scene, rotors, lines = mechanism.scene, mechanism.rotors, mechanism.lines
    driving = [
        Element(Law.FLANK, index, index, approach(scene, rotors, index, line)[None, :], np.zeros(1))
        for index, line in enumerate(lines)
    ]
    coast_flanks = []
    for entry, index in enumerate(model.flanks.coast, start=len(lines)):
        line = line_of_action(scene, index, -mechanism.kinematics.mesh_sense[index])
        coast = scene.meshes[index].coast
        gap = coast.backlash if coast is not None else 0.0
        gradient = approach(scene, rotors, index, line)[None, :]
        coast_flanks.append(Element(Law.FLANK, entry, index, gradient, np.array([-gap])))
    return (*driving, *coast_flanks)
