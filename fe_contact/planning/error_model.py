"""What error a model, a mesh and slices will have, said before anything is computed.

What a mesh or slices change is a part of the mean transmission error, also where it is peak-to-peak that
they change: the smaller the ripple, the larger its relative error. Constants are from the cases of
docs/accuracy.md that are not held out, rounded up; a run's own error estimate replaces what is said here.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

from fe_contact.compliance import PlaneHypothesis
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import finite_width_excess, plane_stress_excess
from fe_contact.planning.discretisation import SLICE_ORDER, Discretisation, FaceDiscretisation
from fe_contact.planning.plan import Plan
from fe_contact.types import Json

_PLANE = {"draft": 4e-3, "standard": 2.5e-3, "fine": 2e-3}
"""Mesh in the plane, of mean and peak-to-peak."""
_FACE_MEAN = {"draft": 6e-3, "standard": 2.5e-3, "fine": 1e-3}
"""Mesh over the face, of the mean; by the ripple more."""
_SPUR_RIPPLE = {"draft": 5.5e-3, "standard": 1.8e-3, "fine": 8e-4}
"""Mesh over the face, of peak-to-peak in parts of the mean: spur pairs."""
_HELICAL_RIPPLE = {"draft": 3e-3, "standard": 1.5e-3, "fine": 7e-4}
_RELIEVED_RIPPLE = {"draft": 1.8e-3, "standard": 9e-4, "fine": 4e-4}
"""The same of helical pairs with plain and with modified profiles, whose contact lines end under less load:
in 7 of 10 cases runs state less (16 cases of 7 pairs at 0.4, 1 and 2 times their load)."""
_HELICAL_SLICES, _SPUR_SLICES, _SLICES, _ORDER = 1.2e-3, 2e-4, 15, SLICE_ORDER
"""Peak-to-peak in parts of the mean at so many slices, and its order in their number."""
_CORRECTION, LEFT_OUT = 0.03, 1.25
"""Error of the correction for a finite width over what it is expected to correct, and of leaving it out."""


@dataclass(frozen=True)
class Ripple:
    """Peak-to-peak over mean transmission error under load: the least and the largest of a table."""

    least: float
    most: float


SPUR_RIPPLE, HELICAL_RIPPLE = Ripple(0.3, 0.6), Ripple(0.1, 0.4)
"""Of usual pairs, where nothing better is known."""


@dataclass(frozen=True)
class ExpectedError:
    """Relative error of mean and peak-to-peak STE, the worse of the two.

    Attributes
    ----------
    mesh : float
        Finite elements.
    slices : float
        Slices of the face; 0 in the plane.
    model : float
        The plane standing in for three dimensions; 0 over the face.
    """

    mesh: float
    slices: float
    model: float

    @property
    def discretisation(self) -> float:
        """What finer meshes and more slices mend: independent of each other."""
        return math.hypot(self.mesh, self.slices)

    @property
    def total(self) -> float:
        """Discretisation and model."""
        return self.discretisation + self.model

    def to_json(self) -> Json:
        """Return plain JSON."""
        return asdict(self) | {"total": self.total}


def expected_error(pair: ParallelAxes, plan: Plan, ripple: Ripple | None = None) -> ExpectedError:
    """Say the error of a plan.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    plan : Plan
    ripple : Ripple, optional
        What is known of the ripple of the case; default: that of usual pairs.
    """
    made, level = plan.discretisation, plan.level
    if not isinstance(made, FaceDiscretisation):
        model = _CORRECTION * finite_width_excess(pair) if made.corrected else LEFT_OUT * left_out(pair, made)
        return ExpectedError(_PLANE[level], 0.0, model)
    helical = pair.base_helix_angle != 0.0
    known = ripple or (HELICAL_RIPPLE if helical else SPUR_RIPPLE)
    modified = any(gear.modification.varies_along_profile for gear in (pair.pinion, pair.wheel))
    part = ((_RELIEVED_RIPPLE if modified else _HELICAL_RIPPLE) if helical else _SPUR_RIPPLE)[level]
    mesh = max(_FACE_MEAN[level] * (1.0 + known.most), part / known.least)
    steps = (_HELICAL_SLICES if helical else _SPUR_SLICES) * (_SLICES / made.slices) ** _ORDER
    return ExpectedError(mesh, steps / known.least, 0.0)


def left_out(pair: ParallelAxes, made: Discretisation) -> float:
    """Return the relative part of the mean STE that a plane leaves out of a finite width; 0 if none.

    Plane strain deflects less than the gear, plane stress more. The plane that is corrected leaves nothing
    out, nor do three dimensions.
    """
    if isinstance(made, FaceDiscretisation) or made.corrected:
        return 0.0
    thin = made.hypothesis is PlaneHypothesis.PLANE_STRESS
    return plane_stress_excess(pair) if thin else finite_width_excess(pair)
