"""A case whose table is stored is not checked again; every other is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from lineofaction.gearbox.problems import BadInput
from service.page.files import examples
from service.schemas.execute import AnalyzeInputs
from service.store.places import stored_results
from service.worker import preparations
from service.worker.preparations import name_database, prepare_analyze


def inputs(torque_n_m: float) -> AnalyzeInputs:
    case: dict[str, Any] = {**examples()[0].content, "load": {"torque_n_m": [50.0, torque_n_m]}}
    return AnalyzeInputs.model_validate({"case": case})


def test_a_case_is_checked_until_its_table_is_stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Refused:
        @property
        def feasible(self) -> None:
            raise BadInput.of("case", None, "never checked")

    store, known = stored_results(tmp_path), inputs(100.0)
    normalized = prepare_analyze(known, store)
    assert normalized == known.model_dump(mode="json")
    monkeypatch.setattr(preparations.CASES, "of", lambda _case: Refused())
    with pytest.raises(BadInput):
        prepare_analyze(known, store)
    (tmp_path / "table.nc").write_bytes(b"a table")
    store.put(name_database(normalized), "database", tmp_path / "table.nc")
    assert prepare_analyze(known, store) == normalized
    with pytest.raises(BadInput):
        prepare_analyze(inputs(101.0), store)
