"""Gear units with one fault each, as text of their files."""

import re
from collections.abc import Callable
from pathlib import Path

from rexs_unit import planetary

from lineofaction.gearbox.rexs.files import serialized

TWO_STAGE = (Path(__file__).parents[2] / "examples" / "two_stage" / "two_stage.rexs").read_text("utf-8")
PLANETARY = serialized(planetary(), "unit.rexs").decode()

Edit = Callable[[str], str]
STAGE_22 = ("cylindrical_stage 22", "shaft 5", "cylindrical_gear 13", "cylindrical_gear 14")
BEHIND = (*STAGE_22, "rolling_bearing_with_detailed_geometry 35", "rolling_bearing_with_detailed_geometry 36")
BEHIND += ("external_load 42",)


def value(number: int, name: str, text: str) -> Edit:
    return _once(rf'(<component id="{number}".*?<attribute id="{name}"[^>]*>)[^<]*(<)', rf"\g<1>{text}\g<2>")


def more(number: int, attribute: str) -> Edit:
    return _once(rf'(<component id="{number}"[^>]*)/?>', rf"\g<1>>{attribute}")


def without(number: int, name: str) -> Edit:
    return _once(rf'(<component id="{number}".*?)<attribute id="{name}"[^>]*>[^<]*</attribute>', r"\g<1>")


def unrelated(kind: str, number: int) -> Edit:
    return _once(
        rf'<relation id="\d+" type="{kind}"[^>]*>\s*(<ref [^>]*/>\s*)*<ref id="{number}" [^>]*/>\s*'
        r"(<ref [^>]*/>\s*)*</relation>",
        "",
    )


def retyped(number: int, kind: str) -> Edit:
    return _once(rf'(<component id="{number}" type=")\w+', rf"\g<1>{kind}")


def added(component: str) -> Edit:
    return _once(r"(?=\s*</components>)", component)


def removed(number: int) -> Edit:
    """Return what removes a component, whose relations stay."""
    return _once(rf'<component id="{number}".*?</component>', "")


def all_of(*edits: Edit) -> Edit:
    def edit(text: str) -> str:
        for each in edits:
            text = each(text)
        return text

    return edit


def _once(pattern: str, text: str) -> Edit:
    def edit(file: str) -> str:
        changed, count = re.subn(pattern, text, file, count=1, flags=re.DOTALL)
        assert count == 1 and changed != file, pattern
        return changed

    return edit


SHAPE = '<attribute id="shape_of_relief" unit="none">wavy</attribute>'
SPECTRUM = (
    '<load_spectrum id="2"><load_case id="1"><component id="3" type="shaft"/></load_case></load_spectrum>'
)
MASS = (
    '<component id="90" type="additional_mass">'
    '<attribute id="mass_of_component" unit="kg">2</attribute></component>'
)

LEFT_OUT: dict[str, tuple[str, Edit, tuple[str, ...]]] = {
    "hand of a wheel": (TWO_STAGE, value(14, "helix_angle_reference_diameter", "-16"), BEHIND),
    "hand of a pinion": (
        TWO_STAGE,
        value(11, "helix_angle_reference_diameter", "-22"),
        ("cylindrical_stage 21", "shaft 3", "cylindrical_gear 11", "cylindrical_gear 12", "external_load 41"),
    ),
    "helix angle": (TWO_STAGE, value(14, "helix_angle_reference_diameter", "17"), BEHIND),
    "module": (TWO_STAGE, value(14, "normal_module", "3.5"), BEHIND),
    "zero face width": (TWO_STAGE, value(13, "face_width", "0"), BEHIND),
    "a unit of another quantity": (
        TWO_STAGE,
        _once('(id="14" type="cylindrical_gear".*?"normal_module" unit=")mm', r"\g<1>deg"),
        BEHIND,
    ),
    "no number of teeth": (TWO_STAGE, without(14, "number_of_teeth"), BEHIND),
    "unknown law of a relief": (
        TWO_STAGE,
        all_of(without(413, "shape_of_relief"), more(413, SHAPE)),
        BEHIND,
    ),
    "center distance": (TWO_STAGE, value(22, "center_distance", "150"), ("cylindrical_stage 22",)),
    "shafts too far apart": (
        TWO_STAGE,
        _once(r"(id=\"5\" type=\"shaft\".*?<c>95.5</c><c>)149<", r"\g<1>150<"),
        ("cylindrical_stage 22", "cylindrical_gear 14"),
    ),
    "no relation of a stage": (TWO_STAGE, unrelated("stage", 22), BEHIND),
    "a stage of another kind": (TWO_STAGE, retyped(22, "bevel_stage"), ("bevel_stage 22", *BEHIND[1:])),
    "a gear on no shaft": (TWO_STAGE, unrelated("assembly", 14), BEHIND),
    "a gear in no stage": (
        TWO_STAGE,
        added('<component id="91" type="cylindrical_gear" name="idler"/>'),
        ('cylindrical_gear 91 "idler"',),
    ),
    "a shaft that is not parallel": (
        TWO_STAGE,
        _once(
            r'(id="5" type="shaft".*?u_axis_vector"[^>]*><array>)<c>1</c><c>0</c>', r"\g<1><c>0</c><c>1</c>"
        ),
        BEHIND,
    ),
    "a bearing without seat": (
        TWO_STAGE,
        unrelated("side", 36),
        ("rolling_bearing_with_detailed_geometry 36",),
    ),
    "a bearing of an unknown kind": (TWO_STAGE, retyped(35, "magnetic_bearing"), ("magnetic_bearing 35",)),
    "a bearing of an unknown type": (
        TWO_STAGE,
        value(36, "bearing_type", "square_roller_bearing"),
        ("rolling_bearing_with_detailed_geometry 36",),
    ),
    "a load on no shaft": (TWO_STAGE, unrelated("assembly", 41), ("external_load 41",)),
    "no shaft": (
        TWO_STAGE,
        all_of(*[unrelated("assembly", 5)] * 5, *[unrelated("side", 5)] * 2, removed(5)),
        tuple(part for part in BEHIND if part != "shaft 5"),
    ),
    "torque at one end": (TWO_STAGE, all_of(unrelated("assembly", 42), removed(42)), ("shaft 5",)),
    "torques that do not balance": (
        TWO_STAGE,
        more(42, '<attribute id="torque_around_u_axis" unit="N m">5</attribute>'),
        ("external_load 42",),
    ),
    "speeds against the ratios": (
        TWO_STAGE,
        more(5, '<attribute id="rotational_speed" unit="1 / min">1</attribute>'),
        ("gear_unit 1",),
    ),
    "a mass on no shaft": (TWO_STAGE, added(MASS), ("additional_mass 90",)),
    "a housing of no casing": (TWO_STAGE, unrelated("reference", 50), ("assembly_group 50",)),
    "a second spectrum": (TWO_STAGE, _once(r"(?=</model>)", SPECTRUM), ("shaft 3",)),
    "no planet carrier": (PLANETARY, unrelated("planet_carrier_shaft", 20), ("planetary_stage 20", "scene")),
    "a planet unlike the others": (
        PLANETARY,
        value(14, "face_width", "15.0"),
        ("cylindrical_stage 22", "cylindrical_stage 25"),
    ),
}
"""File, edit, and parts that its scene has not."""
REFUSED: dict[str, tuple[str, Edit, str]] = {
    "a relation to nothing": (TWO_STAGE, removed(5), "= 5: must be the id of a component"),
    "an end that is missing": (TWO_STAGE, lambda text: text[: len(text) // 2], "well-formed"),
    "a version of its own": (
        TWO_STAGE,
        lambda text: text.replace('version="2.0.0"', 'version="9"', 1),
        "version",
    ),
}
"""File, edit, and what its one error names."""
