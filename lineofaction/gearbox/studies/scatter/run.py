"""Tolerance Monte Carlo of a case."""

from __future__ import annotations

from bounds.types import Json
from fe_contact.microgeometry.tolerance_study import (
    Sampling,
    ToleranceRequest,
    ToleranceStudy,
    iso1328_tolerances,
    sampled,
)
from lineofaction.gearbox.convert.case import PLANE, CheckedCase, boundary_errors
from lineofaction.gearbox.convert.errors import boundary_name
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.computation import CaseStudy, Means, record_file
from lineofaction.gearbox.studies.scatter import Inputs, ScatterFigures
from lineofaction.gearbox.units import UM, in_um

MOST_SAMPLES = 100_000
"""Of a job: its result holds every pair, 10 to 100 MB."""


class _ScatterStudy(CaseStudy[Inputs, ScatterFigures, ToleranceStudy]):
    inputs, answer, file = Inputs, ScatterFigures, record_file(("tolerance study", ToleranceStudy))

    def check(self, case: CheckedCase, inputs: Inputs) -> None:
        with boundary_errors():
            _ = case.request(tolerance_request, inputs).checked

    def normalized(self, case: CheckedCase, inputs: Inputs) -> Json:
        """Return all inputs; refuse a sample too large for a job."""
        if inputs.samples > MOST_SAMPLES:
            advice = "For more use loa scatter."
            raise BadInput.of("samples", inputs.samples, f"at most {MOST_SAMPLES}", advice)
        return super().normalized(case, inputs)

    def compute(self, case: CheckedCase, inputs: Inputs, means: Means) -> ToleranceStudy:
        """Sample the pairs of a case; in a plane model helix slopes do not deviate."""
        with boundary_errors():
            run = means.analysis
            return sampled(case.request(tolerance_request, inputs), run)

    def _derived(self, study: ToleranceStudy) -> Json:
        widths = study.asked["tolerances"]
        tolerances = {
            "misalignment_um": widths["misalignment_m"] / UM,
            **{boundary_name(name): width / UM for name, width in widths["modification_m"].items()},
            "distribution": widths["distribution"],
        }
        return {
            "names": [boundary_name(name) for name in study.names],
            "asked": in_um(study.asked) | {"tolerances": tolerances},
        }


def tolerance_request(checked: CheckedCase, inputs: Inputs) -> ToleranceRequest:
    """Return the pair of a case with the tolerances of its class; none of helix slopes in the plane."""
    pair, case, load = checked.pair, checked.case, checked.case.load
    tolerances = iso1328_tolerances(
        pair,
        inputs.tolerance_class,
        misalignment=inputs.misalignment_um * UM,
        across_face=case.accuracy.model not in PLANE,
        distribution=inputs.distribution,
    )
    torques = load.torque_n_m or [float(pair.torque(force)) for force in load.normal_force_n or ()]
    sampling, misalignment = Sampling(inputs.samples, inputs.seed), case.errors.misalignment_um[0] * UM
    return ToleranceRequest(pair, list(torques), tolerances, sampling, checked.options, misalignment)


RUN = _ScatterStudy()
