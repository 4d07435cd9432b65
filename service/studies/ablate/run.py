"""Ablation of a case or a scene."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import EffectAblation as SceneEffect
from dynamics.ablation import RunFigures
from dynamics.ablation import ablate as ablate_scene
from dynamics.effects import EFFECTS as SCENE_EFFECTS
from dynamics.influence import Influence as SceneInfluence
from dynamics.influence.linear_figures import LinearFigures
from dynamics.scene import Scene
from fe_contact.analysis.ablation import Ablation, EffectAblation, Figures, ablate
from fe_contact.effects import EFFECTS
from fe_contact.effects.influence import Influence
from fe_contact.options import Run
from service.convert.case import analysis_options, boundary_errors, gear_pair, table_axes
from service.convert.checks import check_case
from service.problems import BadInput
from service.schemas import Case
from service.schemas.scene import SceneInput
from service.studies.ablate import Inputs
from service.studies.computation import Computation, Means
from service.units import UM, in_um

Json = dict[str, Any]


def ablation_of(subject: Case | Scene, inputs: Inputs, means: Means) -> Ablation | SceneAblation:
    """Toggle the effects of a case, at its nominal center distance, or of a scene.

    Raises
    ------
    BadInput
        No such pair or effect.
    JobFailed
        The case itself cannot be computed.
    """
    with boundary_errors():
        if isinstance(subject, Scene):
            return ablate_scene(subject, inputs.only, lambda done, _: means.report("ablation", done))
        run = Run(cache=means.home / "compliance", progress=means.report)
        axes, options = table_axes(subject), analysis_options(subject)
        return ablate(gear_pair(subject), axes, options, run, only=inputs.only)


def check(subject: Case | SceneInput, inputs: Inputs) -> None:
    """Refuse a case that cannot be, and an effect that there is not."""
    if isinstance(subject, Case):
        check_case(subject)
    effects_asked(inputs.only, of_scene=not isinstance(subject, Case))


def effects_asked(only: Sequence[str] | None, *, of_scene: bool) -> list[str]:
    """Return the effects that an ablation is asked for, once each, in the order of their registry.

    Raises
    ------
    BadInput
        A name that no effect of a case, or of a scene, has.
    """
    known = [effect.name for effect in EFFECTS]
    if of_scene:
        known = [effect.name for effect in SCENE_EFFECTS]
    for name in only or ():
        if name not in known:
            raise BadInput.of("only", name, f"among {', '.join(known)}", "Or leave it out: all are toggled.")
    return [name for name in known if only is None or name in only]


def normalized(subject: Case | SceneInput, inputs: Inputs) -> Json:
    """Return the effects in the order of their registry."""
    return {"only": effects_asked(inputs.only, of_scene=not isinstance(subject, Case))}


def facts(found: Ablation | SceneAblation) -> Json:
    """Return an ablation with lengths in um."""
    return {"of": "case" if isinstance(found, Ablation) else "scene", **in_um(found.to_json())}


def read(file: Path) -> Ablation | SceneAblation:
    """Return the ablation in a file of `facts`.

    What linear theory expects of a whole scene is not stored: it is NaN in the estimates.
    """
    content = json.loads(file.read_text(encoding="utf-8"))
    return _of_scene(content) if content["of"] == "scene" else _of_case(content)


def _lengths(values: list[float] | list[list[float]]) -> NDArray[np.float64]:
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


RUN = Computation(
    ablation_of,
    facts,
    read,
    marks=dict.fromkeys(("of", "nominal", "effects")),
    check=check,
    normalized=normalized,
)
