"""Shafts rigid and elastic, the gears and discs on them, their inertia and sections."""

from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.bodies import Inertia, hollow_cylinder
from dynamics.shafts.craig_bampton import craig_bampton
from dynamics.shafts.elastic_shaft import Disc, ElasticShaft, PointOfApplication, elastic_shaft
from dynamics.shafts.rigid_bodies import DiscBody, GearBody
from dynamics.shafts.shaft import Shaft
from dynamics.shafts.timoshenko_beam import timoshenko_beam

__all__ = [
    "BeamSection",
    "Disc",
    "DiscBody",
    "ElasticShaft",
    "GearBody",
    "Inertia",
    "PointOfApplication",
    "Shaft",
    "craig_bampton",
    "elastic_shaft",
    "hollow_cylinder",
    "timoshenko_beam",
]
