"""Errors of the libraries in the words and units of the case and the scene."""

from __future__ import annotations

import math

import pytest

from bounds import (
    Bound,
    FieldName,
    Quantity,
    SiNote,
    Text,
    Words,
    above,
    at_least,
    at_most,
    below,
    exactly,
    from_to,
)
from dynamics.errors import InputError as DynamicsInputError
from dynamics.errors import SolveError as DynamicsSolveError
from fe_contact.errors import InputError, MeshError
from lineofaction.gearbox.convert.errors import translated
from lineofaction.gearbox.problems import BadInput, JobFailed

JAM = Text.of("Without backlash: ", FieldName("center_distance"), " = ", Quantity(0.0802, "m"), ".")
TOO_HIGH = InputError("pinion.modification.tip_relief", 2e-3, at_most(1e-3))


def test_advice_names_other_fields_as_its_reader_knows_them() -> None:
    error = InputError("center_distance", 0.08, at_least(0.0802, "m"), JAM)
    assert str(error).endswith("Without backlash: center_distance = 0.0802 m.")
    found = translated(error)
    assert isinstance(found, BadInput)
    assert found.faults[0].suggestion == "Without backlash: pair.center_distance_mm = 80.2 mm."


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (
            InputError("pinion.face_width", -0.025, above(0.0), SiNote("In m: 25 mm is 0.025.")),
            "pair.pinion.face_width_mm = -25.0: must be above 0",
        ),
        (InputError("wheel.helix_angle", 0.5236, "0 rad"), "pair.helix_angle_deg = "),
        (
            InputError("pinion.modification.tip_relief_length", 0.05, from_to(0.0, 0.00636)),
            "pair.pinion.tip_relief_length_mm = 50.0: must be from 0 to 6.36",
        ),
        (
            InputError(
                "pinion.material.youngs_modulus",
                0.0,
                above(0.0),
                Text.of("Steel is ", Quantity(2.1e11, "Pa"), "."),
            ),
            "pair.pinion.material.youngs_modulus_gpa = 0.0: must be above 0. Steel is 210 GPa.",
        ),
        (InputError("torques[2]", 1.0, above(2.0)), "load.torque_n_m[2] = 1.0: must be above 2"),
        (InputError("misalignments[1]", 3e-5, "0"), "errors.misalignment_um[1] = 30.0: must be 0"),
        (
            InputError("misalignments", [0.0, 3e-5], "[0.0] for a plane model"),
            "errors.misalignment_um = [0.0, 30.0]: must be [0.0]",
        ),
        (InputError("effects.magic", "on", "known"), "effects.magic = 'on': must be known"),
        (
            DynamicsInputError("bushings[0].radial_stiffness", -1.0, at_least(0.0)),
            "bushings[0].radial_stiffness_n_per_m = -1.0: must be at least 0",
        ),
        (
            DynamicsInputError("gears[1].bore_diameter", 0.09, below(0.08, "m", "the outer diameter")),
            "gears[1].bore_diameter_mm = 90.0: must be below the outer diameter 80 mm",
        ),
        (DynamicsInputError("duration", -1.0, at_least(0.0)), "run.duration_s = -1.0"),
        (
            DynamicsInputError("planets[0].angles[1]", math.pi, below(math.pi / 2.0, "rad")),
            "planets[0].angles_deg[1] = 180.0: must be below 90 deg",
        ),
        (
            InputError("variables (high)", {"pinion.tip_relief": 2e-3}, Text.of("bounds with ", TOO_HIGH)),
            "variables (high) = {'pinion.tip_relief_um': 2000.0}: must be bounds with "
            "pair.pinion.tip_relief_um = 2000.0: must be at most 1000",
        ),
        (
            DynamicsInputError("meshes[0].driven", Quantity(math.pi / 6.0, "rad"), "of the other hand"),
            "meshes[0].driven = '30 deg': must be of the other hand",
        ),
    ],
)
def test_errors_come_back_in_the_users_words_and_units(error: Exception, said: str) -> None:
    found = translated(error)
    assert isinstance(found, BadInput)
    assert str(found).startswith(said)


@pytest.mark.parametrize(
    ("bound", "shown"),
    [
        (from_to(0.01, 0.02), "from 10 to 20"),
        (above(0.0), "above 0"),
        (Bound(0.01, 0.02, high_open=True), "from 10 to below 20"),
        (Bound(0.01, 0.02, low_open=True, high_open=True), "above 10 and below 20"),
        (at_least(0.001), "at least 1"),
        (exactly(0.0305), "30.5"),
        (below(0.07, "m", "the root diameter"), "below the root diameter 70 mm"),
        (Text.of("larger: the tips cut ", Quantity(1.2e-5, "m"), " deep"), "larger: the tips cut 12 um deep"),
        (Text.of("at a place ", from_to(0.0, 0.02, "m")), "at a place from 0 mm to 20 mm"),
        ("smaller: the contact ratio is 0.93, below 1", "smaller: the contact ratio is 0.93, below 1"),
        ("a finite number", "a finite number"),
    ],
)
def test_numbers_of_a_bound_are_converted_by_what_they_are(bound: Words, shown: str) -> None:
    found = translated(InputError("center_distance", 0.08, bound))
    assert isinstance(found, BadInput)
    assert found.faults[0].bound == shown


def test_suggestions_never_explain_si_to_someone_who_does_not_use_it() -> None:
    found = translated(InputError("pinion.face_width", -0.025, above(0.0), SiNote("In m: 25 mm is 0.025.")))
    assert found is not None and "In m" not in str(found) and "Face width b, in mm" in str(found)


@pytest.mark.parametrize("error", [MeshError("no mesh"), DynamicsSolveError("no equilibrium")])
def test_failures_are_failures(error: Exception) -> None:
    assert isinstance(translated(error), JobFailed)


def test_what_the_libraries_do_not_raise_on_purpose_is_not_translated() -> None:
    assert translated(ZeroDivisionError("0")) is None
