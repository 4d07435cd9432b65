"""Forty odd inputs that can be computed, are: a sound table each. Infeasible ones are in tests/contract."""

import math
from dataclasses import dataclass, field
from typing import Any

import pytest
from bad_inputs import BAD_INPUTS
from random_cases import assessed

from fe_contact import FlankModification, Gear, GearPair, Material, PitchDeviation, analyze
from fe_contact.errors import InputError

MM, UM, DEG = 1e-3, 1e-6, math.pi / 180.0
Fields = dict[str, Any]


@dataclass(frozen=True)
class Odd:
    """What makes the nominal pair odd: fields of the pinion, the wheel, both, the pair and the call."""

    name: str
    pinion: Fields = field(default_factory=dict)
    wheel: Fields = field(default_factory=dict)
    both: Fields = field(default_factory=dict)
    distance: float | None = None
    offset: float = 0.0
    call: Fields = field(default_factory=dict)

    def pair(self) -> GearPair:
        nominal = {"teeth": 20, "normal_module": 4 * MM, "face_width": 25 * MM, "bore_diameter": 40 * MM}
        first, second = (Gear(**(nominal | self.both | one)) for one in (self.pinion, self.wheel))
        return GearPair(first, second, self.distance, axial_offset=self.offset)

    def arguments(self) -> Fields:
        usual = {"torques": [1.0, 100.0], "level": "draft", "positions": 16, "receipt": "minimal"}
        loads = {"torques": None} if "normal_forces" in self.call else {}
        return usual | {"model": "plane_strain"} | loads | self.call


def relieved(**lengths: float) -> Fields:
    return {"modification": FlankModification(**lengths)}


TALL = {"addendum_coefficient": 1.25, "dedendum_coefficient": 1.5, "root_radius_coefficient": 0.1}
ODD = (
    Odd("bore of a hundredth of the root circle", both={"bore_diameter": 0.7 * MM}),
    Odd("bore next to the roots", both={"bore_diameter": 69 * MM}),
    Odd("unlike bores", pinion={"bore_diameter": 5 * MM}, wheel={"bore_diameter": 68 * MM}),
    Odd("face of a micrometer", both={"face_width": 1 * UM}, call={"torques": [1e-5, 1e-3]}),
    Odd("face of ten meters", both={"face_width": 10.0}, call={"torques": [100.0, 4e4]}),
    Odd("unlike faces", pinion={"face_width": 5 * MM}),
    Odd("faces that overlap by a tenth", offset=22.5 * MM),
    Odd(
        "seven teeth on thirty",
        pinion={
            "teeth": 7,
            "profile_shift_coefficient": 0.5,
            "bore_diameter": 5 * MM,
            "tip_diameter": 37 * MM,
        },
        wheel={"teeth": 30, "tip_diameter": 127.4 * MM},
    ),
    Odd(
        "ten teeth on sixty",
        pinion={"teeth": 10, "profile_shift_coefficient": 0.5, "bore_diameter": 10 * MM},
        wheel={"teeth": 60},
    ),
    Odd("three hundred teeth", wheel={"teeth": 300, "bore_diameter": 1.1}),
    Odd("tooth counts without a common divisor", pinion={"teeth": 23}, wheel={"teeth": 37}),
    Odd(
        "negative shifts that cancel",
        pinion={"profile_shift_coefficient": 0.4},
        wheel={"profile_shift_coefficient": -0.4, "teeth": 40},
    ),
    Odd("tall teeth", both=TALL | {"teeth": 60}),
    Odd("stub teeth", both={"addendum_coefficient": 0.7, "dedendum_coefficient": 0.95}),
    Odd("sharp root of the tool", both={"root_radius_coefficient": 0.0}),
    Odd("full fillet", both={"root_radius_coefficient": 0.38, "dedendum_coefficient": 1.36}),
    Odd("deep roots", both={"dedendum_coefficient": 1.7, "root_radius_coefficient": 0.1}),
    Odd("pressure angle of ten degrees", both={"normal_pressure_angle": 10 * DEG, "teeth": 90}),
    Odd(
        "pressure angle of 30 degrees",
        both={
            "normal_pressure_angle": 30 * DEG,
            "root_radius_coefficient": 0.1,
            "addendum_coefficient": 0.8,
            "dedendum_coefficient": 1.0,
        },
    ),
    Odd("no backlash at all", distance=80 * MM),
    Odd("centers half a millimeter apart", distance=80.5 * MM),
    Odd("allowance of a tenth of the module", both={"thickness_allowance": 0.4 * MM}),
    Odd(
        "module of ten micrometers",
        both={"normal_module": 10 * UM, "face_width": 60 * UM, "bore_diameter": 0.1 * MM},
        call={"normal_forces": [1e-6, 1e-3]},
    ),
    Odd(
        "module of a meter",
        both={"normal_module": 1.0, "face_width": 6.0, "bore_diameter": 10.0},
        call={"normal_forces": [1e5, 1e8]},
    ),
    Odd("rubber", both={"material": Material(5e6, 0.49)}, call={"torques": [1e-4, 1e-2]}),
    Odd("diamond", both={"material": Material(1.1e12, 0.07)}),
    Odd("cork: no lateral strain", both={"material": Material(30e6, 0.0)}, call={"torques": [1e-3, 1e-2]}),
    Odd("steel on rubber", wheel={"material": Material(5e6, 0.49)}, call={"torques": [1e-4, 1e-2]}),
    Odd(
        "a pinion four times as wide as the wheel",
        pinion={"teeth": 23, "profile_shift_coefficient": 0.14, "face_width": 40 * MM},
        wheel={
            "teeth": 11,
            "profile_shift_coefficient": 0.25,
            "face_width": 10.8 * MM,
            "bore_diameter": 20.7 * MM,
        },
        call={"model": "3d", "positions": 32},
    ),
    Odd(
        "a face of two modules, steep, misaligned and overloaded",
        pinion={"helix_angle": 0.647},
        wheel={"helix_angle": -0.647},
        both={
            "teeth": 51,
            "normal_module": 3.03 * MM,
            "face_width": 5.86 * MM,
            "bore_diameter": 29.4 * MM,
            "profile_shift_coefficient": 0.065,
        },
        call={"model": "3d", "normal_forces": [1.0, 4400.0], "misalignments": [0.0, 51 * UM]},
    ),
    Odd("one load", call={"torques": [100.0]}),
    Odd("twenty loads within a per mille", call={"torques": [100.0 + 0.005 * i for i in range(20)]}),
    Odd("load of a micronewton", call={"normal_forces": [1e-6]}),
    Odd("relief of a nanometer", both=relieved(tip_relief=1e-9, tip_relief_length=1 * MM)),
    Odd("relief of a millimeter", both=relieved(tip_relief=1 * MM, tip_relief_length=1 * MM)),
    Odd("relief all down the flank", both=relieved(tip_relief=50 * UM, tip_relief_length=6 * MM)),
    Odd(
        "relief over a hundredth of a millimeter",
        both=relieved(tip_relief=20 * UM, tip_relief_length=0.01 * MM),
    ),
    Odd("crowning of 0.1 mm", both=relieved(profile_crowning=100 * UM)),
    Odd("slope of 0.1 mm", both=relieved(profile_slope=-100 * UM)),
    Odd("root relief alone", both=relieved(root_relief=30 * UM, root_relief_length=0.5 * MM)),
    Odd(
        "pitch deviations of half a millimeter",
        pinion={"pitch_deviation": PitchDeviation((0.5 * MM, -0.5 * MM) * 10)},
        call={"pitches": 2},
    ),
    Odd("positions of a fixed count of eight", call={"positions": 8}),
    Odd("distances that change by a hair", call={"center_distance_changes": [0.0, 1e-9]}),
    Odd("distances a fifth of a module apart", call={"center_distance_changes": [0.0, 0.8 * MM]}),
)


SLOW_TO_CONVERGE = "a face of two modules, steep, misaligned and overloaded"
"""64 iterations, of 40 allowed, at one point: its axes tilt, and 4.4 kN start from the forces at 1 N."""


def judged(odd: Odd) -> Any:
    open_defect = pytest.mark.xfail(reason="64 iterations of 40 allowed")
    return pytest.param(odd, id=odd.name, marks=[open_defect] if odd.name == SLOW_TO_CONVERGE else [])


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("odd", [judged(odd) for odd in ODD])
def test_what_is_odd_but_feasible_is_computed(odd):
    figures = assessed(odd.pair(), odd.arguments())
    assert all(f.passed for f in figures if f.name != "CPU time, s"), [
        str(f) for f in figures if not f.passed
    ]


def test_there_are_forty_of_either():
    assert len({odd.name for odd in ODD}) >= 40
    assert len({bad.name for bad in BAD_INPUTS}) >= 40


def test_a_helical_disc_that_bends_as_a_plate_is_refused():
    disc = {"teeth": 40, "normal_module": 2 * MM, "face_width": 0.3 * MM, "bore_diameter": 20 * MM}
    sides = [Gear(helix_angle=angle * DEG, **disc) for angle in (25.0, -25.0)]
    with pytest.raises(InputError, match=r"pinion.face_width = 0.0003: must be at least 0.000\d+ m"):
        analyze(GearPair(*sides), torques=[0.01])
