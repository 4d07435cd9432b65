"""Dense substructures with cyclic harmonics against a sparse solver, on one sector and on a whole gear."""

from __future__ import annotations

from typing import Any

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

_COMMON = """
import resource, time
from dataclasses import replace
import numpy as np
import scipy.sparse as sp
from fe_contact import Gear
from fe_contact.compliance import flank_compliance_3d
from fe_contact.compliance.sector_stiffness import sector_stiffness
from fe_contact.compliance.elimination_tree import sector_tree
from fe_contact.compliance.ring_2d import factorise
from fe_contact.compliance.substructure import condense
from fe_contact.mesh import SectorRecipe, quad_sector, swept_sector

gear = Gear(teeth=20, normal_module=4e-3, face_width=25e-3, bore_diameter=40e-3)
sparse = {solver!r} != "own"

def meshed(gear, recipe):
    section = quad_sector(gear, recipe)
    sector = swept_sector(section.grid, gear.face_width, recipe)
    return sector, sector_stiffness(gear, section, sector)

def assembled(sector, stiffness, numbers):
    held = np.append(numbers, np.full((len(numbers), 1), -1), axis=1)
    freedoms = np.concatenate([row[sector.element_freedoms] for row in held])
    values = np.tile(stiffness.matrices[stiffness.of_element], (len(numbers), 1, 1))
    i, k = np.broadcast_arrays(freedoms[:, :, None], freedoms[:, None, :])
    free = (i >= 0) & (k >= 0)
    return sp.csc_array(sp.coo_array((values[free], (i[free], k[free]))))

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024

def off(found, expected):
    return float(np.abs(found - expected).max() / np.abs(expected).max())
"""
_SECTOR = (
    _COMMON
    + """
def own(sector, stiffness):
    lower = np.tril(condense(sector_tree(sector), sector.element_freedoms, stiffness)[0])
    return lower + np.tril(lower, -1).T

sector, stiffness = meshed(gear, SectorRecipe.standard(gear))
own(*meshed(gear, replace(SectorRecipe.draft(gear), layers=2)))  # compiles
kept = np.concatenate([sector.flank, sector.left, sector.right])
inner = np.setdiff1d(np.arange(sector.size), kept)
before = peak()
start = time.process_time()
if not sparse:
    found = own(sector, stiffness)
else:
    matrix = assembled(sector, stiffness, np.arange(sector.size)[None])
    across = matrix[inner][:, kept].toarray()
    solve = factorise(sp.csc_array(matrix[inner][:, inner]), block=1)
    found = matrix[kept][:, kept].toarray() - across.T @ solve(across)
spent, used = time.process_time() - start, peak() - before
measured = {{
    "seconds": spent, "bytes": used, "unknowns": sector.size, "kept": len(kept),
    "off": off(found, own(sector, stiffness)) if sparse else 0.0,
}}
"""
)
_GEAR = (
    _COMMON
    + """
recipe = replace(SectorRecipe.even_load(gear), layers=6, layer_growth=1.5, half_face=False)
flank_compliance_3d(gear, replace(recipe, layers=2))  # compiles
before = peak()
start = time.process_time()
if not sparse:
    result = flank_compliance_3d(gear, recipe)
    unknowns, flank, difference = result.unknowns, len(result.blocks[0]), 0.0
    spent, used = time.process_time() - start, peak() - before
else:
    sector, stiffness = meshed(gear, recipe)
    own = np.setdiff1d(np.arange(sector.size), sector.left)
    number = np.full((gear.teeth, sector.size), -1)
    number[:, own] = np.arange(gear.teeth * len(own)).reshape(gear.teeth, -1)
    number[:, sector.left] = np.roll(number[:, sector.right], -1, axis=0)
    matrix = assembled(sector, stiffness, number)
    flank = len(sector.flank)
    loads = np.zeros((matrix.shape[0], flank))
    loads[number[0, sector.flank], np.arange(flank)] = 1.0
    found = factorise(matrix, block=1)(loads)[number[0, sector.flank]]
    spent, used = time.process_time() - start, peak() - before
    unknowns, difference = matrix.shape[0], off(found, flank_compliance_3d(gear, recipe).blocks[0])
measured = {{"seconds": spent, "bytes": used, "unknowns": unknowns, "kept": flank, "off": difference}}
"""
)
_SOLVERS = ("own", "SuperLU on METIS")


def figures() -> list[Figure]:
    """Return time, memory and agreement of each solver on both systems."""
    return [
        *_system("one sector of a 20-tooth gear, standard", _SECTOR),
        *_system("whole 20-tooth gear, coarse", _GEAR),
    ]


def _system(name: str, code: str) -> list[Figure]:
    """Solve one system by every solver, each in a process of its own."""
    runs: dict[str, dict[str, Any]] = {solver: measure(code.format(solver=solver)) for solver in _SOLVERS}
    own = runs["own"]
    subject = f"3-D solvers, {name}: {own['unknowns']} unknowns, {own['kept']} kept"
    found = []
    for solver, run in runs.items():
        label = "dense substructures (used)" if solver == "own" else solver
        found.append(Figure(subject, f"{label}: time", run["seconds"], "CPU s"))
        found.append(Figure(subject, f"{label}: memory", run["bytes"] / 2**20, "MiB"))
        if solver != "own":
            found.append(Figure(subject, f"{label}: off the first", run["off"], "-", 1e-9))
    return found
