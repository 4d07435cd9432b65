"""Forced response of a scene: amplitudes by order."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.linearize import ForcedResponse, peaks
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.computation import Means, SceneStudy, array_file
from lineofaction.gearbox.studies.cost import StudyCost
from lineofaction.gearbox.studies.excitations import order_names, with_scene_metadata
from lineofaction.gearbox.studies.figures import Row, rows
from lineofaction.gearbox.studies.housings import predicted_response, response_of
from lineofaction.gearbox.studies.response import Inputs, ResponseFigures


class _ResponseStudy(SceneStudy[Inputs, ResponseFigures, ForcedResponse]):
    inputs, answer, file = Inputs, ResponseFigures, array_file(ForcedResponse)

    def predicted(self, scene: SceneInput, inputs: Inputs, _cache: Path | None) -> StudyCost | None:
        return predicted_response(scene, inputs)

    def compute(self, subject: TabledScene, inputs: Inputs, means: Means) -> ForcedResponse:
        steady = subject.steady
        return with_scene_metadata(response_of(steady, inputs, means), steady)

    def _derived(self, response: ForcedResponse) -> Json:
        force, power = response.bearing_force, response.power
        sinks = zip(power.sink, power.kind, power.loss, strict=True)
        return {
            "order_name": order_names(response.order, response.metadata),
            "meshes": {name: _mesh(row) for name, row in rows(response, response.mesh).items()},
            "bearings": {
                name: {"force": np.sqrt(np.sum(np.abs(force[b, :3]) ** 2, axis=0)).T, **_rms(response, b)}
                for b, name in enumerate(response.bearing)
            },
            "peaks": peaks(response),
            "parting": response.speed[~response.in_contact],
            "power": {
                "input": {name: watts.T for name, watts in zip(power.source, power.input, strict=True)},
                "losses": [{"part": name, "kind": kind, "loss": watts.T} for name, kind, watts in sinks],
                "residual": power.residual,
            },
        }


def _mesh(row: Row) -> tuple[Any, ...]:
    """Return a mesh with its amplitudes by order, then by speed."""
    return row, {
        "static_transmission_error": np.abs(row.static_transmission_error),
        "load_moment": np.abs(row.load_moment),
        "friction_force": np.abs(row.friction_force),
        "dynamic_transmission_error": np.abs(row.dynamic_transmission_error).T,
        "mesh_force": np.abs(row.mesh_force).T,
    }


def _rms(response: ForcedResponse, bearing: int) -> Json:
    """Return root mean squares of all orders of a bearing force together by speed, N."""
    square = response.bearing_mean_square[bearing]
    omitted = error = np.zeros(square.size)
    if response.bearing_floor.size:
        omitted = response.bearing_floor[bearing]
    if response.bearing_floor_error.size:
        error = response.bearing_floor_error[bearing]
    rms = np.sqrt(square)
    minimum = np.sqrt(np.maximum(square - error, 0.0))
    return {"rms": rms, "left_out_rms": np.sqrt(omitted), "rms_error": rms - minimum}


RUN = _ResponseStudy()
