"""Scenes whose shafts bend and twist, and what closed forms say of them."""

from dataclasses import replace

import numpy as np
from geared_scenes import gear_pair_scene

from dynamics.bearings import Bushing
from dynamics.mechanism.columns import section_rows
from dynamics.shafts import BeamSection, Inertia

STEEL = BeamSection(0.2, 0.04)


def with_sections(scene, section=STEEL, shafts=("input", "output"), **changes):
    found = []
    for shaft in scene.shafts:
        own = (replace(section, length=shaft.length),) if shaft.name in shafts else shaft.sections
        inertia = Inertia() if own else shaft.inertia
        found.append(replace(shaft, sections=own, inertia=inertia, **(changes if own else {})))
    return replace(scene, shafts=tuple(found))


def flexible_pair(section=STEEL, gear=0.1, bearings=(0.0, 0.2), stiffness=1e8, **changes):
    """The 20/20 pair with its gears at `gear` along flexible shafts and bearings at two positions."""
    scene = with_sections(gear_pair_scene(**changes), section)
    gears = tuple(replace(part, position=gear) for part in scene.gears)
    bushings = tuple(
        Bushing(f"{shaft}.{end}", shaft, position, stiffness, stiffness)
        for shaft in ("input", "output")
        for end, position in zip(("left", "right"), bearings, strict=True)
    )
    effects = {"flexible_shafts": "on", **scene.effects}
    return replace(scene, gears=gears, bushings=bushings, effects=effects)


def section_motion(system, shaft, position, q):
    """Motion (6,) of a section at `position` along a shaft in the state `q` (n,)."""
    index = system.scene.shaft_index(shaft)
    z = system.scene.shafts[index].origin[2] + position
    return system.freedoms.keep(section_rows(system.rotors, index, z)) @ np.asarray(q)


def bending_stiffness(section):
    """E I."""
    return section.youngs_modulus * section.second_moment


def shear_stiffness(section):
    """kappa A G."""
    return section.shear_coefficient * section.shear_modulus * section.area


def torsional_stiffness(section):
    """G J."""
    return section.shear_modulus * 2.0 * section.second_moment
