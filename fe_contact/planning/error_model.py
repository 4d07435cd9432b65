"""What error a model and a mesh will have, said before anything is computed.

Constants from the differences between the rungs of the accuracy ladder (docs/frontier.md), rounded up: the
plane five times what the 20/20 pair showed, spur pairs over the face half as much again, helical pairs as the
automotive pair, whose peak-to-peak is 3 % of its mean, so that its per cents are hard to keep. They are made
for usual gears and say nothing of a single one; what a run measures itself, in its table, replaces them.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass

from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.planning.discretisation import FaceDiscretisation, PlaneDiscretisation
from fe_contact.types import Json

LEVELS = ("draft", "standard", "fine")
_PLANE = {"draft": 2e-3, "standard": 1e-3, "fine": 5e-4}
_FACE = {"draft": 1e-2, "standard": 4e-3, "fine": 2e-3}
_HELICAL = {"draft": 6e-2, "standard": 2e-2, "fine": 1e-2}
_CORRECTION = 0.03
"""Error of the correction for a finite width in parts of the correction."""


@dataclass(frozen=True)
class ExpectedError:
    """Relative error of mean and peak-to-peak STE, the worse of the two.

    Attributes
    ----------
    mesh : float
        Finite elements and slices.
    model : float
        The plane standing in for three dimensions; 0 over the face.
    """

    mesh: float
    model: float

    @property
    def total(self) -> float:
        """Sum of both."""
        return self.mesh + self.model

    def to_json(self) -> Json:
        """Return plain JSON."""
        return asdict(self) | {"total": self.total}


def expected_error(
    pair: ParallelAxes, made: PlaneDiscretisation | FaceDiscretisation, level: str
) -> ExpectedError:
    """Say the error of a discretisation of a level."""
    if isinstance(made, FaceDiscretisation):
        return ExpectedError((_HELICAL if pair.base_helix_angle else _FACE)[level], 0.0)
    excess = finite_width_excess(pair)
    return ExpectedError(_PLANE[level], _CORRECTION * excess if made.corrected else excess)
