"""Checks that both libraries offer: names among others, findings by a list of limits."""

import pytest

from bounds import Check, Checklist, Checks, RefusedValue

CHECKS = Checks(RefusedValue)
LIMITS = Checklist({"size": Check("size", "size of the thing", 2.0, 10.0, "1", "a standard")})


def test_chosen_names_keep_the_order_of_the_known_ones():
    known = ["coarse", "usual", "fine"]
    assert CHECKS.chosen("names", ["fine", "coarse", "fine"], known) == ["coarse", "fine"]
    assert CHECKS.chosen("names", None, known) == known
    assert CHECKS.chosen("names", [], known) == []
    with pytest.raises(RefusedValue, match=r"names = 'finest'.*\"usual\".*Leave it out") as refused:
        CHECKS.chosen("names", ["fine", "finest"], known, "Leave it out.")
    assert (refused.value.field, refused.value.value) == ("names", "finest")


@pytest.mark.parametrize(
    ("value", "scale", "skip_zero", "is_found"),
    [
        (5.0, 1.0, False, False),
        (-5.0, 1.0, False, False),  # limits are for sizes
        (1.9, 1.0, False, True),
        (1.9, 0.9, False, False),
        (10.1, 1.0, False, True),
        (0.0, 1.0, False, True),
        (0.0, 1.0, True, False),
    ],
)
def test_findings_are_what_is_out_of_the_limits(value, scale, skip_zero, is_found):
    findings = list(LIMITS.assessed("size", "field", value, "1", scale=scale, skip_zero=skip_zero))
    assert len(findings) == is_found
    for finding in findings:
        assert (finding.low, finding.high, finding.source) == (2.0 * scale, 10.0 * scale, "a standard")
        assert finding.reason == "implausible size of the thing"
