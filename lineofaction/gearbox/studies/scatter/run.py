"""Tolerance Monte Carlo of a case."""

from __future__ import annotations

from typing import Any

from fe_contact.microgeometry.tolerance_study import (
    Sampling,
    ToleranceStudy,
    iso1328_tolerances,
    scatter,
    toleranced,
)
from fe_contact.options import Run
from lineofaction.gearbox.convert.case import analysis_options, boundary_errors, gear_pair
from lineofaction.gearbox.convert.errors import boundary_name
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.studies.computation import Computation, Means, with_defaults
from lineofaction.gearbox.studies.result_file import record_file
from lineofaction.gearbox.studies.scatter import Inputs
from lineofaction.gearbox.units import UM, in_um

Json = dict[str, Any]
MOST_SAMPLES = 100_000
"""Of a job: its result holds every pair, 10 to 100 MB."""
_PLANE = ("plane_strain", "plane_stress")


def draw(case: Case, inputs: Inputs, means: Means) -> ToleranceStudy:
    """Sample the pairs of a case; in a plane model helix slopes do not deviate.

    Raises
    ------
    BadInput
        No such pair or tolerance.
    JobFailed
        The case cannot be computed.
    """
    with boundary_errors():
        run = Run(means.workers, means.home / "compliance", means.report)
        return scatter(**_drawn(case, inputs), run=run)


def check(case: Case, inputs: Inputs) -> None:
    """Raise `BadInput` for what `draw` would."""
    with boundary_errors():
        drawn = _drawn(case, inputs)
        torques = drawn.pop("torques")
        toleranced(**drawn).check(torques)


def normalized(_case: Case, inputs: Inputs) -> Json:
    """Return all inputs; refuse a sample too large for a job."""
    if inputs.samples > MOST_SAMPLES:
        raise BadInput.of("samples", inputs.samples, f"at most {MOST_SAMPLES}", "For more use loa scatter.")
    return with_defaults(inputs)


def _drawn(case: Case, inputs: Inputs) -> Json:
    pair, load = gear_pair(case), case.load
    tolerances = iso1328_tolerances(
        pair,
        inputs.tolerance_class,
        misalignment=inputs.misalignment_um * UM,
        across_face=case.accuracy.model not in _PLANE,
        distribution=inputs.distribution,
    )
    torques = load.torque_n_m or [float(pair.torque(force)) for force in load.normal_force_n or ()]
    return {
        "pair": pair,
        "torques": list(torques),
        "tolerances": tolerances,
        "sampling": Sampling(inputs.samples, inputs.seed),
        "options": analysis_options(case),
        "misalignment": case.errors.misalignment_um[0] * UM,
    }


def facts(study: ToleranceStudy) -> Json:
    """Return a study with lengths in um."""
    plain: Json = in_um(study.to_json())
    widths = study.asked["tolerances"]
    plain["asked"]["tolerances"] = {
        "misalignment_um": widths["misalignment_m"] / UM,
        **{boundary_name(name): width / UM for name, width in widths["modification_m"].items()},
        "distribution": widths["distribution"],
    }
    return plain | {"names": [boundary_name(name) for name in study.names]}


RUN = Computation(
    draw,
    facts,
    record_file(("tolerance study", ToleranceStudy)),
    check=check,
    normalized=normalized,
)
