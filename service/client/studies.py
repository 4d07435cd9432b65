"""Studies of cases and scenes by a service: each submits, waits and fetches."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from service.client.jobs import JobClient
from service.client.portable import CaseLike, SceneLike, case_of, inputs_of, scene_inputs
from service.client.status import Watch


class Studies(JobClient):
    """Studies of cases and scenes by a service: each submits, waits and fetches."""

    def flank_file(self, case: CaseLike, progress: Watch | None = None, **point: float) -> Path:
        """Return the file of a case's flank results: submit, wait, fetch.

        Parameters
        ----------
        case : Case, mapping or Path
        progress : callable, optional
        **point : float
            ``torque_n_m`` or ``normal_force_n``, ``misalignment_um``, ``center_distance_change_mm``; what is
            left out is taken from the case. Read the file with `fe_contact.LoadDistribution.from_netcdf`.
        """
        return self._study("flank", case, progress, point)

    def sensitivity_file(
        self, case: CaseLike, progress: Watch | None = None, **deviations: Sequence[float]
    ) -> Path:
        """Return the file of a case's sensitivity study: submit, wait, fetch.

        Parameters
        ----------
        case : Case, mapping or Path
        progress : callable, optional
        **deviations : sequence of float
            ``misalignment_um``, ``center_distance_change_percent``. ``loa report`` draws the file.
        """
        return self._study(
            "sensitivity", case, progress, {name: list(values) for name, values in deviations.items()}
        )

    def ablate(
        self,
        given: CaseLike | SceneLike,
        progress: Watch | None = None,
        *,
        only: Sequence[str] | None = None,
    ) -> dict[str, Any]:
        """Return what each effect of a case or a scene changes: submit, wait, fetch.

        Parameters
        ----------
        given : Case, SceneInput, mapping or Path
            A scene is told by its shafts.
        progress : callable, optional
        only : sequence of str, optional
            Effects to toggle; default all.

        Returns
        -------
        dict
            As ``loa ablate --json`` prints it, lengths in um.
        """
        return self._json("ablate", given, progress, {} if only is None else {"only": list(only)})

    def frontier(
        self,
        given: CaseLike | SceneLike,
        progress: Watch | None = None,
        *,
        rungs: Sequence[str] | None = None,
        full_contact: int | None = None,
    ) -> dict[str, Any]:
        """Return the error of each rung of the accuracy ladder against its time: submit, wait, fetch.

        Parameters
        ----------
        given : Case, SceneInput, mapping or Path
            A scene is told by its shafts.
        progress : callable, optional
        rungs : sequence of str, optional
            Rungs to run, at least two; default all that are valid.
        full_contact : int, optional
            Positions of a case, 1 to 64, at which full finite-element contact is run beside the ladder.

        Returns
        -------
        dict
            As ``loa frontier --json`` prints it; times are those of the service's machine.
        """
        asked: dict[str, Any] = {} if rungs is None else {"rungs": list(rungs)}
        beside = {} if full_contact is None else {"full_contact": full_contact}
        return self._json("frontier", given, progress, asked | beside)

    def optimise(
        self, case: CaseLike, study: Mapping[str, Any], progress: Watch | None = None
    ) -> dict[str, Any]:
        """Return the micro-geometry of least transmission error: submit, wait, fetch.

        Parameters
        ----------
        case : Case, mapping or Path
            Its modifications are the start.
        study : mapping
            Variables, scatter, objective, limits and search, as in the file of ``loa optimise``.
        progress : callable, optional

        Returns
        -------
        dict
            As ``loa optimise --json`` prints it.
        """
        return self._json("optimise", case_of(case), progress, dict(study))

    def scatter(self, case: CaseLike, progress: Watch | None = None, **sampling: Any) -> dict[str, Any]:
        """Return how peak-to-peak STE is distributed within tolerances: submit, wait, fetch.

        Parameters
        ----------
        case : Case, mapping or Path
            Its modifications are the design.
        progress : callable, optional
        **sampling
            ``tolerance_class`` (ISO 1328-1:2013), ``misalignment_um``, ``distribution``, ``samples``,
            ``seed``; what is left out has the default of ``loa scatter``.

        Returns
        -------
        dict
            As ``loa scatter --json`` prints it, every pair included.
        """
        return self._json("scatter", case_of(case), progress, sampling)

    def modes_file(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float] = (),
        orders: int = 10,
        highest_frequency_hz: float | None = None,
    ) -> Path:
        """Return the file of a scene's modal analysis: submit, wait, fetch.

        Parameters
        ----------
        scene : SceneInput, mapping or Path
        progress : callable, optional
        speed_rpm : sequence of float
            Of the first driven shaft, increasing; empty: modes at rest only.
        orders : int
            Multiples of the mesh frequencies. Read the file with
            `dynamics.linearize.ModalAnalysis.from_netcdf`.
        highest_frequency_hz : float, optional
            To which shafts are resolved; left out: the highest of the orders at the highest speed.
        """
        study = {"speed_rpm": list(speed_rpm), "orders": orders, "highest_frequency_hz": highest_frequency_hz}
        return self._scene_study("modes", scene, progress, study)

    def response_file(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float],
        orders: int = 10,
    ) -> Path:
        """Return the file of a scene's forced response over speeds: submit, wait, fetch.

        As `modes_file`; read it with `dynamics.linearize.ForcedResponse.from_netcdf`.
        """
        return self._scene_study(
            "response", scene, progress, {"speed_rpm": list(speed_rpm), "orders": orders}
        )

    def steady_file(
        self,
        scene: SceneLike,
        progress: Watch | None = None,
        *,
        speed_rpm: Sequence[float],
        branch: bool = True,
        repeat: int = 1,
        settling_periods: int = 64,
    ) -> Path:
        """Return the file of a scene's periodic steady states over speeds: submit, wait, fetch.

        As `modes_file`; read it with `dynamics.periodic.SteadyStates.from_netcdf`.
        """
        further = {"speed_rpm": list(speed_rpm), "branch": branch, "repeat": repeat}
        return self._scene_study("steady", scene, progress, further | {"settling_periods": settling_periods})

    def _scene_study(
        self, process: str, scene: SceneLike, progress: Watch | None, further: dict[str, Any]
    ) -> Path:
        """Submit a scene with further inputs, wait, fetch the file."""
        result = self.obtain(process, scene_inputs(scene) | further, progress)
        return self.fetch_file(result.key, result.kind)

    def _json(
        self,
        process: str,
        given: CaseLike | SceneLike,
        progress: Watch | None,
        further: dict[str, Any],
    ) -> dict[str, Any]:
        """Submit a case or a scene with further inputs, wait, read the JSON."""
        result = self.obtain(process, inputs_of(given) | further, progress)
        found: dict[str, Any] = json.loads(self.fetch_file(result.key, result.kind).read_bytes())
        return found

    def _study(self, process: str, case: CaseLike, progress: Watch | None, further: dict[str, Any]) -> Path:
        """Submit a case with further inputs, wait, fetch the file."""
        inputs = {"case": case_of(case).model_dump(mode="json"), **further}
        result = self.obtain(process, inputs, progress)
        return self.fetch_file(result.key, result.kind)
