"""Values that make no object are refused by the name of their field, impossible gears by what is wrong.

Declared bounds are those of tests/contract/test_declared_bounds.py, the slips of a case are in
test_bad_input.py beside it.
"""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from analysis_requests import design_request, point_request
from spur_gears import GEAR, PAIR, gear, make_gear, make_ring

from fe_contact import (
    FlankModification,
    GearBlank,
    GearPair,
    PitchDeviation,
    Shaft,
    analyze,
    flank_results,
    optimize,
    root_stress,
    scatter,
)
from fe_contact.allowed_error import AllowedError
from fe_contact.errors import InfeasibleGeometry, InputError
from fe_contact.geometry import BasicRack, BoreSeat, FlankGrid, InternalGearPair, Key
from fe_contact.mesh import MeshRecipe, SectorRecipe
from fe_contact.microgeometry.design_loads import DesignLoads
from fe_contact.microgeometry.objective import WeightedMean
from fe_contact.microgeometry.scatter import GaussHermite, Scatter, SobolSample
from fe_contact.microgeometry.search import Search
from fe_contact.microgeometry.tolerance_study import Sampling
from fe_contact.microgeometry.tolerances import Tolerances
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import AnalysisOptions, OperatingPoint

NAN = math.nan
SHIFT = "profile_shift_coefficient"
LONG, CROWNING = FlankModification(tip_relief=1e-6, tip_relief_length=9e-3), "wheel.profile_crowning"
ZEROS = ((0.0, 0.0), (0.0, 0.0))
PLANE: dict[str, Any] = {"level": "draft", "model": "plane_strain"}
RELIEF, LENGTH, SLOPE = "pinion.tip_relief", "pinion.tip_relief_length", "pinion.profile_slope"
FREE = (DesignVariable(RELIEF, 0.0, 60e-6), DesignVariable(LENGTH, 0.5e-3, 3e-3))
BLANK = GearBlank(rim_thickness=12e-3, web_thickness=10e-3, hub_diameter=60e-3, web_offset=3e-3)
WIDE = gear(40, face_width=40e-3)


def rack(**fields: Any) -> object:
    return BasicRack(**({"normal_module": 4e-3} | fields))


def relieved(**fields: Any) -> object:
    return make_gear(modification=FlankModification(**fields))


def on_grid(roll: Any, face: Any) -> object:
    return relieved(flank_grid=FlankGrid(roll, face, ((1e-6, 0.0), (0.0, 0.0))))


def recipe(**fields: Any) -> object:
    return replace(MeshRecipe.standard(GEAR), **fields)


def sector(**fields: Any) -> object:
    return replace(SectorRecipe.draft(GEAR), **fields)


def table(**options: Any) -> object:
    return analyze(PAIR, **({"torques": [20.0, 100.0], "level": "draft", "positions": 32} | options))


def flank(at: Any = None, **options: Any) -> object:
    options = {"normal_force": 2000.0, "model": "3d", "level": "draft"} | options
    return flank_results(PAIR, *point_request(**options), at=at)


def root(point: OperatingPoint, at: Any = None) -> object:
    return root_stress(PAIR, point, at=at)


def designs(**options: Any) -> object:
    return optimize(design_request(PAIR, **({"torques": [200.0], "variables": FREE} | PLANE | options)))


def samples(tolerances: Tolerances | None = None, effects: Any = None, **sampling: Any) -> object:
    options = AnalysisOptions(**PLANE, effects=effects or {})
    return scatter(PAIR, [100.0], tolerances or Tolerances(0.0, {SLOPE: 1e-5}), Sampling(**sampling), options)


Row = tuple[Callable[..., object], Any, str]
ROWS: list[Row] = [
    (make_ring, {"cutter_teeth": 60}, "cutter_teeth"),
    (FlankModification, {"root_relief": 2e-5}, "root_relief_length"),
    (FlankModification, {"end_relief": 2e-5}, "end_relief_length"),
    (FlankModification, {"end_relief_datum_face": 1e-6}, "end_relief_datum_face_length"),
    (FlankModification, {"profile_crowning_tip": 1e-6}, "profile_crowning_tip_length"),
    (FlankModification, {"triangular_root_relief": 1e-6}, "triangular_root_relief_length"),
    (relieved, {"root_relief": 1e-5, "root_relief_length": 9e-3}, "modification.root_relief_length"),
    (relieved, {"end_relief": 1e-5, "end_relief_length": 0.0126}, "modification.end_relief_length"),
    (
        relieved,
        {"end_relief_datum_face": 1e-6, "end_relief_datum_face_length": 26e-3},
        "modification.end_relief_datum_face_length",
    ),
    (
        relieved,
        {"profile_crowning_root": 1e-6, "profile_crowning_root_length": 12e-3},
        "modification.profile_crowning_root_length",
    ),
    (  # a spur gear has no corner which lines of contact reach first
        relieved,
        {"triangular_tip_relief": 1e-6, "triangular_tip_relief_length": 1e-3},
        "modification.triangular_tip_relief",
    ),
    (make_ring, {"modification": LONG}, "modification.tip_relief_length"),
    (on_grid, [(4.0, 19.0), (-1e-3, 1e-3)], "modification.flank_grid.roll_length"),
    (on_grid, [(4e-3, 19e-3), (20e-3, 45e-3)], "modification.flank_grid.face_position"),
    (FlankGrid, [(5e-3, 4e-3), (0.0, 1e-3), ZEROS], "roll_length"),
    (FlankGrid, [(4e-3, 5e-3), (0.0, 0.0), ZEROS], "face_position"),
    (FlankGrid, [(4e-3, NAN), (0.0, 1e-3), ZEROS], "roll_length"),
    (FlankGrid, [(4e-3,), (0.0, 1e-3), ZEROS[:1]], "roll_length"),
    (FlankGrid, [(4e-3, 5e-3), (0.0, 1e-3), ZEROS[:1]], "removed"),
    (FlankGrid, [(4e-3, 5e-3), (0.0, 1e-3), (ZEROS[0], (0.0,))], "removed[1]"),
    (FlankGrid, [(4e-3, 5e-3), (0.0, 1e-3), (ZEROS[0], (0.0, NAN))], "removed[1][1]"),
    (FlankGrid, [(4e-3, 5e-3), (0.0, 1e-3), ((0.0, 5.0), ZEROS[0])], "removed[0][1]"),
    (PitchDeviation, [(0.0, NAN)], "pitch_deviation[1]"),
    (PitchDeviation, [(0.0, 5.0)], "pitch_deviation[1]"),
    (PitchDeviation, [("5",)], "pitch_deviation[0]"),
    *[(make_gear, {"pitch_deviation": PitchDeviation((1e-6,) * n)}, "pitch_deviation") for n in (1, 19, 21)],
    (BoreSeat, {"key": Key(1e-3)}, "tangential_foundation"),
    (Shaft, [0.2, 0.04, 0.41, 4e8], "position"),
    (recipe, {"flank_size": 0.0}, "flank_size"),
    (recipe, {"tip_size": -1e-5}, "tip_size"),
    (recipe, {"tip_size": 1.0}, "tip_size"),
    (recipe, {"body_size": NAN}, "body_size"),
    (recipe, {"growth": 2.0}, "growth"),
    (recipe, {"real_teeth": 4}, "real_teeth"),
    (recipe, {"real_teeth": 0}, "real_teeth"),
    (sector, {"flank_size": 0.0}, "flank_size"),
    (sector, {"tip_size": 2e-3}, "tip_size"),
    (sector, {"layers": 7}, "layers"),
    (sector, {"layers": 10, "merge_rows": (-1, -2)}, "layers"),
    (sector, {"merge_rows": (0,)}, "merge_rows"),
    (sector, {"merge_rows": (-2, -2), "layers": 8}, "merge_rows"),
    (sector, {"half_face": True}, "merge_rows"),
    (sector, {"split": 1.0}, "split"),
    (sector, {"layer_growth": 0.5}, "layer_growth"),
    (sector, {"body_growth": 0.0}, "body_growth"),
    (sector, {"land_elements": 0}, "land_elements"),
    (AllowedError, [0.0], "tolerance"),
    (AllowedError, [0.6], "tolerance"),
    (AllowedError, [0.01, -1e-9], "tolerance_floor"),
    (table, {"torques": [NAN]}, "torques"),
    (table, {"positions": 3}, "positions"),
    (table, {"positions": 6.5}, "positions"),
    (table, {"misalignments": [30.0]}, "misalignments[0]"),
    (table, {"center_distance_changes": [1e-5, 0.0]}, "center_distance_changes"),
    (table, {"on_violation": "shrug"}, "on_violation"),
    (flank, {"torque": 100.0}, "torques"),
    (flank, {"normal_force": -1.0}, "normal_forces[0]"),
    (flank, {"misalignment": 20.0}, "misalignments[0]"),
    (flank, {"at": []}, "at"),
    (flank, {"at": [0.0, NAN]}, "at[1]"),
    (root, [OperatingPoint()], "torques"),
    (root, [OperatingPoint(torque=10.0), [[0.1]]], "at"),
    (Scatter, [-1e-6], "scatter.misalignment"),
    (Scatter, [0.0, {"pinion.depth": 1e-6}], "scatter.modification.pinion.depth"),
    (Scatter, [0.0, {SLOPE: 0.0}], f"scatter.modification.{SLOPE}"),
    (GaussHermite, [0], "scatter.rule.points"),
    (Scatter(1e-6, {SLOPE: 1e-6, CROWNING: 1e-6}, GaussHermite(33)).nodes, [], "scatter.rule.points"),
    (SobolSample, [11], "scatter.rule.log2_size"),
    (DesignLoads.of, [[], 0.0], "torques"),
    (DesignLoads.of, [[100.0, NAN], 0.0], "torques[1]"),
    (DesignLoads.of, [[200.0, 100.0], [0.0, 1e-6]], "torques"),
    (DesignLoads.of, [[100.0, 100.0], 0.0], "torques"),
    (DesignLoads.of, [[100.0, 100.0], [1e-6, 1e-6]], "torques"),
    (DesignLoads.of, [[100.0, 200.0], [0.0, 1e-6, 2e-6]], "misalignment"),
    (DesignLoads.of, [[100.0, 200.0], []], "misalignment"),
    (DesignLoads.of, [[100.0, 200.0], [0.0, 0.02]], "misalignment[1]"),
    (DesignLoads.of, [[100.0, 200.0], [0.0, "1"]], "misalignment[1]"),
    (DesignLoads.of, [[100.0, 200.0], 0.02], "misalignment"),
    (DesignVariable, ["pinion.color", 0.0, 1e-5], "variables.pinion.color"),
    (DesignVariable, ["sun.tip_relief", 0.0, 1e-5], "variables.sun.tip_relief"),
    (DesignVariable, [RELIEF, -1e-6, 1e-5], f"variables.{RELIEF}.low"),
    (DesignVariable, [RELIEF, 1e-5, 1e-5], f"variables.{RELIEF}.high"),
    (DesignVariable, [LENGTH, 0.0, 1e-3], f"variables.{LENGTH}.low"),
    (DesignVariable, [RELIEF, 0.0, NAN], f"variables.{RELIEF}.high"),
    (Search, {"exploration": 4}, "search.exploration"),
    (designs, {"variables": []}, "variables"),
    (designs, {"variables": [FREE[0]]}, "variables.pinion.tip_relief"),  # no length
    (designs, {"variables": [*FREE, FREE[0]]}, "variables"),
    (designs, {"variables": [DesignVariable(LENGTH, 1e-3, 0.1)]}, "variables (high)"),
    (
        designs,
        {"variables": [DesignVariable("pinion.helix_crowning", 0.0, 1e-5)]},
        "pinion.modification.helix_crowning",
    ),
    (designs, {"effects": {"profile_modification": "off"}}, "effects.profile_modification"),
    (designs, {"scatter": Scatter(1e-5)}, "misalignments"),
    (designs, {"objective": WeightedMean((1.0, 2.0))}, "objective.weights"),
    (designs, {"torques": [200.0, 100.0]}, "torques"),
    (designs, {"misalignment": 30.0}, "misalignment"),
    (samples, {"samples": 1}, "samples"),
    (samples, {"confidence": 1.0}, "confidence"),
    (samples, {"fractions": [1.5]}, "fractions[0]"),
    (samples, {"tolerances": Tolerances(1e-5)}, "misalignments"),  # in the plane
    (samples, {"effects": {"profile_modification": "off"}}, "effects.profile_modification"),
]


def called(make: Callable[..., object], values: Any) -> object:
    return make(**values) if isinstance(values, dict) else make(*values)


@pytest.mark.parametrize(
    ("make", "values", "field"), ROWS, ids=[f"{make.__name__} {values}" for make, values, _ in ROWS]
)
def test_a_value_that_cannot_be_is_refused_by_name(make, values, field):
    with pytest.raises(InputError) as refusal:
        called(make, values)
    assert refusal.value.field == field, refusal.value
    assert not isinstance(refusal.value, InfeasibleGeometry)


def webbed(**change: Any) -> object:
    return replace(WIDE, blank=replace(BLANK, **change))


def seated(**seat: Any) -> object:
    return gear(
        9, face_width=20e-3, bore_diameter=12e-3, profile_shift_coefficient=0.4, seat=BoreSeat(**seat)
    )


def mated(pinion: dict[str, Any], wheel: dict[str, Any], distance: float | None = None) -> object:
    return GearPair(make_gear(**pinion), make_gear(**wheel), distance)


def inside(pinion: dict[str, Any], wheel: dict[str, Any], **fields: Any) -> object:
    ring = {"rim_diameter": 5.2e-3 * wheel.get("teeth", 80), "addendum_coefficient": 0.8, "teeth": 80}
    return InternalGearPair(make_gear(**({"teeth": 30} | pinion)), make_ring(**(ring | wheel)), **fields)


LOW: dict[str, Any] = {"dedendum_coefficient": 0.78, "root_radius_coefficient": 0.0}
POINTED: dict[str, Any] = {
    "teeth": 200, "cutter_teeth": 100, SHIFT: -1.0, "dedendum_coefficient": 0.5, "tip_diameter": 0.788,
}  # fmt: skip
FILLET = BasicRack(4e-3).full_fillet_coefficient
IMPOSSIBLE: list[tuple[str, str, Callable[..., object], Any, Any]] = [
    # what is wrong, its field, refused, and a feasible neighbor where one is near
    ("pointed tooth", "tip_diameter", make_gear, {"tip_diameter": 0.0925}, {"tip_diameter": 0.0922}),
    ("pointed tooth", "tip_diameter", make_gear, {"teeth": 8, SHIFT: 0.6}, {"teeth": 8, SHIFT: 0.5}),
    ("bore", "bore_diameter", make_gear, {"bore_diameter": 0.07}, {"bore_diameter": 0.0699}),
    ("bore", "bore_diameter", make_gear, {"teeth": 4, SHIFT: -0.7}, {"teeth": 4, SHIFT: -0.3}),
    (
        "root radius",
        "root_radius_coefficient",
        make_gear,
        {"root_radius_coefficient": 0.472},
        {"root_radius_coefficient": 0.4719},
    ),
    (
        "root radius",
        "root_radius_coefficient",
        rack,
        {"root_radius_coefficient": FILLET + 1e-6},
        {"root_radius_coefficient": FILLET},
    ),
    (  # flanks that cross above the root, even without rounding
        "root radius",
        "dedendum_coefficient",
        rack,
        {"dedendum_coefficient": 2.3, "root_radius_coefficient": 0.0},
        None,
    ),
    ("tip diameter", "tip_diameter", make_gear, {"tip_diameter": 0.0699}, {"tip_diameter": 0.0765}),
    ("tip diameter", "tip_diameter", make_gear, {"tip_diameter": 0.07528}, {"tip_diameter": 0.07529}),
    (
        "undercut",
        "tip_diameter",
        make_gear,
        {"teeth": 6, SHIFT: -0.5, "addendum_coefficient": 0.5},
        {"teeth": 6, SHIFT: -0.4, "addendum_coefficient": 0.5},
    ),
    ("rim", "rim_diameter", make_ring, {"rim_diameter": 0.249}, None),
    ("tip diameter", "tip_diameter", make_ring, {"tip_diameter": 0.251}, None),
    ("tip diameter", "tip_diameter", make_ring, {"tip_diameter": 0.249}, None),
    ("tip diameter", "tip_diameter", make_ring, {"tip_diameter": 0.2255}, None),
    ("tip diameter", "tip_diameter", make_ring, {"addendum_coefficient": 2.2}, None),
    ("interference", "tip_diameter", make_ring, {"cutter_teeth": 20}, None),
    ("root radius", "root_radius_coefficient", make_ring, {"root_radius_coefficient": 0.6}, None),
    ("trimming interference", "cutter_teeth", make_ring, {"cutter_teeth": 44}, None),
    (
        "profile shift sum",
        "cutter_profile_shift_coefficient",
        make_ring,
        {"cutter_profile_shift_coefficient": 0.8},
        None,
    ),
    ("pointed tooth", "tip_diameter", make_ring, POINTED, None),
    ("rim", "blank.rim_thickness", webbed, {"rim_thickness": 50e-3}, {}),
    ("rim", "blank.rim_thickness", webbed, {"rim_thickness": 1e-3}, {}),
    ("hub", "blank.hub_diameter", webbed, {"hub_diameter": 39e-3}, {}),
    ("rim", "blank.rim_thickness", webbed, {"hub_diameter": 139e-3}, {}),
    ("web", "blank.web_thickness", webbed, {"web_thickness": 41e-3, "web_offset": 0.0}, {}),
    ("web", "blank.web_thickness", webbed, {"web_thickness": 0.5e-3}, {}),
    ("web", "blank.web_offset", webbed, {"web_offset": -16e-3}, {}),
    ("seat", "seat.width", seated, {"width": 21e-3}, {"width": 20e-3}),
    ("seat", "seat.offset", seated, {"width": 10e-3, "offset": 6e-3}, {"width": 10e-3, "offset": 5e-3}),
    ("normal module", "wheel.normal_module", mated, [{}, {"normal_module": 4.1e-3}], None),
    ("pressure angle", "wheel.normal_pressure_angle", mated, [{}, {"normal_pressure_angle": 0.36}], None),
    ("helix angle", "wheel.helix_angle", mated, [{"helix_angle": 0.2}, {"helix_angle": 0.2}], None),
    ("helix angle", "wheel.helix_angle", mated, [{"helix_angle": 0.2}, {"helix_angle": -0.21}], None),
    ("interference", "wheel.tip_diameter", mated, [{"teeth": 10}, {"teeth": 60}], None),
    ("interference", "pinion.tip_diameter", mated, [{"teeth": 60}, {"teeth": 10}], None),
    (
        "tip clearance",
        "wheel.tip_diameter",
        mated,
        [{"teeth": 24, "dedendum_coefficient": 0.98}, {"teeth": 26}],
        None,
    ),
    ("profile shift sum", SHIFT, mated, [{SHIFT: -1.2}, {SHIFT: -1.2}], None),
    ("profile shift sum", "center_distance", mated, [{}, {}, 0.0799], [{}, {}, 0.08]),
    ("profile shift sum", "center_distance", mated, [{}, {}, 0.07], None),
    ("contact ratio", "center_distance", mated, [{}, {}, 0.0825], None),
    ("contact ratio", "center_distance", mated, [{}, {}, 0.2], None),
    ("normal module", "wheel.normal_module", inside, [{}, {"normal_module": 4.1e-3}], [{}, {}]),
    ("pressure angle", "wheel.normal_pressure_angle", inside, [{}, {"normal_pressure_angle": 0.36}], None),
    ("helix angle", "wheel.helix_angle", inside, [{"helix_angle": 0.2}, {"helix_angle": -0.2}], None),
    ("tooth number difference", "wheel.teeth", inside, [{"teeth": 80}, {}], None),
    ("profile shift sum", SHIFT, inside, [{SHIFT: 1.2}, {}], None),
    (
        "contact ratio",
        "center_distance",
        inside,
        [{"addendum_coefficient": 0.3}, {"addendum_coefficient": 0.2}],
        None,
    ),
    ("tip clearance", "pinion.tip_diameter", inside, [{"addendum_coefficient": 1.3}, {}], None),
    ("tip clearance", "wheel.tip_diameter", inside, [LOW, {}], None),
    ("interference", "wheel.tip_diameter", inside, [{}, {"addendum_coefficient": 1.0}], None),
    ("interference", "wheel.tip_diameter", inside, [{"teeth": 12}, {"teeth": 60}], None),
    ("interference", "pinion.tip_diameter", inside, [{"addendum_coefficient": 1.24}, {}], None),
    ("tip interference", "wheel.tip_diameter", inside, [{"teeth": 73}, {}], None),
]


@pytest.mark.parametrize(
    ("name", "field", "make", "refused", "feasible"),
    IMPOSSIBLE,
    ids=[f"{make.__name__} {name}" for name, _, make, _, _ in IMPOSSIBLE],
)
def test_a_gear_or_pair_that_cannot_exist_is_refused_by_what_is_wrong(name, field, make, refused, feasible):
    with pytest.raises(InfeasibleGeometry) as refusal:
        called(make, refused)
    assert (refusal.value.name, refusal.value.field) == (name, field)
    if feasible is not None:
        assert str(refusal.value.suggestion)
        called(make, feasible)


@pytest.mark.parametrize(
    ("name", "field", "fields"),
    [
        ("face overlap", "axial_offset", {"axial_offset": 0.03}),
        ("center distance", "center_distance", {"center_distance": 0.0939}),
        ("profile shift sum", "center_distance", {"center_distance": 0.1001}),
        ("trimming interference", "radial_assembly", {"radial_assembly": True}),
    ],
)
def test_a_place_where_a_ring_cannot_run_is_refused_by_what_is_wrong(name, field, fields):
    with pytest.raises(InfeasibleGeometry) as refusal:
        inside({"teeth": 70} if "radial_assembly" in fields else {}, {}, **fields)
    assert (refusal.value.name, refusal.value.field) == (name, field)
