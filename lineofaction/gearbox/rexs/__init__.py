"""REXS, the exchange format of gear-unit tools: read, checked, upgraded, in SI, written."""

from __future__ import annotations

from lineofaction.gearbox.rexs.archive import external_file, external_files
from lineofaction.gearbox.rexs.files import parsed, read_rexs, serialized
from lineofaction.gearbox.rexs.model import (
    Attribute,
    Component,
    Document,
    LoadCase,
    LoadSpectrum,
    Model,
    Reference,
    Relation,
)
from lineofaction.gearbox.rexs.quantities import listed_unit, quantities, quantity
from lineofaction.gearbox.rexs.upgrade import NEWEST, VERSIONS, Change, si_value, upgrade

__all__ = [
    "NEWEST",
    "VERSIONS",
    "Attribute",
    "Change",
    "Component",
    "Document",
    "LoadCase",
    "LoadSpectrum",
    "Model",
    "Reference",
    "Relation",
    "external_file",
    "external_files",
    "listed_unit",
    "parsed",
    "quantities",
    "quantity",
    "read_rexs",
    "serialized",
    "si_value",
    "upgrade",
]
