"""A value that an error suggests is accepted when it is typed as printed; above and below it, by a digit."""

import copy
import re
from collections import Counter
from typing import Any

import numpy as np

from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.problems import BadInput, Fault
from lineofaction.gearbox.schemas import Case, validated

Table = dict[str, Any]

NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
LIMIT = re.compile(rf"(at least|at most|above|below|from|less than)\D*? ({NUMBER})(?:\D* to\D*? ({NUMBER}))?")
NUDGE = {"above": 1.1e-6, "below": -1.1e-6, "less than": -1.1e-6}
SHIFT_SUM = re.compile(rf"x_1 \+ x_2 = ({NUMBER})")


def test_every_suggested_value_is_accepted_as_typed():
    random, seen = np.random.default_rng(14), Counter[str]()
    for _ in range(1500):
        table = random_table(random)
        fault = refusal(table)
        if fault is None:
            continue
        name = re.sub(NUMBER, "", fault.bound).rpartition("(")[2].rstrip(")")
        for typed in typed_suggestions(table, fault):
            after = refusal(typed)
            assert after is None or not same(after, fault), f"{table}: {fault} still refused: {after}"
            seen[f"{name} of {fault.field.rpartition('.')[2]}"] += 1
    assert seen["profile shift sum of center_distance_mm"] >= 100
    assert len(seen) >= 11, seen


def same(after: Fault, before: Fault) -> bool:
    """Whether a value is refused for what it was refused before: other limits may come to light."""
    reasons = [re.sub(NUMBER, "", fault.bound) for fault in (after, before)]
    return after.field == before.field and reasons[0] == reasons[1]


def refusal(table: Table) -> Fault | None:
    try:
        gear_pair(validated(Case, table))
    except BadInput as error:
        return error.faults[0]
    return None


def typed_suggestions(table: Table, fault: Fault) -> list[Table]:
    limit = LIMIT.match(fault.bound)
    ends = [float(end) for end in limit.groups()[1:] if end] if limit else []
    nudge = NUDGE.get(limit.group(1), 0.0) if limit else 0.0
    typed = [changed(table, fault.field, end + nudge * abs(end)) for end in ends]
    total = SHIFT_SUM.search(fault.suggestion)
    if total:
        rest = float(total.group(1)) - table["pair"]["wheel"]["profile_shift_coefficient"]
        typed.append(changed(table, "pair.pinion.profile_shift_coefficient", round(rest, 9)))
    return typed


def changed(table: Table, field: str, value: float) -> Table:
    other = copy.deepcopy(table)
    *path, name = field.split(".")
    inner = other
    for part in path:
        inner = inner[part]
    inner[name] = value
    return other


def random_table(random: np.random.Generator) -> Table:
    """Return a pair in which much can be wrong."""
    module = round(random.uniform(0.5, 12.0), 4)
    internal = random.random() < 0.4
    helix = round(random.uniform(0.0, 30.0), 2) if random.random() < 0.5 else 0.0
    pinion, wheel = (random_gear(random, module) for _ in range(2))
    if internal:
        wheel["teeth"] = pinion["teeth"] + int(random.integers(8, 70))
        wheel.pop("bore_diameter_mm")
        wheel.pop("blank", None)
        wheel |= {"internal": True, "addendum_coefficient": round(random.uniform(0.5, 1.0), 3)}
        wheel["rim_diameter_mm"] = round(module * wheel["teeth"] * random.uniform(1.0, 1.3), 3)
        wheel["cutter_teeth"] = int(random.integers(8, wheel["teeth"] - 2))
    sum_of_teeth = wheel["teeth"] + (-1 if internal else 1) * pinion["teeth"]
    distance = 0.5 * module * sum_of_teeth / np.cos(np.radians(helix))
    return {
        "pair": {
            "normal_module_mm": module,
            "helix_angle_deg": helix,
            "center_distance_mm": round(float(distance * random.uniform(0.97, 1.06)), 3),
            "pinion": pinion,
            "wheel": wheel,
        },
        "load": {"torque_n_m": [10.0]},
    }


def random_gear(random: np.random.Generator, module: float) -> Table:
    teeth = int(random.integers(8, 60))
    gear = {
        "teeth": teeth,
        "face_width_mm": round(module * random.uniform(3.0, 12.0), 2),
        "bore_diameter_mm": round(module * teeth * random.choice([0.3, 0.5, 0.95], p=[0.6, 0.35, 0.05]), 2),
        "profile_shift_coefficient": round(random.uniform(-0.4, 0.9), 4),
        "thickness_allowance_um": round(random.choice([0.0, 20.0, 505.0], p=[0.75, 0.22, 0.03]) * module, 1),
    }
    if random.random() < 0.3:
        gear["tip_diameter_mm"] = round(module * (teeth + random.uniform(-2.0, 4.0)), 3)
    if random.random() < 0.1:
        gear["blank"] = {
            "rim_thickness_mm": round(module * random.uniform(0.2, 4.0), 3),
            "web_thickness_mm": round(gear["face_width_mm"] * random.uniform(0.05, 1.1), 3),
            "web_offset_mm": round(gear["face_width_mm"] * random.uniform(-0.4, 0.4), 3),
        }
    return gear
