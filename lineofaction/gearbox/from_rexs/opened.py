"""A gear unit opened from a REXS file: its cases, a scene, load cases and the account of the import.

The account states the fate of each component and attribute of the file ("taken", "derived", "defaulted",
"assumed", "refused") with a reason. The operating points of the file become load cases of the scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from bounds.brief import brief
from lineofaction.gearbox.from_rexs.account import Line
from lineofaction.gearbox.from_rexs.assumptions import Assumption, assumed
from lineofaction.gearbox.from_rexs.gear_train import Train
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.layout import Layout
from lineofaction.gearbox.from_rexs.loads import LoadCase
from lineofaction.gearbox.from_rexs.operating_points import OperatingPoint
from lineofaction.gearbox.from_rexs.power_flow import REPLACED, PowerFlow
from lineofaction.gearbox.from_rexs.refusals import (
    NO_REASON,
    REASONS,
    line_name,
    refusal_texts,
    refused_lines,
)
from lineofaction.gearbox.from_rexs.scene import SceneTable
from lineofaction.gearbox.from_rexs.scene_parts import SceneParts
from lineofaction.gearbox.from_rexs.stage_case import StageCase
from lineofaction.gearbox.from_rexs.unit_files import (
    ACCOUNT_FILE,
    LOAD_CASES_FILE,
    SCENE_FILE,
    account_csv,
    plain_table,
)
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.rexs.upgrade import Change, upgrade
from lineofaction.gearbox.rexs.vocabulary import terms
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.files import side_files
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.schemas.toml import toml_text

_DIGITS = 9
"""Significant digits to which torques are compared: the torques of equal planets differ by rounding of the
statics."""


@brief
@dataclass(frozen=True)
class OpenedUnit:
    """A gear unit as cases and a scene."""

    cases: tuple[StageCase, ...]
    """Cases of the cylindrical stages; equal stages have one case, that of the first."""
    scene: SceneInput | None
    """Scene of the whole unit; its meshes name the case files ``NAME.toml`` of `cases`. None: the file lacks
    what a scene needs, and the account says why.
    """
    load_cases: tuple[LoadCase, ...]
    """Load cases, with torque and speed of the scene's driving shaft; one if the file has no spectrum."""
    lines: tuple[Line, ...]
    """Fate of each component and value."""
    changes: tuple[Change, ...]
    """Changes by the upgrade to the newest version of REXS."""
    parts: SceneParts = field(default_factory=SceneParts)
    """Components of the file by the parts of the scene that they became; empty without a scene."""

    @property
    def omitted(self) -> tuple[str, ...]:
        """The parts of the file that the scene lacks, one sentence for each reason."""
        return refusal_texts(self.lines)

    @property
    def headline(self) -> str:
        """Return one line that names all components left out, with attributes in brackets; empty: none."""
        parts: dict[str, list[str]] = {}
        for line in refused_lines(self.lines):
            parts.setdefault(line_name(line), []).append(line.item)
        brackets = {named: ", ".join(dict.fromkeys(filter(None, items))) for named, items in parts.items()}
        texts = [f"{named} ({items})" if items else named for named, items in brackets.items()]
        return f"left out of the scene: {'; '.join(texts)}" if parts else ""

    def files(self) -> dict[str, str]:
        """Return the texts of the files by their names."""
        files = {f"{case.name}.toml": toml_text(plain_table(case.case)) for case in self.cases}
        if self.scene is not None:
            table, side = side_files(plain_table(self.scene))
            files[SCENE_FILE] = toml_text(table)
            files |= {file.name: file.unpacked().decode() for file in side}
        if self.load_cases:
            files[LOAD_CASES_FILE] = toml_text({"load_cases": [case.table() for case in self.load_cases]})
        files[ACCOUNT_FILE] = account_csv(self.lines)
        return files

    def summary(
        self, fates: tuple[str, ...] = ("refused", "assumed", "defaulted", "derived")
    ) -> Iterator[str]:
        """Yield the lines of the account that an engineer reads, in order of the fates.

        Components of one type with the same fate, attribute and reason share a line.
        """
        groups: dict[tuple[str, str, str, str], list[Line]] = {}
        for line in self.lines:
            if line.fate in fates:
                groups.setdefault((line.fate, line.kind, line.item, line.words), []).append(line)
        for fate, kind, item, reason in sorted(groups, key=lambda key: fates.index(key[0])):
            group = groups[fate, kind, item, reason]
            ids = ", ".join(dict.fromkeys(str(line.component) for line in group))
            name = f' "{group[0].name}"' if len(group) == 1 and group[0].name else ""
            yield f"{fate:9} {kind} {ids}{name}{', ' + item if item else ''}: {reason}"

    @staticmethod
    def of(document: Document, assumptions: Iterable[Assumption] = ()) -> OpenedUnit:
        """Return the cases and the scene of a gear unit.

        The scene runs at the load case of the largest share of the time. Raises `BadInput`: a value has the
        wrong type or unit, or a placement, a section, the version or an assumption is not valid.

        Parameters
        ----------
        document : Document
            Document in any version of REXS.
        assumptions : iterable of Assumption
            Values that replace those of the file, or stand in for missing ones.
        """
        newest, changes = upgrade(document.model)
        model = assumed(newest, assumptions)
        unit = GearUnit(model)
        layout = Layout.of(unit)
        flows = _flows(layout)
        drivers = {s.stage.id: s.gears[flows[0].driver(s)].id for s in layout.stages if flows}
        cases = StageCase.all_of(unit, _torques(layout, flows), drivers)
        table = SceneTable.of(layout, flows, cases) if flows and cases else None
        if not flows:
            unit.say("scene", "refused", "no load case fits the train")
        elif not cases:
            unit.say("scene", "refused", "no stage has a case")
        descriptive = terms("descriptive_components")
        for component in () if table is None else model.components:
            if component.type not in descriptive and not unit.account.has_entry(component):
                unit.part(component.id).say("", "refused", REASONS.get(component.type, NO_REASON))
        scene = None if table is None else _scene(layout, table)
        loads = _load_cases(flows, table)
        parts = SceneParts() if table is None or scene is None else table.parts
        return OpenedUnit(cases, scene, loads, unit.account.lines(), tuple(changes), parts)


def _flows(layout: Layout) -> list[PowerFlow]:
    """Return the flows of power of the load cases, the flow of the largest share first."""
    train = Train.of(layout)
    flows = []
    points = OperatingPoint.all_of(layout.unit)
    for point in points:
        flow = PowerFlow.of(point, layout, train)
        if isinstance(flow, str):
            layout.unit.say(point.name, "refused", flow)
            continue
        for remark in flow.remarks:
            layout.unit.say("torque", "derived", remark)
        for load in flow.replaced:
            layout.unit.part(load).say("torque_around_u_axis", "refused", REPLACED)
        flows.append(flow)
    first = max(range(len(flows)), key=lambda index: flows[index].point.share, default=0)
    return [*flows[first : first + 1], *flows[:first], *flows[first + 1 :]]


def _torques(layout: Layout, flows: Sequence[PowerFlow]) -> Mapping[int, tuple[float, ...]]:
    """Return the torques of the shaft on the driving gear about its u, N m, by stage.

    They are those of the load cases that load the same flanks as the first one.
    """
    torques: dict[int, tuple[float, ...]] = {}
    for stage in layout.stages if flows else ():
        number = flows[0].driver(stage)
        sense = layout.sense(stage.shafts[number].id)
        values = [-sense * flow.on_gear(stage, number) for flow in flows]
        rounded = {float(f"{value:.{_DIGITS}g}") for value in values}
        same_flanks = {value for value in rounded if value * values[0] > 0.0}
        if same_flanks:
            torques[stage.stage.id] = tuple(sorted(same_flanks, key=abs))
        if len(same_flanks) < len(rounded):
            text = "load cases on the other flanks are not in the case: they are load cases of the scene"
            stage.stage.say("torques", "derived", text)
    return torques


def _scene(layout: Layout, table: SceneTable) -> SceneInput | None:
    """Return the validated scene with its omissions; None: it is not valid, and the account says why."""
    omitted = refusal_texts(layout.unit.account.lines())
    try:
        return validated(SceneInput, table.table | ({"left_out": list(omitted)} if omitted else {}))
    except BadInput as error:
        layout.unit.say("scene", "refused", str(error))
        return None


def _load_cases(flows: Sequence[PowerFlow], table: SceneTable | None) -> tuple[LoadCase, ...]:
    """Return the load cases of a scene, each with the forces that differ from those of the scene."""
    if table is None or table.leader is None:
        return ()
    cases = []
    for flow in flows:
        # the scene has the forces of the first flow
        pairs = [(force.entry(flow.point), force.entry(flows[0].point)) for force in table.forces]
        forces = tuple(case_force for case_force, scene_force in pairs if case_force != scene_force)
        cases.append(LoadCase.of(flow, table.leader, forces))
    return tuple(sorted(cases, key=lambda case: case.number))
