"""Open a gear unit: from a REXS document to cases, a scene, load cases and the account of the import."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from lineofaction.gearbox.from_rexs.account import Line
from lineofaction.gearbox.from_rexs.assumption import Assumption, assumed
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.layout import Layout, layout_of
from lineofaction.gearbox.from_rexs.left_out import say_left_out, statements
from lineofaction.gearbox.from_rexs.load_case import LoadCase, load_case
from lineofaction.gearbox.from_rexs.operating_points import operating_points
from lineofaction.gearbox.from_rexs.power_flow import REPLACED, PowerFlow, power_flow
from lineofaction.gearbox.from_rexs.scene import SceneTable, scene_table
from lineofaction.gearbox.from_rexs.scene_loads import AppliedTorque
from lineofaction.gearbox.from_rexs.scene_parts import SceneParts
from lineofaction.gearbox.from_rexs.stage_case import StageCase, stage_cases
from lineofaction.gearbox.from_rexs.train import train_of
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs import Change, Document, upgrade
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput

_DIGITS = 9
"""Of torques: those of equal planets agree to the rounding of the statics."""


@dataclass(frozen=True)
class OpenedUnit:
    """A gear unit as cases and a scene.

    Attributes
    ----------
    cases : tuple of StageCase
        The cylindrical stages; of equal ones the first.
    scene : SceneInput or None
        The whole unit; its meshes name the case files ``NAME.toml`` of `cases`. None where the file has not
        what a scene needs: the account says why.
    load_cases : tuple of LoadCase
        Of the scene's driving shaft; one without a spectrum.
    lines : tuple of Line
        What became of each component and value.
    changes : tuple of Change
        What the upgrade to the newest version of REXS changed.
    parts : SceneParts
        The components that the parts of the scene are; none without a scene.
    """

    cases: tuple[StageCase, ...]
    scene: SceneInput | None
    load_cases: tuple[LoadCase, ...]
    lines: tuple[Line, ...]
    changes: tuple[Change, ...]
    parts: SceneParts = field(default_factory=SceneParts)

    @property
    def left_out(self) -> tuple[str, ...]:
        """What the file has and the scene has not, a sentence for each reason; as the scene states it."""
        return statements(self.lines)


def opened(document: Document, assumptions: Iterable[Assumption] = ()) -> OpenedUnit:
    """Return the cases and the scene of a gear unit.

    The scene runs at the load case of the largest share of the time.

    Parameters
    ----------
    document : Document
        Of any version of REXS.
    assumptions : iterable of Assumption
        Values over those of the file.

    Raises
    ------
    BadInput
        A value has the wrong type or unit, or a place, a section, the version or an assumption is none.
    """
    model, changes = upgrade(document.model)
    unit = GearUnit(assumed(model, assumptions))
    layout = layout_of(unit)
    flows = _flows(layout)
    cases = stage_cases(unit, _torques(layout, flows), _drivers(layout, flows))
    table = scene_table(layout, flows, cases) if flows and cases else None
    _say_missing(layout, flows, cases)
    if table is not None:
        say_left_out(unit)
    scene = None if table is None else _scene(layout, table)
    loads = _load_cases(flows, table)
    parts = SceneParts() if table is None or scene is None else table.parts
    return OpenedUnit(cases, scene, loads, unit.account.lines(), tuple(changes), parts)


def _flows(layout: Layout) -> list[PowerFlow]:
    """Return the flows of power of the load cases, that of the largest share first."""
    train = train_of(layout.stages, layout.rotors)
    flows = []
    points = operating_points(layout.unit)
    for point in points:
        flow = power_flow(point, layout, train)
        if isinstance(flow, str):
            _say(layout, point.name, "refused", flow)
            continue
        for remark in flow.remarks:
            _say(layout, "torque", "derived", remark)
        for load in flow.replaced:
            layout.unit.part(load).say("torque_around_u_axis", "refused", REPLACED)
        flows.append(flow)
    first = max(range(len(flows)), key=lambda index: flows[index].point.share, default=0)
    return [*flows[first : first + 1], *flows[:first], *flows[first + 1 :]]


def _drivers(layout: Layout, flows: Sequence[PowerFlow]) -> dict[int, int]:
    return {s.stage.id: s.gears[flows[0].driver(s)].id for s in layout.stages} if flows else {}


def _torques(layout: Layout, flows: Sequence[PowerFlow]) -> Mapping[int, tuple[float, ...]]:
    """Return the torques of the shaft on the driving gear about its u, N m, by stage.

    Of all load cases whose flanks are those of the first.
    """
    torques: dict[int, tuple[float, ...]] = {}
    for stage in layout.stages if flows else ():
        number = flows[0].driver(stage)
        sense = layout.sense(stage.shafts[number].id)
        values = [-sense * flow.on_gear(stage, number) for flow in flows]
        same = {float(f"{value:.{_DIGITS}g}") for value in values if value * values[0] > 0.0}
        if same:
            torques[stage.stage.id] = tuple(sorted(same, key=abs))
        if len(same) < len({float(f"{value:.{_DIGITS}g}") for value in values}):
            words = "load cases on the other flanks are not in the case: they are load cases of the scene"
            stage.stage.say("torques", "derived", words)
    return torques


def _scene(layout: Layout, table: SceneTable) -> SceneInput | None:
    """Return the validated scene, marked by what is left out; None if the account says what it lacks."""
    left_out = statements(layout.unit.account.lines())
    try:
        return validated(SceneInput, table.table | ({"left_out": list(left_out)} if left_out else {}))
    except BadInput as error:
        _say(layout, "scene", "refused", str(error))
        return None


def _load_cases(flows: Sequence[PowerFlow], table: SceneTable | None) -> tuple[LoadCase, ...]:
    if table is None or table.leader is None:
        return ()
    leader: AppliedTorque = table.leader
    cases = [
        load_case(flow, leader, _torque(flow, leader), leader.torque, _forces(flow, flows[0], table))
        for flow in flows
    ]
    order = sorted(range(len(flows)), key=lambda index: flows[index].point.number)
    return tuple(cases[index] for index in order)


def _forces(flow: PowerFlow, scene: PowerFlow, table: SceneTable) -> tuple[dict[str, Any], ...]:
    """Return the tables of the forces that are others at an operating point than at the scene's."""
    both = [(force.stated(flow.point), force.stated(scene.point)) for force in table.forces]
    return tuple(own for own, of_scene in both if own != of_scene)


def _torque(flow: PowerFlow, leader: AppliedTorque) -> float:
    """Return the torque of the leader at an operating point, N m about z."""
    return flow.loads.get(leader.part.id, leader.torque)


def _say_missing(layout: Layout, flows: Sequence[PowerFlow], cases: Sequence[StageCase]) -> None:
    """State why there is no scene."""
    if not flows:
        _say(layout, "scene", "refused", "no load case fits the train")
    elif not cases:
        _say(layout, "scene", "refused", "no stage has a case")


def _say(layout: Layout, item: str, fate: str, words: str) -> None:
    """State something of the whole unit."""
    for part in layout.unit.of_type("gear_unit")[:1]:
        part.say(item, fate, words)  # type: ignore[arg-type]
