"""The bodies of a scene that move: its rotors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

from dynamics.mechanism.rotor import Rotor


@dataclass(frozen=True, eq=False)
class Bodies(Sequence[Rotor]):
    """A sequence of the rotors of a scene, one per shaft.

    Attributes
    ----------
    rotors : tuple of Rotor
    """

    rotors: tuple[Rotor, ...]

    @overload
    def __getitem__(self, index: int) -> Rotor: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Rotor, ...]: ...
    def __getitem__(self, index: int | slice) -> Rotor | tuple[Rotor, ...]:
        return self.rotors[index]

    def __len__(self) -> int:
        return len(self.rotors)
