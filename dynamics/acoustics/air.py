"""The medium that carries the sound."""

from __future__ import annotations

from dataclasses import dataclass

from bounds import Declared, Kind, between, declared, described
from dynamics.checks import declared_fields

DENSITY = Declared(Kind.INERTIA, "kg/m^3", between(0.1, 10.0), "Density of the air", 1.204)
SOUND_SPEED = Declared(Kind.SPEED, "m/s", between(100.0, 1000.0), "Speed of sound", 343.2)


@described
@dataclass(frozen=True)
class Air:
    """A gas at rest without losses; the defaults are air of 20 degrees Celsius at 1013.25 hPa."""

    density: float = declared(1.204, DENSITY)
    sound_speed: float = declared(343.2, SOUND_SPEED)

    def __post_init__(self) -> None:
        declared_fields(self)

    @property
    def impedance(self) -> float:
        """Return rho c, Pa s/m."""
        return self.density * self.sound_speed
