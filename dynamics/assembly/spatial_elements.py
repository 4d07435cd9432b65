"""The flank elements of meshes to whose forces effects contribute."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.assembly.model import Model
from dynamics.effects.flank_terms import CENTER_DISTANCE, MISALIGNMENT, SLIDING, FlankInSpace, FlankTerms
from dynamics.forces.grid_tables import pack_grids
from dynamics.forces.law import Law
from dynamics.forces.spatial_flank import SpatialFlankLaws
from dynamics.mechanism.flank_gradients import middle_from_driver
from dynamics.types import BoolArray, FloatArray, IntArray


@dataclass(frozen=True)
class SpatialFlank:
    """One flank with what effects add, laid out: its rows after that of the deflection, and how it uses them.

    Attributes
    ----------
    entry : int
        Its index among all flanks.
    terms : FlankTerms
    fixed : (float, float)
        Misalignment and center-distance change of the mesh, m, as the flank sees them.
    mid_face, radius : float
        As in `SpatialFlankLaws`, m.
    row : (3,) int array
        First row of each kind; -1: none.
    gradient : (p, N) array
    offset : (p,) array
    slides : (p,) bool array
    """

    entry: int
    terms: FlankTerms
    fixed: tuple[float, float]
    mid_face: float
    radius: float
    row: IntArray
    gradient: FloatArray
    offset: FloatArray
    slides: BoolArray


def spatial_elements(model: Model, plain: Sequence[Element]) -> tuple[tuple[Element, ...], SpatialFlankLaws]:
    """Return the elements `plain` with those of such meshes replaced, each at its index, and their laws.

    Flanks slide along the kinematic motion but keep their deflection.
    """
    vectors = model.mechanism.vectors
    elements: list[Element] = []
    flanks: list[SpatialFlank] = []
    for entry, element in enumerate(plain):
        flank = FlankInSpace(model.mechanism, element.mesh, coast=entry >= len(model.mechanism.lines))
        in_plane = FlankTerms(model.flanks.tables[entry])
        terms = in_plane
        for effect in model.ledger.on_mesh(model.mechanism.scene.meshes[element.mesh].name):
            terms = effect.contribute(terms, flank)
        if terms is in_plane:
            elements.append(element)
            continue
        laid_out = _lay_out(entry, element, flank, terms)
        drift = np.where(laid_out.slides[:, None], laid_out.gradient @ vectors.T, 0.0)
        law, rows = Law.SPATIAL_FLANK, (laid_out.gradient, laid_out.offset)
        elements.append(Element(law, len(flanks), element.mesh, *rows, drift))
        flanks.append(laid_out)
    return tuple(elements), _pack(model, flanks)


def _lay_out(entry: int, element: Element, flank: FlankInSpace, terms: FlankTerms) -> SpatialFlank:
    """Lay out the rows of a flank after that of its deflection, which `element` has in the plane."""
    scene = flank.mechanism.scene
    mesh = scene.meshes[flank.index]
    fixed = (-mesh.misalignment if flank.coast else mesh.misalignment, mesh.center_distance_change)
    at = {MISALIGNMENT: fixed[0], CENTER_DISTANCE: fixed[1], SLIDING: 0.0}
    gradient, offset, slides, first = [element.gradient], [float(element.offset[0])], [False], []
    for kind, rows in enumerate(terms.rows):
        first.append(-1 if rows is None else len(offset))
        if rows is not None:
            gradient.append(rows)
            offset += [at[kind]] * len(rows)
            slides += [kind == SLIDING] * len(rows)
    return SpatialFlank(
        entry,
        terms,
        fixed,
        middle_from_driver(scene, flank.index, flank.line, flank.sense),
        scene.gear(mesh.driver).base_radius,
        np.array(first),
        np.concatenate(gradient),
        np.array(offset),
        np.array(slides),
    )


def _pack(model: Model, flanks: Sequence[SpatialFlank]) -> SpatialFlankLaws:
    """Lay out the laws."""
    law = model.flanks.law
    return SpatialFlankLaws(
        pack_grids([flank.terms.table for flank in flanks]),
        np.array([law.damping[flank.entry] for flank in flanks], dtype=float),
        np.array([law.reach[flank.entry] for flank in flanks], dtype=float),
        np.array([flank.row for flank in flanks], dtype=np.int64).reshape(-1, 3),
        np.array([flank.fixed for flank in flanks], dtype=float).reshape(-1, 2),
        np.array([flank.terms.follows for flank in flanks], dtype=np.int64).reshape(-1, 2),
        np.array([flank.terms.per_face for flank in flanks], dtype=float),
        np.array([flank.mid_face for flank in flanks], dtype=float),
        np.array([flank.terms.friction for flank in flanks], dtype=float),
        np.array([flank.radius for flank in flanks], dtype=float),
        np.zeros(len(flanks), dtype=np.bool_),
    )
