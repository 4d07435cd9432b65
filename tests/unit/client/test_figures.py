"""Figures of results as the client has them: typed by kind, whole, and read by name as before."""

import json
from typing import Any, get_type_hints

import pytest
from declared_figures import check_declared, document
from pydantic import ValidationError
from small_table import small_table
from stored_jobs import StoredJobs, against, case

from lineofaction.client import AsyncJob, AsyncLineOfActionClient, Job, LineOfActionClient
from lineofaction.client.surface import Listing, Operation
from lineofaction.gearbox.convert.answers import metadata_json
from lineofaction.gearbox.registry import RESULT_KINDS, STUDIES, figures_model
from lineofaction.gearbox.schemas.figures import Figures, Part, RunFigures, TableFigures
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.units import RPM

OF_FILE = {"hash": "ab" * 32, "sha256": "cd" * 32, "size": 3}
ABLATION = OF_FILE | {
    "of": "case",
    "nominal": {"mean_um": [1.0], "peak_to_peak_um": [2.0], "cpu_seconds": 0.1},
    "effects": [],
    "left_out": {},
    "warnings": [],
}


def test_every_kind_has_a_model_of_its_own():
    models = {kind: figures_model(kind) for kind in RESULT_KINDS}
    assert len(set(models.values())) == len(RESULT_KINDS) == len(STUDIES) + 2
    assert all(issubclass(model, Figures) and model is not Figures for model in models.values())
    assert (models["database"], models["run"]) == (TableFigures, RunFigures)
    assert figures_model("of a later version") is Figures


def test_a_table_says_what_is_declared():
    check_declared("database", json.loads(json.dumps(metadata_json(small_table()))))


def test_members_are_read_as_attributes_and_by_their_names():
    figures = figures_model("ablation").model_validate(ABLATION)
    assert figures.nominal.mean_um == [1.0]
    assert figures["nominal"] == ABLATION["nominal"]
    for missing in ("nominals", "torque_n_m"):  # of a case alone
        with pytest.raises(KeyError):
            figures[missing]
    with pytest.raises(ValidationError):
        figures.of = "scene"


def test_what_a_later_service_adds_is_kept():
    later = ABLATION | {"moon": "full"}
    figures = figures_model("ablation").model_validate(later)
    assert document(figures) == later and figures["moon"] == "full"


class Octaves(Part):
    """Two figures of one name but for their units."""

    band_hz: list[float]
    band_db: list[float]
    speed_rpm: float


def test_a_name_that_figures_share_is_none_of_theirs():
    figures = figures_of(Octaves, {"speed": 60.0 * RPM}, band_hz=[1.0], band_db=[2.0])
    assert figures == {"band_hz": [1.0], "band_db": [2.0], "speed_rpm": 60.0}
    with pytest.raises(TypeError, match="one figure of Octaves: band"):
        figures_of(Octaves, {"speed": 1.0}, band=[1.0])
    with pytest.raises(TypeError, match="one figure of Octaves: sped"):
        figures_of(Octaves, band_hz=[1.0], band_db=[2.0], sped=1.0)
    with pytest.raises(AttributeError, match="band_hz"):
        figures_of(Octaves, {"speed": 1.0, "band": [1.0]})


def test_no_call_returns_a_bare_dictionary():
    """Of all that clients and jobs offer, as annotated."""
    for surface in (LineOfActionClient, AsyncLineOfActionClient, Job, AsyncJob):
        for kind in surface.__mro__:
            for name, member in vars(kind).items():
                if not name.startswith("_") and isinstance(member, Operation | Listing):
                    returned = member._steps.__annotations__["return"]
                    assert "dict" not in returned.lower() and "Mapping" not in returned, (name, returned)


def test_a_job_reads_the_figures_of_its_kind(tmp_path):
    network = StoredJobs()
    table: dict[str, Any] = OF_FILE | json.loads(json.dumps(metadata_json(small_table())))
    with against(network, tmp_path) as client:
        job = client.analyze.submit(case())
        network._content[job.wait().key] = json.dumps(table).encode()
        figures = job.figures()
    assert isinstance(figures, TableFigures) and document(figures) == table
    assert get_type_hints(TableFigures)["torque_n_m"] == list[float]
