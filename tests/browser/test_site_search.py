"""The site's own search answers a newcomer's words within four hits; scripts/docs builds the site."""

from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page

SITE = Path(__file__).parents[2] / "out" / "docs"
HITS = 4
QUESTIONS = {
    "install": "readme",
    "windows": "readme",
    "license": "readme",
    "describe gear pair": "case-file",
    "transmission error": "tutorials/helical-ev-pair",
    "tip relief": "how-to/tip-relief",
    "sign of misalignment": "glossary",
    "print report": "how-to/print-a-report",
    "how accurate": "accuracy",
    "how long does it take": "how-to/what-does-one-percent-cost",
    "gear whine": "how-to/whine",
    "planet load sharing": "tutorials/planetary-stage",
    "bearing forces": "tutorials/run-up-to-orders",
    "enter bearings": "how-to/bearings",
    "compare two designs": "how-to/compare-two-designs",
    "tolerance class": "tutorials/tolerance-study",
    "neglected effects": "how-to/neglected-effects",
    "rattle": "how-to/rattle",
    "matlab": "how-to/other-tools",
    "run a server": "tutorials/service-for-the-team",
    "verified": "verification",
    "warnings": "plausibility",
    "open rexs file": "tutorials/from-rexs-to-dba",
    "polymer": "case-file",
    "jupyter": "notebooks",
    "pandas": "how-to/table-in-python",
}
"""The page that answers, by what a newcomer types."""
SEARCH = """async (words) => {
  const terms = Search._parseQuery(words);
  return Search._performSearch(...terms).reverse().map(([page]) => page);
}"""


@pytest.fixture(scope="module")
def search(browser: Browser) -> Page:
    if not (SITE / "searchindex.js").is_file():
        pytest.skip("the site is not built: scripts/docs")
    page = browser.new_page()
    page.goto((SITE / "search.html").as_uri())
    page.wait_for_function("() => Search.hasIndex()")
    return page


@pytest.mark.nightly
@pytest.mark.parametrize("words", QUESTIONS)
def test_a_newcomer_is_answered_within_four_hits(search: Page, words: str) -> None:
    hits = search.evaluate(SEARCH, words)[:HITS]
    assert QUESTIONS[words] in hits, hits
