"""From what the caller asks for to a plan: the mesh is chosen by the models of error and cost."""

from __future__ import annotations

from functools import cache as remembered
from pathlib import Path

from fe_contact.contact import ContactModel
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.accuracy import Accuracy
from fe_contact.planning.cost_model import Prediction, predict_run
from fe_contact.planning.error_model import ExpectedError, expected_error
from fe_contact.planning.level_choice import LevelChoice, level_for_time, level_for_tolerance
from fe_contact.planning.plan import Plan, make_plan
from fe_contact.types import FloatArray


def planned(
    pair: ParallelAxes,
    load: FloatArray,
    accuracy: Accuracy,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    cache: Path | None = None,
) -> Plan:
    """Return the plan of a request: with the mesh that its accuracy asks for.

    Parameters are those of `chosen_level`.
    """
    return make_plan(
        pair, load, accuracy, model, chosen_level(pair, load, accuracy, model, alignments, cache).level
    )


def chosen_level(
    pair: ParallelAxes,
    load: FloatArray,
    accuracy: Accuracy,
    model: ContactModel,
    alignments: tuple[int, int] = (1, 1),
    cache: Path | None = None,
) -> LevelChoice:
    """Choose the mesh by the accuracy.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    load : ndarray
        Requested normal forces in N.
    accuracy : Accuracy
    model : ContactModel
    alignments : (int, int)
        Numbers of misalignments and of centre distances.
    cache : Path, optional
        Directory of compliances and of what is known of the host: a time depends on them.
    """

    @remembered
    def plan(level: str) -> Plan:
        return make_plan(pair, load, accuracy, model, level)

    def error(level: str) -> ExpectedError:
        return expected_error(pair, plan(level).discretisation, level)

    def cost(level: str) -> Prediction:
        return predict_run(pair, plan(level), model, alignments, cache)

    if accuracy.level is not None:
        return LevelChoice(accuracy.level, True, "as asked")
    if accuracy.tolerance is not None:
        return level_for_tolerance(accuracy.tolerance, error)
    if accuracy.time_budget is not None:
        return level_for_time(accuracy.time_budget, lambda level: cost(level).cpu_seconds)
    return LevelChoice("standard", True, "nothing asked")
