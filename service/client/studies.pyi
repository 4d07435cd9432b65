# Written by scripts/client_studies.py from service.registry: do not edit.
# fmt: off
# ruff: noqa: E501 (a line for each parameter)
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal

from service.client.jobs import JobClient
from service.client.portable import CaseLike, SceneLike
from service.client.status import Watch

class Studies(JobClient):
    def flank(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        torque_n_m: float | None = ...,
        normal_force_n: float | None = ...,
        misalignment_um: float | None = ...,
        center_distance_change_mm: float | None = ...,
    ) -> dict[str, Any]: ...
    def flank_file(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        torque_n_m: float | None = ...,
        normal_force_n: float | None = ...,
        misalignment_um: float | None = ...,
        center_distance_change_mm: float | None = ...,
    ) -> Path: ...
    def ablate(
        self,
        given: CaseLike | SceneLike,
        progress: Watch | None = None,
        *,
        only: Sequence[str] | None = ...,
    ) -> dict[str, Any]: ...
    def ablate_file(
        self,
        given: CaseLike | SceneLike,
        progress: Watch | None = None,
        *,
        only: Sequence[str] | None = ...,
    ) -> Path: ...
    def frontier(
        self,
        given: CaseLike | SceneLike,
        progress: Watch | None = None,
        *,
        rungs: Sequence[str] | None = ...,
        up_to: Literal["corrected_fine", "3d_draft", "3d_standard", "3d_fine"] = ...,
        full_contact: int | None = ...,
    ) -> dict[str, Any]: ...
    def frontier_file(
        self,
        given: CaseLike | SceneLike,
        progress: Watch | None = None,
        *,
        rungs: Sequence[str] | None = ...,
        up_to: Literal["corrected_fine", "3d_draft", "3d_standard", "3d_fine"] = ...,
        full_contact: int | None = ...,
    ) -> Path: ...
    def sensitivity(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        misalignment_um: Sequence[float] = ...,
        center_distance_change_percent: Sequence[float] = ...,
    ) -> dict[str, Any]: ...
    def sensitivity_file(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        misalignment_um: Sequence[float] = ...,
        center_distance_change_percent: Sequence[float] = ...,
    ) -> Path: ...
    def root_stress(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        torque_n_m: float | None = ...,
        normal_force_n: float | None = ...,
        misalignment_um: float | None = ...,
        center_distance_change_mm: float | None = ...,
    ) -> dict[str, Any]: ...
    def root_stress_file(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        torque_n_m: float | None = ...,
        normal_force_n: float | None = ...,
        misalignment_um: float | None = ...,
        center_distance_change_mm: float | None = ...,
    ) -> Path: ...
    def optimize(
        self,
        case: CaseLike,
        study: Mapping[str, Any],
        progress: Watch | None = None,
    ) -> dict[str, Any]: ...
    def optimize_file(
        self,
        case: CaseLike,
        study: Mapping[str, Any],
        progress: Watch | None = None,
    ) -> Path: ...
    def scatter(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        tolerance_class: int = ...,
        misalignment_um: float = ...,
        distribution: Literal["normal", "uniform"] = ...,
        samples: int = ...,
        seed: int = ...,
    ) -> dict[str, Any]: ...
    def scatter_file(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        tolerance_class: int = ...,
        misalignment_um: float = ...,
        distribution: Literal["normal", "uniform"] = ...,
        samples: int = ...,
        seed: int = ...,
    ) -> Path: ...
    def sweep(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        over: Sequence[str] = ...,
        show: Sequence[Literal["peak_to_peak", "harmonic_1", "harmonic_2", "harmonic_3", "max_pressure", "face_load_factor"]] = ...,
    ) -> dict[str, Any]: ...
    def sweep_file(
        self,
        case: CaseLike,
        progress: Watch | None = None,
        *,
        over: Sequence[str] = ...,
        show: Sequence[Literal["peak_to_peak", "harmonic_1", "harmonic_2", "harmonic_3", "max_pressure", "face_load_factor"]] = ...,
    ) -> Path: ...
    def modes(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float] = ...,
        orders: int = ...,
        highest_frequency_hz: float | None = ...,
    ) -> dict[str, Any]: ...
    def modes_file(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float] = ...,
        orders: int = ...,
        highest_frequency_hz: float | None = ...,
    ) -> Path: ...
    def response(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float],
        orders: int = ...,
    ) -> dict[str, Any]: ...
    def response_file(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float],
        orders: int = ...,
    ) -> Path: ...
    def steady(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float],
        branch: bool = ...,
        repeat: int = ...,
        settling_periods: int = ...,
    ) -> dict[str, Any]: ...
    def steady_file(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float],
        branch: bool = ...,
        repeat: int = ...,
        settling_periods: int = ...,
    ) -> Path: ...
    def study(
        self,
        scene: SceneLike,
        study: Mapping[str, Any],
        progress: Watch | None = None,
    ) -> dict[str, Any]: ...
    def study_file(
        self,
        scene: SceneLike,
        study: Mapping[str, Any],
        progress: Watch | None = None,
    ) -> Path: ...
