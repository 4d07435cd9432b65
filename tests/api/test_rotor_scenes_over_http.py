"""Rotors with unbalance as jobs: one without gears in every study of a scene, and a geared one."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient

from lineofaction.client import LineOfActionClient
from service.app import create_app
from service.settings import Settings

EXAMPLES = Path(__file__).parents[2] / "examples"
ROTOR = EXAMPLES / "jeffcott_scene.toml"
MASS, STIFFNESS, RATIO, UNBALANCE = 10.0, 2e6, 0.02, 1e-3  # of the scene
SPEED = 3843.5 * math.tau / 60.0
CRITICAL = math.sqrt(STIFFNESS / MASS)
DAMPING = 2.0 * RATIO * math.sqrt(STIFFNESS * MASS)
RADIUS = UNBALANCE * SPEED**2 / abs(STIFFNESS - MASS * SPEED**2 + 1j * SPEED * DAMPING)
RPM = math.tau / 60.0


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LineOfActionClient]:
    folder = tmp_path_factory.mktemp("rotors")
    app = create_app(Settings(data_directory=folder / "data"))
    with (
        TestClient(app) as service,
        LineOfActionClient(
            "http://testserver", cache_dir=folder / "results", transport=service._transport
        ) as client,
    ):
        yield client


def test_a_rotor_without_gears_runs_on_the_circle(client: LineOfActionClient) -> None:
    run = client.simulate(ROTOR)
    late = (run.time > 2.2) & (run.time < 2.4)
    radius = np.hypot(*run.displacement[:2, late])
    assert radius == pytest.approx(np.full(radius.size, RADIUS), rel=1e-4)
    assert run.receipt["sampling"]["chosen"] == "highest order of a load, 64.06 Hz"


def test_its_modes_response_and_steady_states(client: LineOfActionClient) -> None:
    modes = client.modes(ROTOR, speed_rpm=[0.0, 3000.0])
    assert modes.natural_frequency == pytest.approx([CRITICAL / math.tau] * 2)
    response = client.response(ROTOR, speed_rpm=[SPEED / RPM, CRITICAL / RPM])
    assert response.order.tolist() == [1.0]
    assert np.abs(response.displacement[:2, 0, 0]) == pytest.approx([RADIUS] * 2, rel=1e-9)
    assert np.abs(response.displacement[:2, 1, 0]) == pytest.approx(
        [UNBALANCE / (2.0 * RATIO * MASS)] * 2, rel=1e-6
    )
    steady = client.steady(ROTOR, speed_rpm=[SPEED / RPM], branch=False)
    force = 0.5 * abs(STIFFNESS + 1j * SPEED * DAMPING) * RADIUS
    assert steady.rms_bearing_force == pytest.approx(np.full((1, 2), force), rel=1e-5)


def test_a_geared_rotor_hears_both_shafts(client: LineOfActionClient) -> None:
    response = client.response(EXAMPLES / "geared_rotor_scene.toml", speed_rpm=[1499.2395732], orders=1)
    assert response.order * 328 == pytest.approx([1.0, 328 / 23])
