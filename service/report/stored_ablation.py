"""An ablation read back from the JSON that it was stored as."""

from __future__ import annotations

import numpy as np

from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import EffectAblation as SceneEffect
from dynamics.ablation import RunFigures
from dynamics.influence import Influence as SceneInfluence
from dynamics.influence.linear_figures import LinearFigures
from fe_contact.analysis.ablation import Ablation, EffectAblation, Figures
from fe_contact.effects.influence import Influence
from service.report.figure import FloatArray
from service.report.stored_ladder import Json
from service.units import UM


def stored_ablation(content: Json) -> Ablation | SceneAblation:
    """Return the ablation in `content` (`ablation_json`).

    What linear theory expects of a whole scene is not stored: it is NaN in the estimates.
    """
    return _of_scene(content) if content["of"] == "scene" else _of_case(content)


def _lengths(values: list[float] | list[list[float]]) -> FloatArray:
    """From um to m."""
    return np.asarray(values, dtype=float) * UM


def _of_case(content: Json) -> Ablation:
    """Return that of a case."""
    return Ablation(
        np.array(content["torque_n_m"], dtype=float),
        np.array(content["normal_force_n"], dtype=float),
        content["misalignment_um"] * UM,
        _case_figures(content["nominal"]),
        tuple(_case_effect(entry) for entry in content["effects"]),
        content["left_out"],
    )


def _case_figures(content: Json) -> Figures:
    """Return what one table says."""
    return Figures(
        _lengths(content["mean_um"]),
        _lengths(content["peak_to_peak_um"]),
        _lengths(content["harmonics_um"]),
        content["cpu_seconds"],
        content["predicted_cpu_seconds"],
    )


def _case_effect(content: Json) -> EffectAblation:
    """Return one effect of a case."""
    return EffectAblation(
        content["name"],
        content["on"],
        content["reason"],
        _case_figures(content["with"]),
        _case_figures(content["without"]),
        _case_estimate(content["estimate"]),
    )


def _case_estimate(content: Json | None) -> Influence | None:
    """Return what the ledger estimated; ablations of older versions hold estimates of another kind."""
    if content is None or "whole_mean_um" not in content:
        return None
    names = ("misalignment", "mean", "peak_to_peak", "whole_mean", "whole_peak_to_peak")
    return Influence(content["torque_n_m"], *(content[f"{name}_um"] * UM for name in names))


def _of_scene(content: Json) -> SceneAblation:
    """Return that of a scene."""
    return SceneAblation(
        tuple(content["mesh"]),
        tuple(content["bearing"]),
        _scene_figures(content["nominal"]),
        tuple(_scene_effect(entry) for entry in content["effects"]),
        content["left_out"],
    )


def _scene_figures(content: Json) -> RunFigures:
    """Return what one run says."""
    return RunFigures(
        _lengths(content["mean_um"]),
        _lengths(content["peak_to_peak_um"]),
        _lengths(content["orders_um"]),
        np.asarray(content["bearing_orders_n"], dtype=float),
        content["cpu_seconds"],
    )


def _scene_effect(content: Json) -> SceneEffect:
    """Return one effect of a scene."""
    told = content["estimate"]
    return SceneEffect(
        content["name"],
        content["on"],
        content["reason"],
        content["worth_um"] * UM,
        None if told is None else _scene_influence(told, on=content["on"]),
        _scene_figures(content["with"]),
        _scene_figures(content["without"]),
    )


def _scene_influence(told: Json, *, on: bool) -> SceneInfluence:
    """Return an estimate."""
    mean, force = _lengths(told["mean_um"]), np.asarray(told["bearing_force_n"], dtype=float)
    unknown, apart = np.full_like(mean, np.nan), np.full_like(force, np.nan)
    freedoms, rows = told["freedoms"], told["rows"]
    return SceneInfluence(
        mean,
        _lengths(told["peak_to_peak_um"]),
        force,
        told["relative_mean"],
        told["relative_peak_to_peak"],
        told["relative_bearing_force"],
        freedoms,
        rows,
        on,
        LinearFigures(unknown, unknown, apart, unknown, freedoms, rows, coasting=False),
    )
