"""The bodies of a scene that move: its rotors, and the housings with mass that carry them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

from dynamics.mechanism.modal_housing import ModalHousing
from dynamics.mechanism.rotor import Rotor


@dataclass(frozen=True, eq=False)
class Bodies(Sequence[Rotor]):
    """A sequence of the rotors of a scene, one per shaft, with the housings whose modes are freedoms.

    Attributes
    ----------
    rotors : tuple of Rotor
    housings : tuple of ModalHousing
        Other housings have no mass: they are condensed into their bearings.
    """

    rotors: tuple[Rotor, ...]
    housings: tuple[ModalHousing, ...] = ()

    @overload
    def __getitem__(self, index: int) -> Rotor: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Rotor, ...]: ...
    def __getitem__(self, index: int | slice) -> Rotor | tuple[Rotor, ...]:
        return self.rotors[index]

    def __len__(self) -> int:
        return len(self.rotors)

    def housing_of(self, bearing: str) -> int | None:
        """Return the index of the housing that moves under `bearing`; None: nothing does."""
        return next((k for k, part in enumerate(self.housings) if bearing in part.bearings), None)
