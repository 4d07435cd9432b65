"""Shafts rigid and elastic, the gears and discs on them, their inertia and sections."""

from dynamics.shafts.beam_section import BeamSection
from dynamics.shafts.disc_body import DiscBody
from dynamics.shafts.elastic_modes import ReducedBody, craig_bampton
from dynamics.shafts.elastic_shaft import Disc, ElasticShaft, PointOfApplication, elastic_shaft
from dynamics.shafts.gear_body import GearBody
from dynamics.shafts.inertia import Inertia, hollow_cylinder
from dynamics.shafts.shaft import Shaft
from dynamics.shafts.timoshenko_beam import TimoshenkoBeam, timoshenko_beam

__all__ = [
    "BeamSection",
    "Disc",
    "DiscBody",
    "ElasticShaft",
    "GearBody",
    "Inertia",
    "PointOfApplication",
    "ReducedBody",
    "Shaft",
    "TimoshenkoBeam",
    "craig_bampton",
    "elastic_shaft",
    "hollow_cylinder",
    "timoshenko_beam",
]
