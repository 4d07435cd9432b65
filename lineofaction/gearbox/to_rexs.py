"""A REXS document with calculated results: of the tables of its stages, or of its deflection."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bounds.types import FloatArray, Json
from dynamics.deflection import BearingLoad, CaseDeflection, MeshAlignment
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import Curve, SteDatabase
from lineofaction.gearbox.convert.case import boundary_errors, gear_pair
from lineofaction.gearbox.from_rexs.loads import LoadCase
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.scene_parts import BearingPart, SceneParts, ShaftPart
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Document
from lineofaction.gearbox.rexs.upgrade import upgrade
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks
from lineofaction.gearbox.studies.deflect.run import scene_of
from lineofaction.gearbox.units import MM, RPM, UM

# Calculated attributes in a REXS document.


CALCULATED = "calculated"
"""Origin of what this program writes (REXS, since 1.5)."""


def _calculated(name: str, value: float | Sequence[float], unit: str) -> Attribute:
    """Return an attribute of a number or an array in `unit`, a unit of REXS."""
    if isinstance(value, Sequence):
        return Attribute(name, "floating_point_array", tuple(map(float, value)), unit, origin=CALCULATED)
    return Attribute(name, "floating_point", float(value), unit, origin=CALCULATED)


Results = Mapping[int, Iterable[Attribute]]
"""Calculated attributes by id of the component."""


def _with_calculated(document: Document, results: Results) -> Document:
    """Return a document with results on its components; everything else stays as it is.

    A result takes the place of an attribute of its name, another program's too.
    """
    model = document.model
    _refuse_unknown(document, results)
    components = tuple(_with(component, results.get(component.id, ())) for component in model.components)
    return replace(document, model=replace(model, components=components))


def _with_case_results(document: Document, number: int, results: Results) -> Document:
    """Return a document with results in a load case of its first spectrum; see `_with_calculated`.

    Without a spectrum the results are the components' own.
    `number` is the place of the load case in the spectrum, from 1.
    """
    model = document.model
    if not model.spectra:
        return _with_calculated(document, results)
    _refuse_unknown(document, results)
    first, cases = model.spectra[0], list(model.spectra[0].cases)
    case = cases[number - 1]
    present = {component.id for component in case.components}
    further = (
        Component(part.id, part.type) for part in model.components if part.id in results.keys() - present
    )
    components = tuple(_with(part, results.get(part.id, ())) for part in (*case.components, *further))
    cases[number - 1] = replace(case, components=components)
    spectra = (replace(first, cases=tuple(cases)), *model.spectra[1:])
    return replace(document, model=replace(model, spectra=spectra))


def _refuse_unknown(document: Document, results: Results) -> None:
    known = {component.id for component in document.model.components}
    for number in results:
        if number not in known:
            raise BadInput.of("results", number, "the id of a component of the document")


def _with(component: Component, results: Iterable[Attribute]) -> Component:
    """Return a component with results, after what else it has."""
    new = tuple(results)
    names = {attribute.id for attribute in new}
    kept = tuple(attribute for attribute in component.attributes if attribute.id not in names)
    return replace(component, attributes=(*kept, *new))


# Results of a cylindrical stage: contact ratios, stiffness over the mesh, transmission error.


POSITIONS = 64
"""Positions of the curves in one base pitch."""
_N_PER_MM = 1e3


def _stage_results(
    pair: ParallelAxes, database: SteDatabase, torque: float | None = None
) -> tuple[Attribute, ...]:
    """Return the attributes of a ``cylindrical_stage``.

    REXS has no attribute of the transmission error: it stands in custom ones, along the transverse line of
    action, > 0 where the driven gear lags, over positions of the driving gear in transverse base pitches; 0:
    the reference pair touches at the pitch point.
    The table is of the same gears, the torque on gear 1, N m; the largest stored by default.
    """
    at = np.arange(POSITIONS * database.period) / POSITIONS
    load = float(database.torque[-1]) if torque is None else torque
    with boundary_errors():
        curve = database.curve(torque=load, at=at)
        stiffness = np.asarray(database.force_at(at, curve.ste).stiffness)
    return (*_contact_ratios(pair), *_mesh(curve, stiffness))


def _contact_ratios(pair: ParallelAxes) -> tuple[Attribute, ...]:
    return (
        _calculated("radial_contact_ratio", pair.transverse_contact_ratio, "none"),
        _calculated("overlap_contact_ratio", pair.overlap_ratio, "none"),
        _calculated("total_contact_ratio", pair.total_contact_ratio, "none"),
    )


def _mesh(curve: Curve, stiffness: FloatArray) -> tuple[Attribute, ...]:
    """Return tangent stiffness and transmission error over the mesh at the curve's load."""
    harmonics = [estimate.value / UM for estimate in curve.harmonics]
    return (
        _calculated("meshing_stiffness_characteristic", (stiffness / _N_PER_MM).tolist(), "N / mm"),
        _calculated("custom_mesh_positions", curve.position.tolist(), "none"),
        _calculated("custom_torque_on_driving_gear", curve.torque, "N m"),
        _calculated("custom_transmission_error", (curve.ste / UM).tolist(), "mum"),
        _calculated("custom_transmission_error_mean", curve.mean.value / UM, "mum"),
        _calculated("custom_transmission_error_peak_to_peak", curve.peak_to_peak.value / UM, "mum"),
        _calculated("custom_transmission_error_harmonics", harmonics, "mum"),
    )


def exported(
    document: Document,
    cases: Sequence[StageCase],
    databases: Sequence[SteDatabase],
    torque: float | None = None,
) -> Document:
    """Return the document, in the newest version of REXS, with the results of stages as calculated.

    Raises `BadInput`: a table of no stage's pair, a torque outside what is stored, or a document that cannot
    be upgraded; `JobFailed`: a table with failed points.

    Parameters
    ----------
    document : Document
        As read, of any version.
    cases : sequence of StageCase
        Of the document; a database belongs to the stage whose pair its case has, and to those equal to it.
    torque : float, optional
        On gear 1, N m; each table's largest by default.
    """
    results: dict[int, tuple[Attribute, ...]] = {}
    for database in databases:
        stage = _stage_of(cases, database)
        attributes = _stage_results(gear_pair(stage.case), database, torque)
        results |= dict.fromkeys((stage.stage, *stage.equal), attributes)
    newest = replace(document, model=upgrade(document.model)[0])
    return _with_calculated(newest, results)


def _stage_of(cases: Sequence[StageCase], database: SteDatabase) -> StageCase:
    pair = validated(Case, database.metadata.case).pair
    stage = next((stage for stage in cases if stage.case.pair == pair), None)
    if stage is None:
        names = ", ".join(stage.name for stage in cases) or "none"
        teeth = f"{pair.pinion.teeth}/{pair.wheel.teeth} teeth"
        bound = f"a table of the pair of a stage of the file, as opened: {names}"
        raise BadInput.of("database", teeth, bound, "Compute the table of the case that the import gives.")
    return stage


# Whether a deflection is that of a gear unit: the first difference of their scenes and load cases.


RELATIVE, ABSOLUTE = 1e-9, 1e-12
"""Of numbers that are equal: files of scenes have twelve digits."""
LOAD = 1e-6
"""Relative, of the torques and speeds of load cases: those of a result come from its search."""
SETTINGS = ("run", "accuracy", "outputs", "integration", "effects", "left_out")
"""Of a scene: how it is computed, which a REXS file does not say, and what its import left out."""
_ADVICE = "Deflect the scene and the load cases that `loa open` writes of this unit, as they are."


def _check_same_scene(unit: OpenedUnit, result: GearboxDeflection) -> None:
    """Refuse a result of another scene than the unit's, or of load cases that it has not."""
    if unit.scene is None:
        raise BadInput.of("rexs", "no scene", "a unit that makes a scene", "See the report of `loa open`.")
    if not result.scene:
        advice = "It is of an older version: repeat the deflection."
        raise BadInput.of("deflection", "no scene", "a result that keeps its scene", advice)
    _refuse(_difference(_bodies(scene_of(unit.scene)), _bodies(result.scene), "scene"))
    pairs = {case.name: case.case.pair.model_dump(mode="json") for case in unit.cases}
    for name, part in unit.parts.meshes.items():
        own = pairs[part.case]
        _refuse(_difference(own, result.cases.get(name, {}).get("pair"), f'case of mesh "{name}", pair'))
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
        path, own, other = difference
        raise BadInput.of(f"rexs, {path}", _shown(own), f"{_shown(other)}, as in the deflection", _ADVICE)


def _shown(value: Any) -> Any:
    """Return a value without the rounding of its computation."""
    return float(f"{value:.10g}") if isinstance(value, float) else value


def _check_load_cases(unit: OpenedUnit, cases: Sequence[CaseDeflection]) -> None:
    """Refuse load cases that the unit has not, and those that were not found."""
    known = {case.name: case for case in unit.load_cases}
    for case in cases:
        if case.name not in known:
            names = ", ".join(known) or "none"
            raise BadInput.of("load_cases", case.name, f"a load case of the unit: {names}", _ADVICE)
        if case.status != "converged":
            raise BadInput.of(
                f'load case "{case.name}"', case.status, "converged", "Its figures say nothing."
            )
        own = known[case.name]
        _check_load(own, case)
        forces = {part.name: _vectors(part.force.tolist(), part.moment.tolist()) for part in case.forces}
        path = f'load case "{case.name}", forces'
        _refuse(_difference(_forces_under(unit, own), forces, path))


def _forces_under(unit: OpenedUnit, case: LoadCase) -> Json:
    forces = () if unit.scene is None else unit.scene.forces
    of_scene = {part.name: _vectors(part.force_n, part.moment_n_m) for part in forces}
    return of_scene | {part["name"]: _vectors(part["force_n"], part["moment_n_m"]) for part in case.forces}


def _vectors(force: Iterable[float], moment: Iterable[float]) -> Json:
    return {"force_n": list(force), "moment_n_m": list(moment)}


def _check_load(own: LoadCase, case: CaseDeflection) -> None:
    if own.direction != case.direction:
        _refuse((f'load case "{case.name}", direction', own.direction, case.direction))
    numbers = {
        "torque_n_m": (own.torque_n_m, case.torque),
        "speed_rpm": (own.speed_rpm, case.speed / RPM),
        "share": (own.share, case.share),
    }
    for item, (first, second) in numbers.items():
        if not math.isclose(first, second, rel_tol=LOAD):
            _refuse((f'load case "{case.name}", {item}', first, second))


# Results of a bearing: forces on both sides, and how they move, each and against each other.


_AXES = "uvw"
_DEFLECTIONS = ("axial_deflection", "radial_deflection_in_v", "radial_deflection_in_w")


def _along(name: str, vector: Iterable[float], unit: str, axes: str = _AXES) -> Iterator[Attribute]:
    """Yield the components of a vector along some axes, each by a name that ends in the axis."""
    for axis, value in zip(_AXES, vector, strict=True):
        if axis in axes:
            yield _calculated(f"{name}_{axis}", value, unit)


def _bearing_results(part: BearingPart, load: BearingLoad) -> tuple[Attribute, ...]:
    """Return the attributes of a bearing under a load case, along its own u, v, w, mean over the mesh cycle.

    The force on a side is what the bearing exerts on the component of that side: what it carries acts on the
    housing, its reaction on the shaft. The deflection is the displacement of the inner less that of the
    outer side, clearance included.
    The load is in x, y, z of the scene.
    """
    on_housing, moment = _turned(part, load.force)
    across, tilt = _turned(part, load.elastic + load.clearance)
    seat, seat_tilt = _turned(part, load.seat)
    shaft, shaft_tilt = across + seat, tilt + seat_tilt
    shaft_side, housing_side = ("inner", "outer") if part.shaft_inside else ("outer", "inner")
    inward = 1.0 if part.shaft_inside else -1.0
    return (
        *_loads(shaft_side, -on_housing, -moment),
        *_loads(housing_side, on_housing, moment),
        *(
            _calculated(name, inward * value / UM, "mum")
            for name, value in zip(_DEFLECTIONS, across, strict=True)
        ),
        *_along("angular_deflection_in", inward * tilt, "rad", "vw"),
        *_displacements(shaft_side, shaft, shaft_tilt),
        *_displacements(housing_side, seat, seat_tilt),
    )


def _turned(part: BearingPart, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    return part.turn.T @ values[:3], part.turn.T @ np.array([*values[3:5], 0.0])


def _loads(side: str, force: FloatArray, moment: FloatArray) -> Iterator[Attribute]:
    """Yield force and moment on the component of a side; none about u, about which the bearing turns."""
    yield from _along(f"force_acting_on_{side}_component", force, "N")
    yield from _along(f"torque_acting_on_{side}_component", moment, "N m", "vw")


def _displacements(side: str, displacement: FloatArray, tilt: FloatArray) -> Iterator[Attribute]:
    """Yield the displacements of a side from where it stands without load."""
    yield from _along(f"displacement_{side}_side", displacement / UM, "mum")
    yield from _along(f"tilting_{side}_side", map(math.degrees, tilt), "deg", "vw")


# Results of a stage under a load case: misalignment, load along the face, contact stress.


_PA_PER_MPA, _N_PER_M = 1e6, 1e3


def _alignment_results(mesh: MeshAlignment, sense: int) -> tuple[Attribute, ...]:
    """Return the misalignment of a stage, mean over the mesh cycle.

    The attribute of ISO 6336 is its size without running-in allowance; signed it is a custom one: > 0 where
    the gap between the flanks grows along u of gear 1's shaft.
    `sense` is +1 where the case's face positions count along that u, -1 against it.
    """
    return (
        _calculated("effective_equivalent_misalignment_iso_6336_2019", abs(mesh.misalignment) / UM, "mum"),
        _calculated("custom_misalignment", sense * mesh.misalignment / UM, "mum"),
    )


def _flank_results(flanks: MeshFlanks, sense: int) -> tuple[Attribute, ...]:
    """Return the load along the face and what follows from it, by increasing u of gear 1's shaft.

    Nodes count from the end of the face of the lower u. K_Hbeta is left out where the model is plane.
    `sense` is as of `_alignment_results`.
    """
    order = slice(None, None, sense)
    along = sense * flanks.face_position[order]
    pattern = flanks.pattern[:, order] / _PA_PER_MPA
    factor = flanks.face_load_factor
    return (
        _calculated("load_distribution_node_positions", ((along - along[0]) / MM).tolist(), "mm"),
        _calculated(
            "load_distribution_along_face_width", (flanks.face_load[order] / _N_PER_M).tolist(), "N / mm"
        ),
        *(() if math.isnan(factor) else (_calculated("face_load_factor_contact_stress", factor, "none"),)),
        _calculated("custom_largest_contact_stress", flanks.largest_pressure / _PA_PER_MPA, "MPa"),
        _calculated("custom_contact_pattern_roll_lengths", (flanks.roll_length / MM).tolist(), "mm"),
        _calculated("custom_contact_pattern", pattern.ravel().tolist(), "MPa"),
        _calculated("custom_transmission_error_mean", flanks.mean / UM, "mum"),
        _calculated("custom_transmission_error_peak_to_peak", flanks.peak_to_peak / UM, "mum"),
        _calculated("custom_transmission_error_harmonics", (flanks.harmonics / UM).tolist(), "mum"),
        _calculated("custom_torque_on_driving_gear", flanks.torque, "N m"),
    )


# Results of a shaft: its deflection line.


def _shaft_results(part: ShaftPart, position: FloatArray, motion: FloatArray) -> tuple[Attribute, ...]:
    """Return the deflection line of a shaft along its own u, v, w, by increasing u, mean over the mesh cycle.

    `position` (P,) is from the left end in the scene, m, increasing; `motion` (P, 6) displacement in x, y, z,
    m, and rotation about them, rad.
    """
    order = slice(None, None, part.sense)
    u = part.sense * (position - part.zero)[order]
    displacement = (motion[:, :3] @ part.turn)[order]
    torsion = part.sense * motion[order, 5]
    return (
        _calculated("u_coordinates_of_beam_nodes", (u / MM).tolist(), "mm"),
        *(
            _calculated(f"displacement_{axis}_of_nodes", (displacement[:, k] / UM).tolist(), "mum")
            for k, axis in enumerate("uvw")
        ),
        _calculated("torsion_u", np.degrees(torsion).tolist(), "deg"),
    )


def deflected(document: Document, unit: OpenedUnit, result: GearboxDeflection) -> Document:
    """Return the document, in the newest version of REXS, with the results of a deflection as calculated.

    Results stand in the load cases of the document's first spectrum, of a document without one at the
    components themselves. Raises `BadInput`: the result is of another scene or of other load cases, or a case
    was not found.

    Parameters
    ----------
    document : Document
        As read, of any version.
    unit : OpenedUnit
        What it opens to.
    result : GearboxDeflection
        Of the unit's scene under all or some of its load cases.
    """
    _check_same_scene(unit, result)
    numbers = {case.name: case.number for case in unit.load_cases}
    written = replace(document, model=upgrade(document.model)[0])
    for case in result.deflection.cases:
        results = {
            **dict(_shafts(unit.parts, result.outline.shafts, case)),
            **dict(_bearings(unit.parts, case)),
            **dict(_meshes(unit.parts, result, case)),
        }
        written = _with_case_results(written, numbers[case.name], results)
    return written


def left_out(unit: OpenedUnit, result: GearboxDeflection) -> list[str]:
    """Return the names of shafts, bearings and meshes of the result that are no component of the document."""
    parts = unit.parts
    meshes = (mesh.name for case in result.deflection.cases[:1] for mesh in case.meshes)
    return [
        *(name for name in result.outline.shafts if name not in parts.shafts),
        *(name for name in result.outline.bearings if name not in parts.bearings),
        *(name for name in meshes if name not in parts.meshes),
    ]


_Part = tuple[int, tuple[Attribute, ...]]


def _shafts(parts: SceneParts, names: tuple[str, ...], case: CaseDeflection) -> Iterator[_Part]:
    lines = case.shafts
    for index, name in enumerate(names):
        if name in parts.shafts:
            at = np.flatnonzero(lines.shaft == index)
            part = parts.shafts[name]
            yield part.component, _shaft_results(part, lines.position[at], lines.motion[at])


def _bearings(parts: SceneParts, case: CaseDeflection) -> Iterator[_Part]:
    for load in case.bearings:
        if load.name in parts.bearings:
            part = parts.bearings[load.name]
            yield part.component, _bearing_results(part, load)


def _meshes(parts: SceneParts, result: GearboxDeflection, case: CaseDeflection) -> Iterator[_Part]:
    """Yield what the stages have; a load case on the coast side turns the train the other way."""
    flanks = {entry.mesh: entry for entry in result.flanks if entry.case == case.name}
    turned = 1 if case.direction == "drive" else -1
    for mesh in case.meshes:
        if mesh.name in parts.meshes:
            part = parts.meshes[mesh.name]
            sense = turned * part.sense
            own = _flank_results(flanks[mesh.name], sense) if mesh.name in flanks else ()
            yield part.component, (*_alignment_results(mesh, sense), *own)
