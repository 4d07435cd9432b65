"""The quantity for which a scene is computed: one of its bearing forces, by whose level effects change."""

from __future__ import annotations

from typing import Protocol

from dynamics.types import ComplexArray, FloatArray


class ForceLines(Protocol):
    """Forces of b bearings at S speeds in H orders, as of `dynamics.vibration.BearingHarmonics`."""

    @property
    def bearing(self) -> tuple[str, ...]:
        """Names of the bearings."""

    @property
    def frequency(self) -> FloatArray:
        """Frequencies, (S, H), Hz."""

    @property
    def bearing_force(self) -> ComplexArray:
        """Peak amplitudes on the ground, (b, 3 or 6, S, H), N and N m."""


class LevelQuantity(Protocol):
    """A quantity by whose level effects are sized, and with a tolerance decided."""

    @property
    def name(self) -> str:
        """Name of the quantity in words."""

    @property
    def unit(self) -> str:
        """Unit of the level: "dB", "dB(A)"."""

    def squares(self, forces: ForceLines) -> FloatArray:
        """Return powers or mean squares, weighted, (S, H); raises `InputError` where they are not known."""
