"""What a scene is computed for: a quantity of the forces on its bearings whose level effects change."""

from __future__ import annotations

from typing import Protocol

from dynamics.types import ComplexArray, FloatArray


class ForceLines(Protocol):
    """Forces of b bearings at S speeds in H orders, as of `dynamics.vibration.BearingHarmonics`."""

    @property
    def bearing(self) -> tuple[str, ...]:
        """Names."""

    @property
    def frequency(self) -> FloatArray:
        """Hz, (S, H)."""

    @property
    def bearing_force(self) -> ComplexArray:
        """Peak amplitudes on the ground, (b, 3 or 6, S, H), N and N m."""


class LevelQuantity(Protocol):
    """A quantity by whose level effects are sized, and with a tolerance decided."""

    @property
    def name(self) -> str:
        """In words."""

    @property
    def unit(self) -> str:
        """Of its level: "dB", "dB(A)"."""

    def squares(self, forces: ForceLines) -> FloatArray:
        """Return powers or mean squares, weighted, (S, H); raises `InputError` where they are not known."""
