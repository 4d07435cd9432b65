"""The variables of an FMU and its model description."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as Xml

REAL, INTEGER, BOOLEAN = "Real", "Integer", "Boolean"


# exponents of the SI base units
_UNITS = {
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
}


_CAPABILITIES = (
    "canHandleVariableCommunicationStepSize",
    "canGetAndSetFMUstate",
    "canSerializeFMUstate",
    "canNotUseMemoryManagementFunctions",
)


TABLE_FILE = "mesh_force_table.bin"


@dataclass(frozen=True)
class Variable:
    """A variable by its name in the model description; its value reference is its index among its kind."""

    name: str
    kind: str
    causality: str
    variability: str
    text: str
    unit: str = ""
    start: float | None = None
    """None: an output, which follows from the others."""


def model_description(name: str, variables: Sequence[Variable], guid: str, sources: Sequence[str]) -> bytes:
    """Return the XML; it holds no date, so that the same table gives the same file.

    `name` is a C identifier; `sources` are the C files to compile, in ``sources/``.
    """
    root = Xml.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid=guid,
        description="Gear mesh force from a static-transmission-error table",
        generationTool="lineofaction",
        variableNamingConvention="flat",
        numberOfEventIndicators="0",
    )
    simulated = {"modelIdentifier": name, **dict.fromkeys(_CAPABILITIES, "true")}
    files = Xml.SubElement(Xml.SubElement(root, "CoSimulation", simulated), "SourceFiles")
    for source in sources:
        Xml.SubElement(files, "File", name=source)
    definitions = Xml.SubElement(root, "UnitDefinitions")
    for unit_name, exponents in _UNITS.items():
        unit = Xml.SubElement(definitions, "Unit", name=unit_name)
        Xml.SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents.items()})
    _add_variables(root, variables)
    _add_structure(root, variables)
    Xml.indent(root)
    content: bytes = Xml.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def _add_variables(root: Xml.Element, variables: Sequence[Variable]) -> None:
    section, count = Xml.SubElement(root, "ModelVariables"), dict.fromkeys((REAL, INTEGER, BOOLEAN), 0)
    for variable in variables:
        entry = Xml.SubElement(
            section,
            "ScalarVariable",
            name=variable.name,
            valueReference=str(count[variable.kind]),
            description=variable.text,
            causality=variable.causality,
            variability=variable.variability,
        )
        count[variable.kind] += 1
        attributes = {"unit": variable.unit} if variable.unit else {}
        if variable.start is not None:
            truth = "true" if variable.start else "false"
            attributes["start"] = truth if variable.kind == BOOLEAN else repr(variable.start)
        Xml.SubElement(entry, variable.kind, attributes)


def _add_structure(root: Xml.Element, variables: Sequence[Variable]) -> None:
    """Every output depends on every input, at once."""
    structure = Xml.SubElement(root, "ModelStructure")
    for section in ("Outputs", "InitialUnknowns"):
        listed = Xml.SubElement(structure, section)
        for index, variable in enumerate(variables, start=1):
            if variable.causality == "output":
                Xml.SubElement(listed, "Unknown", index=str(index))
