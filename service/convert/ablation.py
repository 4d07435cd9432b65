"""Ablations at the boundary: of a case and of a scene, and their JSON."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import ablate as ablate_scene
from dynamics.effects import EFFECTS as SCENE_EFFECTS
from dynamics.effects import MESH_EFFECTS
from dynamics.scene import Scene
from fe_contact.analysis.ablation import Ablation, ablate
from fe_contact.effects import EFFECTS
from service.convert.case import analysis_arguments, boundary_errors, gear_pair
from service.convert.runs import staged
from service.problems import BadInput
from service.schemas import Case
from service.units import UM

Json = dict[str, Any]
Report = Callable[[str, float], None]
_LEFT_ASIDE = ("receipt", "on_violation", "center_distance_changes")


def ablation_of_case(case: Case, only: Sequence[str] | None, cache: Path | None, report: Report) -> Ablation:
    """Toggle the effects of a case at its nominal center distance.

    Raises
    ------
    BadInput
        No such pair or effect.
    JobFailed
        The case itself cannot be computed.
    """
    pair = gear_pair(case)
    asked = {name: value for name, value in analysis_arguments(case).items() if name not in _LEFT_ASIDE}
    with boundary_errors():
        return ablate(pair, **asked, only=only, progress=report, cache=cache)


def ablation_of_scene(scene: Scene, only: Sequence[str] | None, report: Report) -> SceneAblation:
    """Toggle the effects of a scene; raises as `ablation_of_case`."""
    with boundary_errors():
        return ablate_scene(scene, only, staged(report))


def effects_asked(only: Sequence[str] | None, *, of_scene: bool) -> list[str]:
    """Return the effects that an ablation is asked for, once each, in the order of their registry.

    Raises
    ------
    BadInput
        A name that no effect of a case, or of a scene, has.
    """
    known = [effect.name for effect in EFFECTS]
    if of_scene:
        known = [*(effect.name for effect in SCENE_EFFECTS), *(effect.name for effect in MESH_EFFECTS)]
    for name in only or ():
        if name not in known:
            raise BadInput.of("only", name, f"among {', '.join(known)}", "Or leave it out: all are switched.")
    return [name for name in known if only is None or name in only]


def ablation_json(found: Ablation | SceneAblation) -> Json:
    """Return an ablation with lengths in um."""
    return {"of": "case" if isinstance(found, Ablation) else "scene", **in_um(found.to_json())}


def in_um(value: Any, *, meters: bool = False) -> Any:
    """Turn every field that ends in _m (and no torque) into one that ends in _um."""
    if isinstance(value, dict):
        return dict(_field(name, inner) for name, inner in value.items())
    if isinstance(value, list):
        return [in_um(inner, meters=meters) for inner in value]
    return value / UM if meters and value is not None else value


def _field(name: str, value: Any) -> tuple[str, Any]:
    """One field."""
    meters = name.endswith("_m") and not name.endswith("_n_m")
    return (f"{name.removesuffix('_m')}_um" if meters else name), in_um(value, meters=meters)
