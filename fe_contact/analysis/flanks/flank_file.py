"""Flank results as netCDF-4 files, with the contact patterns for other readers."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from bounds import Finding, warn_of
from fe_contact.analysis.checks.table_laws import require_laws
from fe_contact.analysis.flanks.flank_errors import with_errors
from fe_contact.analysis.flanks.flank_laws import check_flank_laws
from fe_contact.analysis.flanks.load_distribution import (
    FlankErrors,
    FlankScene,
    LoadDistribution,
    load_distribution,
)
from fe_contact.analysis.flanks.solved_operating_point import solved_point
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.errors import DatabaseError
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from fe_contact.plausibility import flank_findings, merged, unexpected
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import Metadata
from fe_contact.ste.facts import content_hash
from fe_contact.ste.netcdf import FileFormat, digest, json_attribute
from fe_contact.types import FloatArray, Json
from model_studies.netcdf import NetcdfContent, Variable
from model_studies.stage_clock import StageClock

if TYPE_CHECKING:
    from fe_contact.analysis.flanks.load_distribution import LoadDistribution


# Contact pattern: the largest pressure that each point of the unrolled flank meets over the mesh cycle.


@dataclass(frozen=True)
class ContactPattern:
    """Largest pressure over one flank."""

    roll_length: FloatArray
    """Middles of equal cells along the profile, m. Shape (R,)."""
    face_position: FloatArray
    """Middles of the slices, as distances from the pinion's mid-face, m. Shape (K,)."""
    pressure: FloatArray
    """Largest Hertz pressure in Pa of any pair at any position; 0 where nothing touches. Shape (R, K)."""


def contact_pattern(
    distribution: LoadDistribution, gear: Literal["pinion", "wheel"] = "pinion"
) -> ContactPattern:
    """Collect the pressures of all positions and pairs on one flank.

    The cells are as long as the flanks roll between two positions, so that over a whole cycle of equally
    spaced positions the contact line meets every cell.

    Parameters
    ----------
    distribution : LoadDistribution
        At equally spaced positions over one base pitch.
    gear : str
        "pinion" or "wheel": whose flank.
    """
    roll = distribution.roll_length_1 if gear == "pinion" else distribution.roll_length_2
    touched = distribution.on_path | (distribution.force > 0.0)
    low, high = float(roll[touched].min()), float(roll[touched].max())
    span = high - low or 1.0  # a single point is a cell of its own
    both = distribution.on_path[1:] & distribution.on_path[:-1]
    steps = np.abs(np.diff(roll, axis=0))[both]
    count = max(int(span / float(steps.max())), 1) if steps.size else 1
    cell = np.clip(((roll - low) * (count / span)).astype(int), 0, count - 1)
    pressure = np.zeros((count, distribution.face_position.size))
    index = np.nonzero(touched)
    np.maximum.at(pressure, (cell[index], index[2]), distribution.pressure[index])
    middles = np.asarray(low + (np.arange(count) + 0.5) * (span / count), dtype=np.float64)
    return ContactPattern(middles, distribution.face_position, pressure)


FORMAT = "lineofaction flank results"
SCHEMA_VERSION = 2
_GRID = ("position", "pair", "face_position")
_GEARS: tuple[Literal["pinion"], Literal["wheel"]] = ("pinion", "wheel")
_SCALARS, _DOCUMENTS = ("slice_width", "base_helix_angle"), ("scene", "metadata")
_NO_ERRORS = FlankErrors(reason="the file is older than errors of flanks")

# dimensions, units and long name of what is read back
STORED: dict[str, tuple[tuple[str, ...], str, str]] = {
    "position": (("position",), "1", "phase of the driving gear in transverse base pitches, 0 = pitch point"),
    "pair": (("pair",), "1", "index of the tooth pair, +1 is ahead"),
    "face_position": (("face_position",), "m", "middle of the stretch, distance from the pinion's mid-face"),
    "deflection": (("position",), "m", "static transmission error"),
    "roll_length_1": (_GRID, "m", "roll length on the driving gear"),
    "roll_length_2": (_GRID, "m", "roll length on the driven gear"),
    "on_path": (_GRID, "1", "1 where any of it is between A and E"),
    "force": (_GRID, "N", "normal force of the stretch"),
    "lever": (_GRID, "1", "lever arm about the driving gear over its base radius"),
    "pressure": (_GRID, "Pa", "peak Hertz pressure"),
    "gap": (_GRID, "m", "gap between the loaded flanks, infinite where they cannot touch"),
}
_EDGE: dict[str, tuple[tuple[str, ...], str, str]] = {
    "at_edge": (_GRID, "1", "1 where the strip reaches an edge of either flank")
}
"""Absent from older files."""
FILES = FileFormat(
    FORMAT, "flank results", SCHEMA_VERSION, tuple(STORED), (*_SCALARS, *_DOCUMENTS), tuple(_EDGE)
)


def content(results: LoadDistribution) -> NetcdfContent:
    """Return the content of a file: flank results with line load, centroid, factors and contact patterns."""
    arrays = _arrays(results)
    variables = {
        name: Variable(dimensions, arrays[name], {"units": units, "long_name": text})
        for name, (dimensions, units, text) in (STORED | _EDGE).items()
    }
    for gear in _GEARS:
        pattern = contact_pattern(results, gear)
        along = f"pattern_roll_length_{gear}"
        text = {"units": "m", "long_name": f"roll length on the {gear}, middles of cells"}
        variables[along] = Variable((along,), pattern.roll_length, text)
        text = {"units": "Pa", "long_name": f"largest pressure on the {gear}'s flank over the positions"}
        variables[f"contact_pattern_{gear}"] = Variable((along, "face_position"), pattern.pressure, text)
    return NetcdfContent(variables | _derived(results), _attributes(results, arrays))


def read(path: Path) -> dict[str, Any]:
    """Read what makes a `LoadDistribution`, by its fields.

    Raises `DatabaseError`: the file is missing, no netCDF-4, of another kind, of a newer schema, or damaged.
    """
    content, attributes = FILES.read(path)
    scene, metadata = (json_attribute(path, attributes, name) for name in _DOCUMENTS)
    return content | {
        "on_path": content["on_path"].astype(bool),
        "at_edge": content["at_edge"].astype(bool) if "at_edge" in content else False,
        "scene": FlankScene.from_json(scene),
        "metadata": Metadata(**metadata),
        "errors": _errors(path, attributes),
        **{name: float(attributes[name]) for name in _SCALARS},
    }


def _errors(path: Path, attributes: Json) -> FlankErrors:
    """Return the errors of a file; `DatabaseError`: they are something else."""
    if "errors" not in attributes:
        return _NO_ERRORS
    try:
        return FlankErrors(**json_attribute(path, attributes, "errors"))
    except TypeError as error:
        raise DatabaseError(f"{path.name}: damaged, its errors are not those of flanks") from error


def _arrays(results: LoadDistribution) -> dict[str, Any]:
    """Return what is read back, in its order; netCDF has no booleans."""
    arrays = {name: getattr(results, name) for name in STORED}
    edge = np.broadcast_to(results.at_edge, results.force.shape)
    return arrays | {"on_path": results.on_path.astype(np.int8), "at_edge": edge.astype(np.int8)}


def _derived(results: LoadDistribution) -> dict[str, Variable]:
    """Return what follows from the rest, for readers without this library."""
    along = ("position",)
    centroid = {"units": "m", "long_name": "along the face"}
    per_width = {"units": "N m-1", "long_name": "force of all pairs per face width"}
    return {
        "line_load": Variable(
            _GRID, results.line_load, {"units": "N m-1", "long_name": "force per contact line"}
        ),
        "face_load": Variable(("position", "face_position"), results.face_load, per_width),
        "load_centroid": Variable(along, results.load_centroid, centroid),
        "face_load_factor": Variable(along, results.face_load_factor, {"units": "1", "long_name": "K_Hbeta"}),
    }


def _attributes(results: LoadDistribution, arrays: dict[str, Any]) -> Json:
    return {
        "Conventions": "CF-1.11",
        "title": "Load and pressure on the flanks of a gear pair",
        "format": FORMAT,
        "schema_version": np.int64(SCHEMA_VERSION),
        "content_hash": results.metadata.content_hash,
        "mean_face_load_factor": results.mean_face_load_factor,
        "errors": json.dumps(asdict(results.errors)),
        "scene": json.dumps(results.scene.to_json()),
        "metadata": json.dumps(asdict(results.metadata)),
        "warnings": json.dumps(results.metadata.warnings),
        **{name: getattr(results, name) for name in _SCALARS},
        "data_sha256": digest(arrays),
    }


# Flank results: what happens on the flanks of a gear pair at one load and one alignment.


def flank_results(
    pair: ParallelAxes | Checked,
    point: OperatingPoint | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    at: ArrayLike | None = None,
    case: Json | None = None,
) -> LoadDistribution:
    """Solve the contact of one load and alignment, and return load, pressure and gap on the flanks.

    Raises `InputError`: a value that cannot be used, by field name; `MeshError`, `SolveError`: no acceptable
    mesh, positions without a solution, results that break a law of mechanics (`partial` has them), or a
    violated assumption if `on_violation` is "fail".

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        A request that is checked already stands for pair, point and options.
    point : OperatingPoint, optional
    options : AnalysisOptions
        `positions` and `receipt` are ignored.
    run : Run
        Workers are not used.
    at : array_like, optional
        Positions in base pitches; default: 64 over one mesh cycle, as `contact_pattern` needs them. Teeth
        with pitch deviations are those that mesh there: the first ones of the lists in 0 to 1.
    case : dict, optional
        The case as the caller phrased it, echoed and hashed; default: the request in SI units.
    """
    clock = StageClock(run.workers.cost)
    solved, receipt = solved_point(as_checked(pair, point, options), at, clock, run)
    checked, request = solved.checked, solved.checked.request
    results = load_distribution(
        solved.contact.pair,
        solved.problem,
        solved.solution,
        misalignment=float(request.misalignment[0]),
        center_distance_change=float(request.center_distance_change[0]),
    )
    laws = check_flank_laws(results, solved.problem)
    require_laws(laws, results, "load distribution")
    with clock.stage("error estimate"):
        results = with_errors(results, solved, run.cache)
    receipt = receipt | clock.to_json() | {"laws": [law.to_json() for law in laws]}
    results = replace(results, metadata=Metadata(receipt=receipt))
    warn_of(unexpected(request.findings, _findings(results)))
    return replace(results, metadata=_metadata(checked, results, case))


def _findings(results: LoadDistribution) -> tuple[Finding, ...]:
    return flank_findings(float(np.max(results.clear_pressure, initial=0.0)))


def _metadata(checked: Checked, results: LoadDistribution, case: Json | None) -> Metadata:
    """Everything about the making; the hash is of all that decides the result."""
    scene = results.scene
    request: Json = {
        "case": case or checked.request.to_json(),
        "normal_force": scene.normal_force,
        "misalignment": scene.misalignment,
        "center_distance_change": scene.center_distance_change,
        "position": results.position.tolist(),
    }
    return replace(
        results.metadata,
        case=request["case"],
        effect_ledger=[entry.to_json() for entry in checked.ledger],
        content_hash=content_hash({"flank_results": request}, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
        warnings=[finding.to_json() for finding in merged(checked.request.findings, _findings(results))],
    )
