"""A REXS document with the results of its stages."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.ste import Curve, SteDatabase
from lineofaction.gearbox.convert.case import boundary_errors, gear_pair
from lineofaction.gearbox.from_rexs.gears import StageCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Component, Document
from lineofaction.gearbox.rexs.upgrade import upgrade
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.units import UM

# Calculated attributes in a REXS document.


CALCULATED = "calculated"
"""Origin of what this program writes (REXS, since 1.5)."""


def calculated(name: str, value: float | Sequence[float], unit: str) -> Attribute:
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


def with_case_results(document: Document, number: int, results: Results) -> Document:
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
    """Refuse results of components that the document has not."""
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
    """Return the contact ratios between the tip circles."""
    return (
        calculated("radial_contact_ratio", pair.transverse_contact_ratio, "none"),
        calculated("overlap_contact_ratio", pair.overlap_ratio, "none"),
        calculated("total_contact_ratio", pair.total_contact_ratio, "none"),
    )


def _mesh(
    curve: Curve, stiffness: np.ndarray[tuple[int, ...], np.dtype[np.float64]]
) -> tuple[Attribute, ...]:
    """Return tangent stiffness and transmission error over the mesh at the curve's load."""
    harmonics = [estimate.value / UM for estimate in curve.harmonics]
    return (
        calculated("meshing_stiffness_characteristic", (stiffness / _N_PER_MM).tolist(), "N / mm"),
        calculated("custom_mesh_positions", curve.position.tolist(), "none"),
        calculated("custom_torque_on_driving_gear", curve.torque, "N m"),
        calculated("custom_transmission_error", (curve.ste / UM).tolist(), "mum"),
        calculated("custom_transmission_error_mean", curve.mean.value / UM, "mum"),
        calculated("custom_transmission_error_peak_to_peak", curve.peak_to_peak.value / UM, "mum"),
        calculated("custom_transmission_error_harmonics", harmonics, "mum"),
    )


def exported(
    document: Document,
    cases: Sequence[StageCase],
    databases: Sequence[SteDatabase],
    torque: float | None = None,
) -> Document:
    """Return the document, in the newest version of REXS, with the results of stages as calculated.

    Parameters
    ----------
    document : Document
        As read, of any version.
    cases : sequence of StageCase
        Of the document; a database belongs to the stage whose pair its case has, and to those equal to it.
    databases : sequence of SteDatabase
    torque : float, optional
        On gear 1, N m; each table's largest by default.

    Raises
    ------
    BadInput
        A table of no stage's pair, a torque outside what is stored, or a document that cannot be upgraded.
    JobFailed
        A table with failed points.
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
