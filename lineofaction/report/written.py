"""Results of Python as files and figures: what the verbs of the command line write."""

from __future__ import annotations

from pathlib import Path
from typing import Any, get_origin

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, Study
from lineofaction.report.document.write import write_whole
from lineofaction.report.drawing.image import png
from lineofaction.report.presentation import presentation_of


def facts(result: Any) -> dict[str, Any]:
    """Return the figures of a study's result in the units of their names, as its verb prints them as JSON."""
    found: dict[str, Any] = _study_of(result).run.facts(result)
    return found


def write(result: Any, file: Path | str) -> Path:
    """Write a result: netCDF (.nc), figures (.json), the plot (.png) or the report (.html).

    Parameters
    ----------
    result : object
        Of `analyze`, `simulate` or a study.
    file : path
        Its ending says as what.

    Raises
    ------
    BadInput
        The result has no file of this ending.
    """
    path = Path(file)
    if hasattr(result, "to_netcdf") and path.suffix == ".nc":
        result.to_netcdf(path)
        return path
    study = _study_of(result)
    if path.suffix == ".nc":
        study.run.file.write(result, path)
    elif path.suffix == ".json":
        study.run.save_facts(result, path)
    elif path.suffix == ".png":
        path.write_bytes(png(presentation_of(study).figure(result)))
    elif path.suffix == ".html":
        write_whole(presentation_of(study).page(result), path)
    else:
        raise BadInput.of("file", str(path), "a file ending in one of .nc, .json, .png, .html")
    return path


def _study_of(result: Any) -> Study:
    """Return the study whose result this is."""
    for study in STUDIES.values():
        kind = study.run.file.result
        if isinstance(result, tuple if get_origin(kind) is tuple else kind):
            return study
    kind = type(result).__name__
    advice = "Tables and runs: write them to netCDF, then loa report."
    raise BadInput.of("result", kind, "the result of a study", advice)
