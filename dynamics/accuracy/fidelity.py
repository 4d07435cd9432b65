"""The interface of a fidelity of the accuracy study of dynamics."""

from __future__ import annotations

from typing import Protocol

import model_studies
from dynamics.accuracy.vibration import Blocks, Vibration
from dynamics.scene import Scene


class Fidelity(model_studies.Fidelity[Scene], Protocol):
    """A way to the vibration of a scene; its family is "model", "table" or "steps"."""

    def run(self, scene: Scene, blocks: Blocks) -> Vibration:
        """Compute the vibration.

        Raises
        ------
        SolveError
            It ended early.
        InputError
            The scene has what this model cannot hold.
        """
