"""Studies in files: which one a file holds, and its page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dynamics.errors import DynamicsError
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import STUDIES, Study
from lineofaction.report.drawing.page import Page
from lineofaction.report.presentation import presentation_of


def stored_study(attributes: Mapping[str, object]) -> Study | None:
    """Return the study that made a file with these attributes; None: another kind of file."""
    return next((study for study in STUDIES.values() if study.run.file.holds(attributes)), None)


def study_page(study: Study, file: Path, database: SteDatabase | None = None) -> Page:
    """Return the page of a study's file; beside a database, if there is one.

    Raises
    ------
    BadInput
        It is damaged.
    """
    return page_beside(study, read_stored(study, file), database)


def read_stored(study: Study, file: Path) -> Any:
    """Return the result in a study's file.

    Raises
    ------
    BadInput
        It is damaged.
    """
    with _undamaged(study, file):
        return study.run.file.read(file)


@contextmanager
def _undamaged(study: Study, file: Path) -> Iterator[None]:
    """Name the file in the libraries' errors of damaged files."""
    try:
        yield
    except (FeContactError, DynamicsError) as error:
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", f"{error}.") from None
    except ValueError:
        advice = "Something is missing or not as written."
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", advice) from None


def page_beside(study: Study, found: object, database: SteDatabase | None) -> Page:
    """Return the page of a study's result; beside a database, if there is one."""
    presentation = presentation_of(study)
    if database is None or presentation.beside is None:
        return presentation.page(found)
    return presentation.beside(found, database)
