"""Errors of the libraries as the boundary shows them: its field names, its units."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from pydantic import BaseModel

from dynamics.errors import DynamicsError
from dynamics.errors import InputError as DynamicsInputError
from fe_contact.errors import FeContactError, InfeasibleGeometry
from fe_contact.errors import InputError as ContactInputError
from fe_contact.geometry import FlankGrid, FlankModification
from service.convert.units import DEGREE, GPA, MM, UM, boundary_text, factor
from service.convert.vocabulary import case_field, scene_field
from service.problems import BadInput, Fault, JobFailed, ServiceError
from service.schemas import Case
from service.schemas.faults import field_advice
from service.schemas.scene import SceneInput

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_LENGTH = re.compile(rf"({_NUMBER}) m\b(?!/)")
_ANGLE = re.compile(rf"({_NUMBER}) rad\b(?!/)")
_MODULUS = re.compile(rf"({_NUMBER}) Pa\b")
_PLAIN = re.compile(_NUMBER)
_SIDE = rf"(?:above|below|at least|at most) {_NUMBER}"
_RANGE = re.compile(rf"{_NUMBER}(?: or above)?|from {_NUMBER} to {_NUMBER}|{_SIDE}(?: and {_SIDE})?")


def translated(error: Exception) -> ServiceError | None:
    """Return an error of the libraries as the boundary's, None for one they do not raise on purpose."""
    if isinstance(error, ContactInputError):
        return BadInput([_fault(error, case_field, Case)])
    if isinstance(error, DynamicsInputError):
        return BadInput([_fault(error, scene_field, SceneInput)])
    if isinstance(error, FeContactError | DynamicsError):
        return JobFailed(str(error))
    return None


@contextmanager
def named(part: str) -> Iterator[None]:
    """Turn input errors of dynamics into the boundary's, named inside `part`."""
    try:
        yield
    except DynamicsInputError as error:
        raise translated(error.within(part) if part else error) or error from None


def _fault(
    error: ContactInputError | DynamicsInputError, name: Callable[[str], str], model: type[BaseModel]
) -> Fault:
    """One input error under the boundary's name and in its unit."""
    if isinstance(error.value, FlankModification):
        error = _named_modification(error, error.value)
    field = name(error.field)
    unit = factor(field.partition("[")[0] if field.endswith("]") else field)
    bound = _in_boundary_units(error.bound, unit)
    if isinstance(error, InfeasibleGeometry):
        bound = f"{bound} ({error.name})"
    advice = _advice(error.suggestion) or field_advice(model, field)
    return Fault(field, _scaled(error.value, unit), bound, advice)


def _named_modification(
    error: ContactInputError | DynamicsInputError, value: FlankModification
) -> ContactInputError:
    """Name the amount that a refused modification varies along the face by."""
    along_face = ("helix_crowning", "helix_slope", "end_relief", "flank_twist", "flank_grid")
    name = next((amount for amount in along_face if getattr(value, amount)), "modification")
    field, given = f"{error.field}.{name}", getattr(value, name, None)
    if isinstance(given, FlankGrid):
        return ContactInputError(f"{field}.removed", given.removed, error.bound, error.suggestion)
    return ContactInputError(field, given, f"0: {error.bound}", error.suggestion)


def _scaled(value: object, unit: float) -> object:
    """SI value in the boundary's unit, rounded to what was typed; lists element by element."""
    if isinstance(value, list | tuple):
        return [_scaled(item, unit) for item in value]
    if isinstance(value, bool) or not isinstance(value, int | float) or unit == 1.0:
        return value
    return float(f"{value / unit:.12g}") if math.isfinite(value) else value


def _in_boundary_units(text: str, unit: float) -> str:
    """Bound with its numbers in boundary units.

    A number with a unit is converted by it, a length of the limit itself into the field's own. A bare one is
    the field's only where the bound is nothing but a range; inside a sentence it may be anything, such as a
    contact ratio.
    """
    if unit != 1.0 and _RANGE.fullmatch(text):
        return _PLAIN.sub(lambda match: boundary_text(float(match.group()) / unit), text)
    if unit == MM:
        limit, comma, reason = text.partition(",")
        in_mm = _LENGTH.sub(lambda match: f"{boundary_text(float(match.group(1)) / MM)} mm", limit)
        return in_mm + comma + _quantities(reason) if ":" not in limit else _quantities(text)
    return _quantities(text)


def _quantities(text: str) -> str:
    """Text with lengths in mm (small ones in um), angles in degrees and moduli in GPa."""
    text = _LENGTH.sub(lambda match: _length(float(match.group(1))), text)
    text = _ANGLE.sub(lambda match: f"{boundary_text(float(match.group(1)) / DEGREE)} deg", text)
    return _MODULUS.sub(lambda match: f"{boundary_text(float(match.group(1)) / GPA)} GPa", text)


def _length(value: float) -> str:
    """Return a length in mm, or in um below a tenth of a millimetre."""
    small = 0.0 < abs(value) < 0.1 * MM
    return f"{boundary_text(value / UM)} um" if small else f"{boundary_text(value / MM)} mm"


def _advice(suggestion: str) -> str:
    """Suggestion without the sentences that explain SI units, which the boundary does not use."""
    sentences = re.split(r"(?<=[.!?])\s+", suggestion)
    kept = [sentence for sentence in sentences if not re.search(r"\b[Ii]n (?:m|rad|Pa|s)\b", sentence)]
    return _quantities(" ".join(kept))
