"""Forces of bearings by speed and order, from wherever they are known."""

from __future__ import annotations

from typing import Protocol

from dynamics.results.order_fit import ComplexArray
from dynamics.types import BoolArray, FloatArray, Json


class BearingHarmonics(Protocol):
    """Forces of b bearings at S speeds in H orders, each as in a steady state.

    A linear response (`dynamics.linearize.HarmonicResponse`) is one, the orders of a run
    (`dynamics.orders.BearingOrders`) are another.
    """

    @property
    def bearing(self) -> tuple[str, ...]:
        """Names."""

    @property
    def speed(self) -> FloatArray:
        """Of the leading drive, rad/s, (S,)."""

    @property
    def order(self) -> FloatArray:
        """Multiples of the frequency of the first mesh that turns, (H,)."""

    @property
    def frequency(self) -> FloatArray:
        """Hz, (S, H)."""

    @property
    def bearing_force(self) -> ComplexArray:
        """Peak amplitudes on the ground, (b, 3, S, H) in N or (b, 6, S, H) with moments in N m.

        The phases of all bearings at one speed and order are about one moment.
        """

    @property
    def in_contact(self) -> BoolArray:
        """Whether all driving flanks stay in contact at each speed, (S,)."""


class ReportedHarmonics(BearingHarmonics, Protocol):
    """The same with what is known of their origin."""

    @property
    def facts(self) -> Json:
        """Plain JSON."""
