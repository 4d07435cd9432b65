"""Tolerance Monte Carlo at the boundary."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from fe_contact.microgeometry import Sampling as Sample
from fe_contact.microgeometry import ToleranceStudy, iso1328_tolerances, scatter
from fe_contact.microgeometry.tolerance_study import toleranced
from fe_contact.options import Run
from fe_contact.workers import Workers
from service.convert.ablation import in_um
from service.convert.case import analysis_options, boundary_errors, gear_pair
from service.convert.vocabulary import boundary_name
from service.schemas import Case
from service.schemas.sampling import SamplingInput
from service.units import UM

Json = dict[str, Any]
_PLANE = ("plane_strain", "plane_stress")


@dataclass(frozen=True)
class Sampling:
    """Tolerances by their class, and how many pairs are drawn from them."""

    tolerance_class: int
    misalignment_um: float
    distribution: Literal["normal", "uniform"]
    samples: int
    seed: int


def sampling_of(given: SamplingInput) -> Sampling:
    """Return what a request asks for."""
    return Sampling(
        given.tolerance_class, given.misalignment_um, given.distribution, given.samples, given.seed
    )


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
    with boundary_errors():
        return scatter(**_drawn(case, sampling), run=Run(workers, cache, report))


def check_scatter_of(case: Case, sampling: Sampling) -> None:
    """Raise `BadInput` for what `scatter_of_case` would, without computing anything."""
    with boundary_errors():
        drawn = _drawn(case, sampling)
        torques = drawn.pop("torques")
        toleranced(**drawn).check(torques)


def _drawn(case: Case, sampling: Sampling) -> Json:
    """Return what is drawn from what, in SI."""
    pair, load = gear_pair(case), case.load
    tolerances = iso1328_tolerances(
        pair,
        sampling.tolerance_class,
        misalignment=sampling.misalignment_um * UM,
        across_face=case.accuracy.model not in _PLANE,
        distribution=sampling.distribution,
    )
    torques = load.torque_n_m or [float(pair.torque(force)) for force in load.normal_force_n or ()]
    return {
        "pair": pair,
        "torques": list(torques),
        "tolerances": tolerances,
        "sampling": Sample(sampling.samples, sampling.seed),
        "options": analysis_options(case),
        "misalignment": case.errors.misalignment_um[0] * UM,
    }


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
