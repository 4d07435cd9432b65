"""Questions to studies in other words: what is one result of the service, and what is another.

That defaults written out change nothing is in test_contract_of_studies.py.
"""

import copy
from typing import Any

import pytest
from study_service import CASE, prepared

from fe_contact.analysis.studies.frontier import FIDELITIES
from fe_contact.effects import EFFECTS
from service.worker.process import default_registry

ONLY = ["tooth_coupling", "misalignment"]
CLOSED = ["iso6336", "thin_slices"]
FREE = {"tip_relief_um": [0.0, 40.0], "tip_relief_length_mm": [0.5, 3.0]}
SEARCH: dict[str, Any] = {"variables": {"pinion": FREE, "wheel": FREE}, "search": {"evaluations": 24}}


def asked(process: str, case: dict[str, Any] = CASE, **further: Any) -> dict[str, Any]:
    """Return what a process makes of a case and its inputs."""
    return prepared(default_registry()[process], case=case, **further)


def key(process: str, case: dict[str, Any] = CASE, **further: Any) -> str:
    return default_registry()[process].key(asked(process, case, **further))


@pytest.mark.parametrize(
    ("process", "field", "everything", "few"),
    [
        ("ablate", "only", [effect.name for effect in EFFECTS], ONLY),
        ("frontier", "rungs", [rung.name for rung in FIDELITIES], CLOSED),
    ],
)
def test_all_by_name_in_any_order_are_the_default(process, field, everything, few):
    named = ([], everything, [*everything[::-1], *few], few)
    keys = [key(process, **({field: names} if names else {})) for names in named]
    assert keys[0] == keys[1] == keys[2] != keys[3]
    assert keys[3] == key(process, **{field: few[::-1]})


def test_full_contact_beside_a_ladder_is_another_question():
    assert key("frontier", full_contact=1) != key("frontier")


def test_up_to_a_fidelity_is_all_before_it_in_the_order_of_cost():
    names = [fidelity.name for fidelity in FIDELITIES]
    for last in ("corrected_fine", "3d_draft", "3d_fine"):
        assert asked("frontier", up_to=last)["rungs"] == names[: names.index(last) + 1]
    assert asked("frontier", up_to="3d_draft", rungs=["3d_fine", *CLOSED])["rungs"] == CLOSED


def test_every_input_of_a_scatter_is_another_question():
    plain = key("scatter")
    others = (
        *({"tolerance_class": 7}, {"distribution": "uniform"}, {"samples": 999}, {"seed": 1}, {"exact": 200}),
        *({"finishing": "honing"}, {"drawing": ["pinion.profile_slope_um=4"]}, {"limit": "1=0.5um"}),
    )
    for other in others:
        assert key("scatter", **other) != plain
    assert key("scatter", tolerance_class=6, samples=1000) == plain


def test_another_objective_is_another_optimization():
    plain = key("optimize", **SEARCH)
    assert plain == key("optimize", **SEARCH, misalignment_um=0.0, objective={"kind": "weighted_mean"})
    assert plain != key("optimize", **SEARCH, objective={"kind": "worst"})


@pytest.mark.parametrize(("model", "crowned"), [("plane_strain", False), ("3d", True)])
def test_without_variables_the_tip_relief_of_both_gears_is_free(model, crowned):
    case = CASE | {"accuracy": CASE["accuracy"] | {"model": model}}
    variables = asked("optimize", case, variables={"most_tip_relief_um": 25.0})["variables"]
    free = {gear: {k: v for k, v in variables[gear].items() if v is not None} for gear in ("pinion", "wheel")}
    relief = {"tip_relief_um": [0.0, 25.0], "tip_relief_length_mm": pytest.approx([0.6, 3.2])}
    assert free["wheel"] == relief
    assert free["pinion"] == relief | ({"helix_crowning_um": [0.0, 30.0]} if crowned else {})


def test_flanks_at_a_point_do_not_hang_on_other_loads_and_positions():
    """The case of the point is what is hashed."""
    other = copy.deepcopy(CASE) | {"load": {"torque_n_m": [40.0]}}
    other["accuracy"]["positions"] = 8
    assert key("flank") == key("flank", other, torque_n_m=40.0) != key("flank", other, torque_n_m=41.0)


def test_a_sensitivity_across_the_face_takes_a_case_of_the_plane_there():
    automatic = CASE | {"accuracy": {"level": "draft", "positions": 8}}
    assert asked("sensitivity")["case"]["accuracy"]["model"] == "3d"
    assert asked("sensitivity", automatic)["case"]["accuracy"]["model"] == "auto"
