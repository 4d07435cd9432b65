"""Boundary models: the case and scene files and every JSON body, strict and with units in the names."""

from service.schemas.case import AccuracyInput, Case, ErrorsInput, LoadInput, PairInput
from service.schemas.gear import GearInput, ToothingInput
from service.schemas.gear_body import MaterialInput
from service.schemas.reading import read_model, read_table, validated
from service.schemas.wheel import WheelInput

__all__ = [
    "AccuracyInput",
    "Case",
    "ErrorsInput",
    "GearInput",
    "LoadInput",
    "MaterialInput",
    "PairInput",
    "ToothingInput",
    "WheelInput",
    "read_model",
    "read_table",
    "validated",
]
