"""The contact linearized about a configuration of the gears."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray
from verification.full_contact.condensation.active_set import ContactSystem
from verification.full_contact.condensation.sites import ContactSite
from verification.full_contact.line_load import LineLoad

MIN_FACING = 0.01
"""Hats of which less than this part of their length faces the mate carry no pressure."""


@dataclass(frozen=True)
class Configuration:
    """Lag of the driven gear in m, and displacements (u_1,), (u_2,) of the strips of both gears, m."""

    lag: float
    displacements: tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class LinearizedContact:
    """Contact with the geometry and the forces of one configuration; h hats."""

    system: ContactSystem
    forces: tuple[FloatArray, FloatArray]
    displacement: tuple[FloatArray, FloatArray]
    """`forces`, `displacement`: Forces on the strips of both gears by unit pressures, and displacements.
    ((u_1, h), (u_2, h)) arrays.
    """
    site: IntArray
    """Index of the site of each hat. Shape (h,)."""
    line: IntArray
    """Number of the profile along which each hat stands. Shape (h,)."""
    at_end: BoolArray
    """Whether a hat is at an end of its strip that is no tip edge: its pressure is cut off. Shape (h,)."""


class Solution(NamedTuple):
    """A contact, its pressures, and the required torque on gear 1 per thickness."""

    contact: LinearizedContact
    pressure: FloatArray
    torque: float


class ContactGeometry(Protocol):
    """Two condensed bodies that may touch at sites."""

    @property
    def pair(self) -> ParallelAxes:
        """The pair."""

    @property
    def sites(self) -> tuple[ContactSite, ...]:
        """Pairs of teeth that may touch."""

    @property
    def thickness(self) -> float:
        """Face width over which its forces are counted, m; 1 where they are counted over all of it."""

    @property
    def undeformed(self) -> Configuration:
        """Rigid gears in the conjugate position."""

    def linearized(self, at: Configuration) -> LinearizedContact:
        """Return the contact with the geometry and the forces of a configuration."""

    def checks(self, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
        """Return the largest relative breach of the laws, and the torque of gear 2 over that of gear 1."""

    def line_loads(self, contact: LinearizedContact, pressure: FloatArray) -> tuple[LineLoad, ...]:
        """Return the load of every pair along the face; none in the plane."""


def rotation(angle: float) -> FloatArray:
    """Return the matrix that turns vectors counter-clockwise."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def turned_back(forces: FloatArray, turn: FloatArray) -> FloatArray:
    """Turn forces (2 k, h) on gear 2 back into the frame of its mesh."""
    vectors = forces.reshape(-1, 2, forces.shape[1])
    return np.asarray(np.einsum("yx,nyh->nxh", turn, vectors).reshape(forces.shape))
