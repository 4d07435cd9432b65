"""Tolerance Monte Carlo at the boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from fe_contact.microgeometry import ToleranceStudy, iso1328_tolerances, scatter
from fe_contact.workers import Workers
from service.convert.ablation import in_um
from service.convert.case import analysis_arguments, boundary_errors, gear_pair
from service.convert.units import UM
from service.convert.vocabulary import boundary_name
from service.schemas import Case

Json = dict[str, Any]
_ACCURACY = ("tolerance", "level", "time_budget", "model", "effects")
_PLANE = ("plane_strain", "plane_stress")


@dataclass(frozen=True)
class Sampling:
    """Tolerances by their class, and how many pairs are drawn from them."""

    tolerance_class: int
    misalignment_um: float
    distribution: Literal["normal", "uniform"]
    samples: int
    seed: int


def scatter_of_case(
    case: Case,
    sampling: Sampling,
    cache: Path | None,
    report: Callable[[str, float], None],
    workers: Workers,
) -> ToleranceStudy:
    """Sample the pairs of a case; in a plane model helix slopes do not deviate.

    Raises
    ------
    BadInput
        No such pair or tolerance.
    JobFailed
        The case cannot be computed.
    """
    pair = gear_pair(case)
    load = case.load
    with boundary_errors():
        tolerances = iso1328_tolerances(
            pair,
            sampling.tolerance_class,
            misalignment=sampling.misalignment_um * UM,
            across_face=case.accuracy.model not in _PLANE,
            distribution=sampling.distribution,
        )
        torques = load.torque_n_m or [float(pair.torque(force)) for force in load.normal_force_n or ()]
        return scatter(
            pair,
            list(torques),
            tolerances,
            samples=sampling.samples,
            seed=sampling.seed,
            misalignment=case.errors.misalignment_um[0] * UM,
            **{name: analysis_arguments(case)[name] for name in _ACCURACY},
            workers=workers,
            progress=report,
            cache=cache,
        )


def scatter_json(found: ToleranceStudy) -> Json:
    """Return a study with lengths in um."""
    plain: Json = in_um(found.to_json())
    widths = found.asked["tolerances"]
    plain["asked"]["tolerances"] = {
        "misalignment_um": widths["misalignment_m"] / UM,
        **{boundary_name(name): width / UM for name, width in widths["modification_m"].items()},
        "distribution": widths["distribution"],
    }
    return plain | {"names": [boundary_name(name) for name in found.names]}
