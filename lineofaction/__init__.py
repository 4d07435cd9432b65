"""Contact analysis of gears, their dynamics and their noise: the public names of the package.

    import lineofaction as loa

    unit = loa.open_unit("unit.rexs")
    deflected = loa.deflect(unit)

Names are loaded on first use. Gears, bearings and laws are in SI; cases, scenes and inputs of studies have
the units in their names.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from lineofaction.gearbox import registry

if TYPE_CHECKING:
    from dynamics.bearings.rolling_bearing import RollingBearing
    from dynamics.bearings.seat import Bushing
    from dynamics.joints.housing import Housing
    from dynamics.loads.time_law import TimeLaw
    from dynamics.results import RunResult
    from dynamics.scene import Integration, Outputs, PlanetarySet
    from fe_contact import (
        BoreSeat,
        FlankGrid,
        FlankModification,
        Gear,
        GearBlank,
        GearPair,
        InternalGearPair,
        Material,
        PitchDeviation,
        RingGear,
        RunOut,
        SteDatabase,
        Tolerances,
        ToothFlank,
        Wave,
    )
    from fe_contact.types import Estimate
    from lineofaction.client import AsyncLineOfActionClient as AsyncClient
    from lineofaction.client import LineOfActionClient as Client
    from lineofaction.gearbox.from_rexs.opened import OpenedUnit as Unit
    from lineofaction.gearbox.problems import BadInput, JobFailed
    from lineofaction.gearbox.registry import *  # noqa: F403 (its __all__)
    from lineofaction.gearbox.schemas import Case
    from lineofaction.gearbox.schemas.scene import SceneInput as Scene
    from lineofaction.gearbox.workbench import InputWarning, analyze, open_unit, simulate
    from lineofaction.report.document import facts, write
    from lineofaction.report.frames import dataframe
    from lineofaction.report.plots import plot
    from lineofaction.report.readers import read

_HOME = {
    "AsyncClient": ("lineofaction.client", "AsyncLineOfActionClient"),
    "BadInput": ("lineofaction.gearbox.problems", "BadInput"),
    "BoreSeat": ("fe_contact", "BoreSeat"),
    "Bushing": ("dynamics.bearings.seat", "Bushing"),
    "Case": ("lineofaction.gearbox.schemas", "Case"),
    "Client": ("lineofaction.client", "LineOfActionClient"),
    "Estimate": ("fe_contact.types", "Estimate"),
    "dataframe": ("lineofaction.report.frames", "dataframe"),
    "facts": ("lineofaction.report.document", "facts"),
    "FlankGrid": ("fe_contact", "FlankGrid"),
    "FlankModification": ("fe_contact", "FlankModification"),
    "Gear": ("fe_contact", "Gear"),
    "GearBlank": ("fe_contact", "GearBlank"),
    "GearPair": ("fe_contact", "GearPair"),
    "Housing": ("dynamics.joints.housing", "Housing"),
    "Integration": ("dynamics.scene", "Integration"),
    "InternalGearPair": ("fe_contact", "InternalGearPair"),
    "JobFailed": ("lineofaction.gearbox.problems", "JobFailed"),
    "Material": ("fe_contact", "Material"),
    "Outputs": ("dynamics.scene", "Outputs"),
    "PitchDeviation": ("fe_contact", "PitchDeviation"),
    "PlanetarySet": ("dynamics.scene", "PlanetarySet"),
    "plot": ("lineofaction.report.plots", "plot"),
    "read": ("lineofaction.report.readers", "read"),
    "RingGear": ("fe_contact", "RingGear"),
    "RollingBearing": ("dynamics.bearings.rolling_bearing", "RollingBearing"),
    "RunOut": ("fe_contact", "RunOut"),
    "RunResult": ("dynamics.results", "RunResult"),
    "Scene": ("lineofaction.gearbox.schemas.scene", "SceneInput"),
    "SteDatabase": ("fe_contact", "SteDatabase"),
    "TimeLaw": ("dynamics.loads.time_law", "TimeLaw"),
    "Tolerances": ("fe_contact", "Tolerances"),
    "ToothFlank": ("fe_contact", "ToothFlank"),
    "Unit": ("lineofaction.gearbox.from_rexs.opened", "OpenedUnit"),
    "Wave": ("fe_contact", "Wave"),
    "write": ("lineofaction.report.document", "write"),
}
"""Address, as module and name in it, of each public name that belongs neither to a study nor to the
workbench."""

__all__ = [
    "AsyncClient",
    "BadInput",
    "BoreSeat",
    "Bushing",
    "Case",
    "Client",
    "Estimate",
    "FlankGrid",
    "FlankModification",
    "Gear",
    "GearBlank",
    "GearPair",
    "Housing",
    "InputWarning",
    "Integration",
    "InternalGearPair",
    "JobFailed",
    "Material",
    "Outputs",
    "PitchDeviation",
    "PlanetarySet",
    "RingGear",
    "RollingBearing",
    "RunOut",
    "RunResult",
    "Scene",
    "SteDatabase",
    "TimeLaw",
    "Tolerances",
    "ToothFlank",
    "Unit",
    "Wave",
    "analyze",
    "dataframe",
    "facts",
    "open_unit",
    "plot",
    "read",
    "simulate",
    "write",
]
__all__ += registry.__all__


def __getattr__(name: str) -> object:
    """Load a name on first use."""
    if name in registry.FUNCTIONS:
        return registry.FUNCTIONS[name]
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, attribute = _HOME.get(name, ("lineofaction.gearbox.workbench", name))
    value = globals()[name] = getattr(import_module(module), attribute)
    return value


def __dir__() -> list[str]:
    return sorted({*__all__, *registry.FUNCTIONS})
