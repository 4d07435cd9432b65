"""Condensation of a tooth against the matrix speed of a core, and the system time of a run by default."""

from __future__ import annotations

from statistics import median

from benchmarks.figures import Figure
from benchmarks.fresh_process import measure

SUBJECT = "condensation"
SYSTEM_SHARE = 4.0
"""Largest share of system time in the CPU time of a run by default, %."""
OVER_OPERATIONS = 1.25
"""CPU time of a tooth over that of its operations at the rate of a symmetric update, at most: 80 % of it."""
_REPEATS = 3
_TOOTH = """
import math, resource
from dataclasses import replace
from fe_contact import Gear
from fe_contact.compliance.condensation_cost import _dense_rate
from fe_contact.compliance.elimination_tree import sector_tree
from fe_contact.compliance.sector_stiffness import sector_stiffness
from fe_contact.compliance.substructure import condense
from fe_contact.mesh import SectorRecipe, quad_sector, swept_sector

gear = Gear(
    teeth=39, normal_module=3e-3, face_width=25e-3, bore_diameter=60e-3,
    helix_angle=math.radians(26.0), profile_shift_coefficient=0.46846,
)

def condensed(recipe):
    section = quad_sector(gear, recipe)
    sector = swept_sector(section.grid, gear.face_width, recipe)
    stiffness, tree = sector_stiffness(gear, section, sector), sector_tree(sector)
    begun = resource.getrusage(resource.RUSAGE_SELF)
    kept = condense(tree, sector.element_freedoms, stiffness)
    ended = resource.getrusage(resource.RUSAGE_SELF)
    return tree, ended.ru_utime - begun.ru_utime, ended.ru_stime - begun.ru_stime

condensed(replace(SectorRecipe.draft(gear), layers=6))  # compiles
tree, user, system = condensed(SectorRecipe.standard(gear))
at_matrix_speed = tree.operations / _dense_rate()
measured = {"over": (user + system) / at_matrix_speed, "user": user, "system": system}
"""
_DEFAULT = """
import resource, tempfile
from pathlib import Path
from benchmarks.quiet_helical_cases import quiet_pairs
from fe_contact import analyze
from host import peak_memory

def times():
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime for one in used), sum(one.ru_stime for one in used)

case = quiet_pairs()[0]
with tempfile.TemporaryDirectory() as folder:
    begun = times()
    analyze(case.pair, torques=case.torques, cache=Path(folder))
    ended = times()
user, system = (after - before for before, after in zip(begun, ended))
measured = {"cpu": user + system, "share": 100.0 * system / (user + system), "peak": peak_memory()}
"""


def figures() -> list[Figure]:
    """Return the medians of several fresh processes."""
    tooth, default = _medians(_TOOTH), _medians(_DEFAULT)
    of_tooth = f"{SUBJECT} of a tooth, 39 teeth, 26 degrees, standard"
    of_run = f"{SUBJECT} and the rest of a quiet helical pair by default, cold"
    return [
        Figure(of_tooth, "CPU time over operations at matrix speed", tooth["over"], "-", OVER_OPERATIONS),
        Figure(of_tooth, "user", tooth["user"], "CPU s"),
        Figure(of_tooth, "system", tooth["system"], "CPU s"),
        Figure(of_run, "all", default["cpu"], "CPU s"),
        Figure(of_run, "system", default["share"], "%", SYSTEM_SHARE),
        Figure(of_run, "peak memory", default["peak"] / 2**30, "GiB"),
    ]


def _medians(code: str) -> dict[str, float]:
    """Measure in several processes, after one that may compile."""
    measure(code)
    runs = [measure(code) for _ in range(_REPEATS)]
    return {name: median(run[name] for run in runs) for name in runs[0]}
