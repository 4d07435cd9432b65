"""modelDescription.xml of FMI 2.0."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree as Xml

from dynamics.engines.fmu.variables import BOOLEAN, INTEGER, REAL, Variable

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


def model_description(name: str, chosen: Sequence[Variable], guid: str, sources: Sequence[str]) -> bytes:
    """Return the XML; it holds no date, so that the same table gives the same file.

    Parameters
    ----------
    name : str
        Model name and identifier: a C identifier.
    chosen : sequence of Variable
    guid : str
    sources : sequence of str
        The C files to compile, in ``sources/``.
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
    unit = Xml.SubElement(
        root, "CoSimulation", {"modelIdentifier": name, **dict.fromkeys(_CAPABILITIES, "true")}
    )
    files = Xml.SubElement(unit, "SourceFiles")
    for source in sources:
        Xml.SubElement(files, "File", name=source)
    _add_units(root)
    _add_variables(root, chosen)
    _add_structure(root, chosen)
    Xml.indent(root)
    content: bytes = Xml.tostring(root, encoding="UTF-8", xml_declaration=True)
    return content + b"\n"


def _add_units(root: Xml.Element) -> None:
    definitions = Xml.SubElement(root, "UnitDefinitions")
    for name, exponents in _UNITS.items():
        unit = Xml.SubElement(definitions, "Unit", name=name)
        Xml.SubElement(unit, "BaseUnit", {base: str(power) for base, power in exponents.items()})


def _add_variables(root: Xml.Element, chosen: Sequence[Variable]) -> None:
    section, count = Xml.SubElement(root, "ModelVariables"), dict.fromkeys((REAL, INTEGER, BOOLEAN), 0)
    for variable in chosen:
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
        facts = {"unit": variable.unit} if variable.unit else {}
        if variable.start is not None:
            facts["start"] = _text(variable)
        Xml.SubElement(entry, variable.kind, facts)


def _text(variable: Variable) -> str:
    if variable.kind == BOOLEAN:
        return "true" if variable.start else "false"
    return repr(variable.start)


def _add_structure(root: Xml.Element, chosen: Sequence[Variable]) -> None:
    """Every output depends on every input, at once."""
    structure = Xml.SubElement(root, "ModelStructure")
    for section in ("Outputs", "InitialUnknowns"):
        listed = Xml.SubElement(structure, section)
        for index, variable in enumerate(chosen, start=1):
            if variable.causality == "output":
                Xml.SubElement(listed, "Unknown", index=str(index))
