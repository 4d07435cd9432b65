"""The interface of a fidelity of the accuracy study of dynamics."""

from __future__ import annotations

from typing import Protocol

from dynamics.accuracy.vibration import Blocks, Vibration
from dynamics.scene import Scene


class Fidelity(Protocol):
    """A model or setting that computes the vibration of a scene, coarse or fine.

    Attributes
    ----------
    name : str
        Key in tables and JSON.
    title : str
        In words.
    family : str
        What it varies: "model", "table" or "steps".
    """

    @property
    def name(self) -> str:
        """Key in tables and JSON."""

    @property
    def title(self) -> str:
        """In words."""

    @property
    def family(self) -> str:
        """What it varies."""

    def refusal(self, scene: Scene) -> str | None:
        """Say why this fidelity says nothing about a scene; None if it does."""

    def run(self, scene: Scene, blocks: Blocks) -> Vibration:
        """Compute the vibration.

        Raises
        ------
        SolveError
            It ended early.
        InputError
            The scene has what this model cannot hold.
        """
