"""Comparison of a deflection's scene with a gear unit: the first difference of scenes and load cases."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from bounds.types import Json
from dynamics.deflection import CaseDeflection
from lineofaction.gearbox.from_rexs.loads import LoadCase
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.studies.deflect.run import scene_of
from lineofaction.gearbox.units import RPM

RELATIVE, ABSOLUTE = 1e-9, 1e-12
"""Tolerances, relative and absolute, within which numbers are equal: files of scenes have twelve digits."""

LOAD = 1e-6
"""Relative tolerance of torques and speeds of load cases, which come from a search in a result."""

SETTINGS = ("run", "accuracy", "outputs", "integration", "effects", "left_out")
"""Tables of a scene that are not compared: settings of the computation, which a REXS file has not, and
remarks on what the import left out."""

_REMEDY = "Deflect the scene and the load cases that `loa open` writes of this unit, as they are."


def check_same_scene(unit: OpenedUnit, result: GearboxDeflection) -> None:
    """Refuse a result of another scene than the unit's, or of load cases that it has not."""
    if unit.scene is None:
        raise BadInput.of("rexs", "no scene", "a unit that makes a scene", "See the report of `loa open`.")
    if not result.scene:
        remedy = "It is of an older version: repeat the deflection."
        raise BadInput.of("deflection", "no scene", "a result that keeps its scene", remedy)
    _refuse(_difference(_bodies(scene_of(unit.scene)), _bodies(result.scene), "scene"))
    pairs = {case.name: case.case.pair.model_dump(mode="json") for case in unit.cases}
    for name, part in unit.parts.meshes.items():
        unit_pair = pairs[part.case]
        _refuse(
            _difference(unit_pair, result.cases.get(name, {}).get("pair"), f'case of mesh "{name}", pair')
        )
    _check_load_cases(unit, result.deflection.cases)


def _difference(unit: Any, result: Any, path: str) -> tuple[str, Any, Any] | None:
    """Return the path at which two values of JSON differ first with both values, None if they are equal."""
    if isinstance(unit, Mapping) and isinstance(result, Mapping):
        return _first(
            _difference(unit.get(key), result.get(key), f"{path}.{key}") for key in {**unit, **result}
        )
    if isinstance(unit, list) and isinstance(result, list):
        if len(unit) != len(result):
            return f"length of {path}", len(unit), len(result)
        pairs = enumerate(zip(unit, result, strict=True))
        return _first(_difference(one, other, f"{path}[{k}]") for k, (one, other) in pairs)
    return None if _equal(unit, result) else (path, unit, result)


def _first(differences: Iterable[tuple[str, Any, Any] | None]) -> tuple[str, Any, Any] | None:
    return next((difference for difference in differences if difference is not None), None)


def _equal(unit: Any, result: Any) -> bool:
    numbers = all(isinstance(value, int | float) and not isinstance(value, bool) for value in (unit, result))
    return math.isclose(unit, result, rel_tol=RELATIVE, abs_tol=ABSOLUTE) if numbers else bool(unit == result)


def _bodies(scene: Json) -> Json:
    return {key: value for key, value in scene.items() if key not in SETTINGS}


def _refuse(difference: tuple[str, Any, Any] | None) -> None:
    if difference is not None:
        path, value, other = difference
        raise BadInput.of(
            f"rexs, {path}", _rounded(value), f"{_rounded(other)}, as in the deflection", _REMEDY
        )


def _rounded(value: Any) -> Any:
    """Return a value without the rounding of its computation."""
    return float(f"{value:.10g}") if isinstance(value, float) else value


def _check_load_cases(unit: OpenedUnit, cases: Sequence[CaseDeflection]) -> None:
    """Refuse load cases that the unit lacks, and load cases without a solution."""
    known = {case.name: case for case in unit.load_cases}
    for case in cases:
        if case.name not in known:
            names = ", ".join(known) or "none"
            raise BadInput.of("load_cases", case.name, f"a load case of the unit: {names}", _REMEDY)
        if case.status != "converged":
            raise BadInput.of(
                f'load case "{case.name}"', case.status, "converged", "Its figures say nothing."
            )
        load_case = known[case.name]
        _check_load(load_case, case)
        forces = {part.name: _vectors(part.force.tolist(), part.moment.tolist()) for part in case.forces}
        path = f'load case "{case.name}", forces'
        _refuse(_difference(_forces_under(unit, load_case), forces, path))


def _forces_under(unit: OpenedUnit, case: LoadCase) -> Json:
    forces = () if unit.scene is None else unit.scene.forces
    of_scene = {part.name: _vectors(part.force_n, part.moment_n_m) for part in forces}
    return of_scene | {part["name"]: _vectors(part["force_n"], part["moment_n_m"]) for part in case.forces}


def _vectors(force: Iterable[float], moment: Iterable[float]) -> Json:
    return {"force_n": list(force), "moment_n_m": list(moment)}


def _check_load(load_case: LoadCase, case: CaseDeflection) -> None:
    if load_case.direction != case.direction:
        _refuse((f'load case "{case.name}", direction', load_case.direction, case.direction))
    numbers = {
        "torque_n_m": (load_case.torque_n_m, case.torque),
        "speed_rpm": (load_case.speed_rpm, case.speed / RPM),
        "share": (load_case.share, case.share),
    }
    for item, (first, second) in numbers.items():
        if not math.isclose(first, second, rel_tol=LOAD):
            _refuse((f'load case "{case.name}", {item}', first, second))
