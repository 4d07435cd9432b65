"""Inputs of studies of housings: surfaces, bearing forces of the response or of a run, and costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, replace
from functools import partial

import numpy as np

from bounds.types import Json
from dynamics.acoustics import PanelModel
from dynamics.assembly.assemble import System, assemble
from dynamics.errors import InputError, SolveError
from dynamics.housings import ReducedHousing
from dynamics.influence import decide_effects, response_influences, sized_ledger
from dynamics.influence.neglected_check import response_cost
from dynamics.linearize import ForcedResponse, forced_response
from dynamics.noise import HousingRadiation, cached_radiation
from dynamics.orders import BearingOrders, bearing_orders
from dynamics.results.other_housings import other_housings
from dynamics.scene import Scene
from dynamics.settings.level_quantity import LevelQuantity
from dynamics.types import FloatArray
from dynamics.vibration import ReportedHarmonics
from host import cpu_seconds
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.housings import FOLDER
from lineofaction.gearbox.convert.scene import TabledScene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.figures import LINEAR
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.studied import OverOrders, OverSpeedsOrRun
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.cost import StudyCost, Work
from lineofaction.gearbox.studies.excitations import excitations_of
from lineofaction.gearbox.studies.scene_before_tables import scene_before_tables, sized
from lineofaction.gearbox.units import RPM

REMEDY = (
    "Give a housing by step_file, mesh_file or modes_file: matrices alone do not say what the air touches. "
    'In the scene, step_file = "housing.step" stands in place of its stiffness_matrix.'
)


def radiation_of(
    body: ReducedHousing, model: PanelModel, frequency: FloatArray, means: Means
) -> HousingRadiation:
    """Return the radiation of a housing by a model at frequencies, Hz, from the cache where it is known."""
    return cached_radiation(
        body,
        model,
        frequency.ravel(),
        cache=means.home / FOLDER,
        progress=means.report,
        workers=means.workers,
    )


def bearing_forces(
    subject: TabledScene, inputs: OverOrders, means: Means, quantity: LevelQuantity | None = None
) -> ReportedHarmonics:
    """Return the orders of the bearing forces: in the run if there is one, else in the linear response.

    `forces` of the metadata names the source of the forces, and for a run states the errors by its windows
    (`_run_forces`). `quantity` sizes the effects of the linear response, as in `response_of`.
    """
    if means.run is None:
        response = response_of(subject, inputs, means, quantity)
        return replace(response, metadata=response.metadata | {"forces": LINEAR})
    began = cpu_seconds()
    with boundary_errors():
        orders = bearing_orders(means.run, inputs.orders)
    seconds = {"orders": cpu_seconds() - began}
    forces = _run_forces(orders) | {"other_housings": list(other_housings(subject.scene.housings, means.run))}
    return replace(orders, metadata=orders.metadata | {"forces": forces, "seconds": seconds})


def _run_forces(orders: BearingOrders) -> Json:
    """Return the windows of a run, over which its orders are averaged, with their errors.

    `smearing` is the relative error of an amplitude by the change of speed in a window, by order, then by
    window; None where the run does not state it.
    """
    smearing_known = bool(np.all(np.isfinite(orders.smearing)))
    return {
        "source": "run",
        "time_s": orders.time.tolist(),
        "window_pitches": orders.metadata["pitches"],
        "windows_left_out": orders.metadata["windows_left_out"],
        "speed_change": orders.sweep.tolist(),
        "smearing": orders.smearing.T.tolist() if smearing_known else None,
        "remainder": dict(zip(orders.bearing, orders.remainder.tolist(), strict=True)),
    }


def response_of(
    subject: TabledScene, inputs: OverOrders, means: Means, quantity: LevelQuantity | None = None
) -> ForcedResponse:
    """Return the `sized_response` of a scene; its metadata also list the `excitations`.

    The influence of effects is that on `quantity`, by default on the quantity that the scene names.
    """
    scene = subject.scene if quantity is None else replace(subject.scene, quantity=quantity)
    response, system = sized_response(scene, inputs, means)
    excitations = [asdict(excitation) for excitation in excitations_of(response, system, subject)]
    return replace(response, metadata=response.metadata | {"excitations": excitations})


def sized_response(scene: Scene, inputs: OverOrders, means: Means) -> tuple[ForcedResponse, System]:
    """Return the forced response of a scene and its system, with the effects that its tolerance decides.

    The effect ledger in the metadata states the influence of each effect.
    """
    speed = np.array([value * RPM for value in inputs.speed_rpm])
    sized = partial(response_influences, speed=speed)
    with boundary_errors():
        decision = decide_effects(scene, sized)
        system = assemble(decision.scene)
        response = forced_response(
            system, speed, inputs.orders, progress=lambda fraction: means.report("response", fraction)
        )
        began = cpu_seconds()
        influences = decision.influences or sized(decision.scene)
    seconds = cpu_seconds() - began + decision.taken.cpu_seconds
    metadata = response.metadata
    ledger = sized_ledger(metadata["effect_ledger"], decision.automatic, influences)
    additions = {"effect_ledger": ledger, "seconds": {**metadata["seconds"], "influence_estimates": seconds}}
    return replace(response, metadata=metadata | additions), system


def predicted_response(
    scene: SceneInput, inputs: OverOrders, further: Callable[[Scene], int] | None = None
) -> StudyCost | None:
    """Return the predicted cost of the `sized_response` of a scene whose tables are not yet computed.

    None: the scene cannot be assembled without its tables. `further` returns the number of additional
    responses, of varied scenes. The number of modes of a solid housing is known only after its reduction, so
    their cost is left out. Raises `BadInput`: the scene is not valid.
    """
    with boundary_errors():
        before = scene_before_tables(scene)
    if before is None:
        return None
    speed = np.array(inputs.speed_rpm) * RPM
    try:
        system = sized(scene)
        cost = response_cost(system, speed, inputs.orders)
    except (InputError, SolveError):
        return None  # the study says it, on its own tables
    systems = Work("systems with or without an effect", cost.system, cost.systems)
    parts = Work("speeds", cost.speed, speed.size), systems
    if further is None:
        return StudyCost(parts)
    began = cpu_seconds()
    assemble(before)
    per_response = cpu_seconds() - began + speed.size * cost.speed
    return StudyCost((*parts, Work("responses of the band", per_response, further(before))))


def predicted_forces(
    scene: SceneInput, inputs: OverSpeedsOrRun, further: Callable[[Scene], int] | None = None
) -> StudyCost | None:
    """Return the cost of the `bearing_forces`, as `predicted_response`; None: the forces come from a run."""
    return predicted_response(scene, inputs, further) if inputs.run is None else None


def no_surface(housings: list[str]) -> BadInput:
    """Return the error of housings of which none has a surface, by their names."""
    return BadInput.of("housings", housings, "at least one with a surface", REMEDY)


def require_surface(scene: SceneInput) -> None:
    """Refuse a scene of whose housings none can have a surface; raises `BadInput`."""
    if not any(part.has_surface for part in scene.housings):
        raise no_surface([part.name for part in scene.housings])
