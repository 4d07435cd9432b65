"""Textbook scenes as jobs: modes and a run over HTTP, as their sources have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient

from dynamics.linearize import ModalAnalysis
from dynamics.results import RunResult
from lineofaction.client import LineOfActionClient
from service.app import create_app
from service.settings import Settings

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_textbook_scenes_run_over_http(tmp_path: Path) -> None:
    app = create_app(Settings(data_directory=tmp_path / "data"))
    with (
        TestClient(app) as service,
        LineOfActionClient(
            "http://testserver", cache_dir=tmp_path / "results", transport=service._transport
        ) as client,
    ):
        modes = client.modes.submit(EXAMPLES / "lin_parker_planetary_scene.toml").file()
        run = client.simulate(EXAMPLES / "backlash_oscillator_scene.toml")
    found = ModalAnalysis.from_netcdf(modes).natural_frequency
    assert np.max(found) == pytest.approx(11775.27, abs=0.005)
    assert isinstance(run, RunResult)
    deflection = (run.dynamic_transmission_error[0] - 2.487593e-6 * np.cos(1e4 * run.time)) / 50e-6
    assert np.std(deflection[-20 * 64 - 1 : -1]) == pytest.approx(0.133083, rel=1e-3)
