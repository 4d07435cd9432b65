"""The effects of the multibody model, one line each, and those that it leaves out."""

from __future__ import annotations

from dynamics.effects.axial import Axial
from dynamics.effects.backlash import Backlash
from dynamics.effects.bearing_clearance import BearingClearance
from dynamics.effects.bearing_temperature import BearingTemperature
from dynamics.effects.centrifugal_load import CentrifugalLoad
from dynamics.effects.dynamic_center_distance import DynamicCenterDistance
from dynamics.effects.dynamic_misalignment import DynamicMisalignment
from dynamics.effects.effect import Effect
from dynamics.effects.element_passing import ElementPassing
from dynamics.effects.flexible_shafts import FlexibleShafts
from dynamics.effects.friction import Friction
from dynamics.effects.gyroscopic import Gyroscopic
from dynamics.effects.housing_modes import HousingModes
from dynamics.effects.lateral import Lateral
from dynamics.effects.mesh_temperature import MeshTemperature
from dynamics.effects.moving_application_point import MovingApplicationPoint
from dynamics.effects.tilt import Tilt
from dynamics.effects.tooth_deviations import ToothDeviations

EFFECTS: tuple[Effect, ...] = (
    Lateral(),
    Axial(),
    Tilt(),
    BearingTemperature(),
    BearingClearance(),
    ElementPassing(),
    Gyroscopic(),
    CentrifugalLoad(),
    FlexibleShafts(),
    HousingModes(),
    MeshTemperature(),
    Backlash(),
    DynamicMisalignment(),
    DynamicCenterDistance(),
    MovingApplicationPoint(),
    Friction(),
    ToothDeviations(),
)

NEGLECTED: dict[str, str] = {
    "friction of bearings": "bearings turn without loss",
    "point of application of friction along the face": "friction acts at mid-face, at each pair of teeth",
    "flexible members of planetary sets": "sun, ring, carrier and planets are rigid on their shafts",
    "temperature fields": "each part has one steady temperature and expands freely; base pitches stay",
    "damping that turns with a flexible shaft": "material damping acts as on a shaft at rest",
}
