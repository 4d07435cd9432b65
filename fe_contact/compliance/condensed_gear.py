"""A whole gear with all teeth real, solved on the freedoms of one tooth sector."""

from __future__ import annotations

from functools import partial
from typing import NamedTuple

import numpy as np

from fe_contact.compliance.checks_3d import CondensedGear, probe_loads
from fe_contact.compliance.cyclic_ring import FreeTurn, HeldSector, close_ring, hold_sector
from fe_contact.compliance.sector_stiffness import ElementStiffness, flank_frames, sector_stiffness, twist
from fe_contact.compliance.sector_tree import sector_tree
from fe_contact.compliance.substructure import Condensation, condense
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.mesh.quad_sector import QuadSector
from fe_contact.mesh.recipe import SectorRecipe
from fe_contact.mesh.sector_grid import BoreSupport
from fe_contact.mesh.swept_sector import SweptSector, swept_sector
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray


def condensed_gear(
    gear: Toothing,
    section: QuadSector,
    recipe: SectorRecipe,
    reach: int,
    support: BoreSupport,
    clock: StageClock,
    probes: FloatArray | None = None,
) -> tuple[CondensedGear, FloatArray]:
    """Sweep, condense one sector and close the ring.

    Parameters
    ----------
    gear : Gear
        Right hand or spur.
    section : QuadSector
        Mesh of its transverse section.
    recipe : SectorRecipe
        Layers.
    reach : int
        Largest distance in teeth that is kept.
    support : BoreSupport
        How the bore is held.
    clock : StageClock
        Gets the stages ``assembly``, ``condensation``, ``ring`` and their progress.
    probes : (nf, p) array, optional
        Loads on tooth 0 for which all cuts are wanted, N; default `probe_loads`.

    Returns
    -------
    CondensedGear, (nf, p) array
        The solution and the probe loads it was solved for, N.
    """
    tooth, loads = condensed_tooth(gear, section, recipe, support, clock)
    loads = loads if probes is None else probes
    free = _free_turn(section, tooth.sector)
    ring = close_ring(tooth.held, gear.teeth, reach, loads, free, partial(clock.progress, "ring"))
    clock.finish("ring")
    return CondensedGear(tooth.sector, tooth.stiffness, tooth.condensation, tooth.held, ring), loads


class CondensedTooth(NamedTuple):
    """One sector before it meets the others: the first four parts of a `CondensedGear`."""

    sector: SweptSector
    stiffness: ElementStiffness
    condensation: Condensation
    held: HeldSector


def condensed_tooth(
    gear: Toothing, section: QuadSector, recipe: SectorRecipe, support: BoreSupport, clock: StageClock
) -> tuple[CondensedTooth, FloatArray]:
    """Sweep and condense one sector; parameters are those of `condensed_gear`.

    Returns
    -------
    CondensedTooth, (nf, 2) array
        The sector, and probe loads for the checks, N.
    """
    sector = swept_sector(section.grid, gear.face_width, recipe, support, gear.web)
    stiffness = sector_stiffness(gear, section, sector, flank_frames(section, twist(gear)))
    clock.finish("assembly")
    report = partial(clock.progress, "condensation")
    condensation = condense(sector_tree(sector), sector.element_freedoms, stiffness, report)
    clock.finish("condensation")
    held = hold_sector(condensation.matrix, len(sector.loaded))
    s_form = tooth_profile(gear).s_form
    loads = np.zeros((len(sector.loaded), 2))
    loads[: len(sector.flank)] = probe_loads(section.s, sector.layers.ends, sector.flank_index, s_form)
    return CondensedTooth(sector, stiffness, condensation, held), loads


def _free_turn(section: QuadSector, sector: SweptSector) -> FreeTurn | None:
    """Return how a gear moves that nothing but a key keeps from turning; None for one that cannot turn."""
    if sector.seat.key is None:
        return None
    radius = np.zeros((len(sector.freedoms), 3))
    planes, columns = np.nonzero(sector.nodes >= 0)
    radius[sector.nodes[planes, columns], 1] = np.linalg.norm(section.points, axis=1)[columns]
    turn = np.zeros(sector.size)
    turn[sector.freedoms[sector.freedoms >= 0]] = radius[sector.freedoms >= 0]
    return FreeTurn(turn[sector.left], len(sector.flank), sector.key_cut)
