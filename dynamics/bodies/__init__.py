"""Bodies: shafts rigid and elastic, the gears on them, their inertia, laws of time that move or load them."""

from dynamics.bodies.angle_law import AngleLaw
from dynamics.bodies.beam_section import BeamSection
from dynamics.bodies.disc_body import DiscBody
from dynamics.bodies.elastic_modes import ReducedBody, craig_bampton
from dynamics.bodies.elastic_shaft import Disc, ElasticShaft, PointOfApplication, elastic_shaft
from dynamics.bodies.gear_body import GearBody
from dynamics.bodies.inertia import Inertia, hollow_cylinder
from dynamics.bodies.load_course import BySpeed, Orders
from dynamics.bodies.shaft import Shaft
from dynamics.bodies.speed_curve import SpeedCurve
from dynamics.bodies.time_law import TimeLaw
from dynamics.bodies.timoshenko_beam import TimoshenkoBeam, timoshenko_beam

__all__ = [
    "AngleLaw",
    "BeamSection",
    "BySpeed",
    "Disc",
    "DiscBody",
    "ElasticShaft",
    "GearBody",
    "Inertia",
    "Orders",
    "PointOfApplication",
    "ReducedBody",
    "Shaft",
    "SpeedCurve",
    "TimeLaw",
    "TimoshenkoBeam",
    "craig_bampton",
    "elastic_shaft",
    "hollow_cylinder",
    "timoshenko_beam",
]
