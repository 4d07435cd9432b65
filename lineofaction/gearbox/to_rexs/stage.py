"""Results of a cylindrical stage: contact ratios, stiffness over the mesh, transmission error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bounds.types import FloatArray
from fe_contact.geometry import ParallelAxes
from fe_contact.ste import Curve, SteDatabase
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Attribute, Document
from lineofaction.gearbox.rexs.upgrade import upgrade
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.reading import validated
from lineofaction.gearbox.to_rexs.attributes import calculated, with_results
from lineofaction.gearbox.units import UM

POSITIONS = 64
"""Positions of the curves in one base pitch."""

_N_PER_MM = 1e3  # N/m in a N/mm


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
        Document as read, in any version.
    cases : sequence of StageCase
        Cases of the stages of the document. A database belongs to the stage whose case has the same pair, and
        to its equal stages.
    torque : float, optional
        Torque on gear 1, N m; by default the largest of each table.
    """
    results: dict[int, tuple[Attribute, ...]] = {}
    for database in databases:
        stage = _stage_of(cases, database)
        attributes = _stage_results(gear_pair(stage.case), database, torque)
        results |= dict.fromkeys((stage.stage, *stage.equal), attributes)
    newest = replace(document, model=upgrade(document.model)[0])
    return with_results(newest, results)


def _stage_results(pair: ParallelAxes, database: SteDatabase, torque: float | None) -> tuple[Attribute, ...]:
    """Return the attributes of a ``cylindrical_stage``.

    REXS has no attribute for the transmission error, so that it gets custom ones. It is the displacement
    along the transverse line of action, > 0 where the driven gear lags. It is given over positions of the
    driving gear in transverse base pitches; at 0 the reference pair touches at the pitch point.

    `database` is a table of the gears of `pair`. `torque` is that on gear 1, N m; None: the largest of the
    table.
    """
    position = np.arange(POSITIONS * database.period) / POSITIONS
    load = float(database.torque[-1]) if torque is None else torque
    with boundary_errors():
        curve = database.curve(torque=load, at=position)
        stiffness = np.asarray(database.force_at(position, curve.ste).stiffness)
    return (
        calculated("radial_contact_ratio", pair.transverse_contact_ratio, "none"),
        calculated("overlap_contact_ratio", pair.overlap_ratio, "none"),
        calculated("total_contact_ratio", pair.total_contact_ratio, "none"),
        *_mesh(curve, stiffness),
    )


def _mesh(curve: Curve, stiffness: FloatArray) -> tuple[Attribute, ...]:
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


def _stage_of(cases: Sequence[StageCase], database: SteDatabase) -> StageCase:
    pair = validated(Case, database.metadata.case).pair
    stage = next((stage for stage in cases if stage.case.pair == pair), None)
    if stage is None:
        names = ", ".join(stage.name for stage in cases) or "none"
        teeth = f"{pair.pinion.teeth}/{pair.wheel.teeth} teeth"
        bound = f"a table of the pair of a stage of the file, as opened: {names}"
        raise BadInput.of("database", teeth, bound, "Compute the table of the case that the import gives.")
    return stage
