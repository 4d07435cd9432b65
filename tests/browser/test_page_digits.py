"""Numbers of the page end with the second digit of their error, as those of terminal and document do."""

import pytest

from bounds.error_digits import with_error

WRITTEN = """async (pairs) => {
  const { withError } = await import("/page/digits.js");
  return pairs.map(([value, error]) => withError(value, error, "µm"));
}"""
CHANGES = """async (pairs) => {
  const { changeOf } = await import("/page/digits.js");
  const part = (value, from) => 100 * (value / from - 1);
  const changed = (value, from, error, coming) => (
    { subject: "", value: part(value, from), error, unit: "%", coming });
  return pairs.map((pair) => changeOf(changed(...pair)).text ?? "");
}"""
PAIRS = [(9.7861, 0.0347), (9.7861, 0.0996), (1.31, 0.0125), (-3.0, 2.0), (0.001, 0.4), (5.0, 1e-4)]


@pytest.mark.law
def test_page_and_terminal_write_one_number_alike(scripts):
    assert scripts.evaluate(WRITTEN, PAIRS) == [with_error(*pair, "µm") for pair in PAIRS]


def test_a_change_below_what_answers_resolve_is_none(scripts):
    pairs = [(1.0 + 2e-14, 1.0), (1.0001, 1.0), (1.002, 1.0), (0.8, 1.0)]
    assert scripts.evaluate(CHANGES, pairs) == ["no change", "no change", "+0.2 %", "−20 %"]
    pairs = [(0.8, 1.0, 4.94), (0.8, 1.0, 30.0)]
    assert scripts.evaluate(CHANGES, pairs) == ["−20.0 ± 4.9 %", "no change (± 30 %)"]
    pairs = [(1.0 + 2e-14, 1.0, None, True), (0.8, 1.0, None, True)]  # while the error is computed
    assert scripts.evaluate(CHANGES, pairs) == ["", "−20 ± … %"]
