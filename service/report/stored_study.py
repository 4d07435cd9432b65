"""Studies in files: which one a file holds, and its page."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from dynamics.errors import DynamicsError
from fe_contact.errors import FeContactError
from fe_contact.ste import SteDatabase
from service.drawing.page import Page
from service.problems import BadInput
from service.registry import STUDIES, Study


def marked_study(content: Mapping[str, object]) -> Study | None:
    """Return the study that made a file, by the names in its JSON or the attributes of its netCDF file."""
    for study in STUDIES.values():
        marks = study.run.marks
        if all(name in content and value in (None, content[name]) for name, value in marks.items()):
            return study
    return None


def study_page(study: Study, file: Path, database: SteDatabase | None = None) -> Page:
    """Return the page of a study's file; beside a database, if there is one.

    Raises
    ------
    BadInput
        It is damaged.
    """
    try:
        return page_beside(study, study.run.read(file), database)
    except (KeyError, TypeError, ValueError, FeContactError, DynamicsError) as error:
        advice = f"Something is missing or not as written ({type(error).__name__}: {error})."
        raise BadInput.of("file", str(file), f"an undamaged {study.kind}", advice) from None


def page_beside(study: Study, found: object, database: SteDatabase | None) -> Page:
    """Return the page of a study's result; beside a database, if there is one."""
    if database is None or study.page.beside is None:
        return cast(Page, study.page.page(found))
    return cast(Page, study.page.beside(found, database))


def stored_study(file: Path) -> Study:
    """Return which study a JSON file holds.

    Raises
    ------
    BadInput
        It holds none.
    """
    bound = "a study in JSON, as the verbs of loa write it"
    try:
        content: Any = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput.of("file", str(file), bound, f"It cannot be read ({error}).") from None
    study = marked_study(content if isinstance(content, dict) else {})
    if study is None:
        raise BadInput.of("file", str(file), bound, "It is JSON of another kind.")
    return study
