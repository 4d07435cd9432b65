"""Gears drawn within a class are within it, and service and client state what `loa measured` does."""

import pickle

import numpy as np
import pytest

from bounds.types import Json
from fe_contact.geometry import flank_tolerances as of_class
from lineofaction.gearbox.convert.case import case_json, gear_pair
from lineofaction.gearbox.inspection.as_made import Inspected, drawn_case, measured_case
from lineofaction.gearbox.inspection.measured_gear import inspected
from lineofaction.gearbox.inspection.sheet import sheet_text
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas import Case, validated

ROUNDING = 2e-9  # m: fields are written to a nanometer


def helical(pinion: int = 23, wheel: int = 67, angle: float = 20.0) -> Case:
    gear = {"face_width_mm": 20.0, "bore_diameter_mm": 12.0}
    pair: Json = {
        "normal_module_mm": 2.0,
        "helix_angle_deg": angle,
        "center_distance_mm": 97.0 if angle else 90.0,
    }
    pair |= {"pinion": gear | {"teeth": pinion}, "wheel": gear | {"teeth": wheel}}
    return validated(Case, {"pair": pair, "load": {"torque_n_m": [50.0]}})


@pytest.mark.law
@pytest.mark.parametrize("tolerance_class", [1, 6, 11])
@pytest.mark.parametrize("seed", range(4))
def test_drawn_gears_are_within_their_class(tolerance_class, seed):
    pair = gear_pair(drawn_case(helical(), tolerance_class, seed))
    for gear in (pair.pinion, pair.wheel):
        turn = 2.0 * np.pi * np.arange(gear.teeth) / gear.teeth
        places = np.array(gear.pitch_deviation.cumulative) + gear.run_out.excess(
            turn, np.zeros(gear.teeth)
        ) / np.cos(gear.transverse_pressure_angle)
        steps = np.diff(places, append=places[0])
        limits = {
            of_class.cumulative_pitch_tolerance: np.ptp(places),
            of_class.single_pitch_tolerance: np.abs(steps).max(),
            of_class.run_out_tolerance: 2.0 * gear.run_out.eccentricity,
            of_class.profile_slope_tolerance: max(abs(flank.profile_slope) for flank in gear.tooth_flanks),
            of_class.profile_form_tolerance: max(abs(flank.profile_form) for flank in gear.tooth_flanks),
            of_class.helix_slope_tolerance: max(abs(flank.helix_slope) for flank in gear.tooth_flanks),
            of_class.helix_form_tolerance: max(abs(flank.helix_form) for flank in gear.tooth_flanks),
        }
        for tolerance, value in limits.items():
            assert 0.0 < value <= tolerance(gear, tolerance_class) + ROUNDING, tolerance.__name__


def test_equal_seeds_draw_equal_gears_and_a_spur_pair_stays_plane():
    first, again, other = (drawn_case(helical(angle=0.0), 6, seed) for seed in (1, 1, 2))
    assert first == again != other
    assert all(flank.helix_slope == 0.0 for flank in gear_pair(first).pinion.tooth_flanks)
    assert first.pair.pinion.pitch_deviation_um != first.pair.wheel.pitch_deviation_um


def test_a_gear_beyond_the_standard_is_refused_by_its_field():
    with pytest.raises(BadInput) as caught:
        drawn_case(helical(4, 86), 6)
    assert "teeth" in str(caught.value)


def test_what_a_drawn_gear_measures_is_what_was_drawn():
    drawn = drawn_case(helical(), 6)
    of = Inspected("wheel", "left", None)
    again, found = measured_case(helical(), sheet_text(inspected(of.chart(drawn))), "wheel.csv", of)
    assert found.omitted == []
    assert again.pair.wheel.pitch_deviation_um == pytest.approx(drawn.pair.wheel.pitch_deviation_um, abs=1e-4)
    slopes, measured = (
        [1e6 * flank.profile_slope for flank in gear_pair(case).wheel.tooth_flanks] for case in (drawn, again)
    )
    assert measured == pytest.approx(slopes, abs=0.05)


def test_measured_pitches_replace_those_of_either_kind():
    content = case_json(helical())
    content["pair"]["pinion"]["single_pitch_deviation_um"] = [0.0] * 23
    rows = "\n".join(f"{tooth},right,pitch,{tooth % 2}" for tooth in range(1, 24))
    text = f"tooth,flank,trace,deviation_um\n{rows}\n"
    made, _ = measured_case(validated(Case, content), text, "p.csv", Inspected("pinion", "right", None))
    assert len(made.pair.pinion.pitch_deviation_um) == 23
    assert made.pair.pinion.single_pitch_deviation_um == ()


def test_a_drawn_case_is_pickled_with_its_parts():
    """Workers of a cluster get cases by pickle."""
    made = drawn_case(helical(), 6, 1)
    assert pickle.loads(pickle.dumps(made)) == made
