"""The declaration of fields as data: bounds, quantities, checks, findings.

Both libraries raise their input errors through this package, which knows neither of them. It depends on numpy
and annotated_types alone.
"""

from __future__ import annotations

from annotated_types import Interval

from bounds.bound import (
    LIMIT_SLACK,
    MAX_BYTES,
    Bound,
    Choice,
    above,
    at_least,
    at_most,
    below,
    between,
    exactly,
    from_to,
    integers,
    one_of,
    up_to,
)
from bounds.checks import Checks, RefusedValue, inside
from bounds.declared import (
    DEPTHS,
    Declared,
    Direction,
    Kind,
    declarations,
    declared,
    described,
    required,
    written,
)
from bounds.order_names import order_name, order_words, shaft_words
from bounds.plausibility import Check, Checklist, Finding, PlausibilityWarning, finding_of, warn_of
from bounds.text import FieldName, Quantity, Reader, SiNote, Text, Wording
from bounds.unit import Unit, engineering, leftover

__all__ = [
    "DEPTHS",
    "LIMIT_SLACK",
    "MAX_BYTES",
    "Bound",
    "Check",
    "Checklist",
    "Checks",
    "Choice",
    "Declared",
    "Direction",
    "FieldName",
    "Finding",
    "Interval",
    "Kind",
    "PlausibilityWarning",
    "Quantity",
    "Reader",
    "RefusedValue",
    "SiNote",
    "Text",
    "Unit",
    "Wording",
    "above",
    "at_least",
    "at_most",
    "below",
    "between",
    "declarations",
    "declared",
    "described",
    "engineering",
    "exactly",
    "finding_of",
    "from_to",
    "inside",
    "integers",
    "leftover",
    "one_of",
    "order_name",
    "order_words",
    "required",
    "shaft_words",
    "up_to",
    "warn_of",
    "written",
]
