"""What the laws of bearings have in common that are not linear: the mechanism asks nothing else of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from dynamics.types import FloatArray


@dataclass(frozen=True)
class BearingDuty:
    """What is expected of a bearing."""

    load: float
    """Its typical load, N."""
    mass: float
    """Its share of the mass on the shaft, kg."""
    lever: float
    """Radius that makes lengths of tilts where a law has none of its own, m."""


class BearingLaw(Protocol):
    """A law of p rows at a bushing or planet bearing, in addition to its linear one."""

    @property
    def arrays(self) -> Any:
        """The packed arrays of its kind, which `ElementLaws` has a field of."""

    @property
    def bushing(self) -> str:
        """Where it acts."""

    @property
    def acts_at(self) -> str:
        """That and, of a law of a direction, the direction: no two laws of a kind have the same."""

    def rows(self, duty: BearingDuty) -> FloatArray:
        """Return its coordinates, m, per displacement x, y, z, tilt_x, tilt_y of the bearing, (p, 5)."""

    def laid_out(self, duty: BearingDuty) -> Any:
        """Return what those take of it."""

    def typical(self, duty: BearingDuty) -> FloatArray:
        """Return the stiffness of the rows at the typical load, (p,), N/m."""

    def missed(self, duty: BearingDuty) -> float:
        """Return what its tangent misses of the displacement under the typical load, m."""
