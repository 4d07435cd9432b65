"""The light check of a case of loads alone refuses what the check of a request refuses."""

from __future__ import annotations

import math
from typing import Any

import pytest

from bounds import PlausibilityWarning
from fe_contact.compliance.flank import LARGEST_ROUNDING, _disc_rounding
from fe_contact.material import Material
from lineofaction.gearbox.convert.case import THICK, check_case, check_plain_case
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.gear import FlankPoint
from lineofaction.gearbox.schemas.reading import validated

MOST_LAYERS = 36


def case(
    face_width: float = 20.0, helix: float = 20.0, torque: float = 100.0, distance: float = 86.0
) -> Case:
    gear = {"teeth": 20, "face_width_mm": face_width, "bore_diameter_mm": 20.0}
    sizes = {"normal_module_mm": 4.0, "normal_pressure_angle_deg": 20.0, "helix_angle_deg": helix}
    pair: dict[str, Any] = sizes | {"center_distance_mm": distance, "pinion": gear, "wheel": gear}
    return validated(Case, {"pair": pair, "load": {"torque_n_m": [torque]}})


@pytest.mark.parametrize(
    "wrong",
    [case(face_width=0.01), case(face_width=0.05, helix=30.0, distance=93.0), case(distance=200.0)],
    ids=["thin", "thinner than its helix allows", "out of mesh"],
)
@pytest.mark.filterwarnings("ignore::bounds.PlausibilityWarning")
def test_both_refuse_with_one_error(wrong: Case) -> None:
    with pytest.raises(BadInput) as whole:
        check_case(wrong)
    with pytest.raises(BadInput) as light:
        check_plain_case(wrong)
    assert str(light.value) == str(whole.value)


def test_both_warn_of_the_same_and_return_the_pair() -> None:
    loaded = case(torque=1e5)
    with pytest.warns(PlausibilityWarning) as whole:
        pair = check_case(loaded)
    with pytest.warns(PlausibilityWarning) as light:
        assert check_plain_case(loaded) == pair
    assert [str(each.message) for each in light] == [str(each.message) for each in whole]


@pytest.mark.parametrize("helix", [0.0, 20.0, 50.0])
def test_a_disc_that_is_not_looked_at_is_far_from_the_limit(helix: float) -> None:
    """For every material up to a Poisson's ratio of 0.49."""
    soft = Material(210e9, 0.49)
    left = [
        _disc_rounding(THICK * share, math.radians(helix), MOST_LAYERS, soft) for share in (0.01, 0.1, 1.0)
    ]
    assert max(left) < 0.1 * LARGEST_ROUNDING


@pytest.mark.parametrize("torque", [5e-324, 1e-200, 0.9e-9, 1.1e9])
def test_a_load_is_neither_next_to_nothing_nor_beyond_all_gears(torque: float) -> None:
    """Squared, the smallest are zero: their plan was an unexpected failure."""
    with pytest.raises(BadInput, match=r"load\.torque_n_m"):
        case(torque=torque)
    assert case(torque=1e-9) and case(torque=1e9)


@pytest.mark.parametrize("point", [{"torque_n_m": 1e-152}, {"normal_force_n": 1e-152}])
def test_a_flank_is_looked_at_under_a_load_that_a_case_may_have(point: dict[str, float]) -> None:
    with pytest.raises(BadInput, match="from 1e-09 to 1e"):
        validated(FlankPoint, point)
