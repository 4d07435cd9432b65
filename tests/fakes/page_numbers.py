"""Numbers that the page prints, each with its subject, and the contradictions among them.

An element that has a number carries `data-subject` (of what), `data-value`, `data-error` and `data-unit`. A
contradiction is a sentence that starts with its kind: "differ" (two numbers of one subject), "digits" (a text
beyond its error), "arithmetic" (a change or a level that is not that of the numbers beside it), "answer" (not
what the service answers) or "bare" (a number without a subject).
"""

import math
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import httpx2
from playwright.sync_api import Page

COLLECT = """() => {
  const plain = (text) => text.replaceAll("\\u00a0", " ");
  const numeric = (text) => (text === undefined ? null : Number(text));
  return [...document.querySelectorAll("[data-subject]")].map(({ dataset, firstChild, textContent }) => ({
    subject: dataset.subject, unit: dataset.unit ?? "", value: numeric(dataset.value),
    error: numeric(dataset.error),
    text: plain(firstChild?.nodeType === 3 ? firstChild.data : textContent), whole: plain(textContent),
  }));
}"""
BARE = """() => {
  const cells = [...document.querySelectorAll("#dock dd, #dock td, .live td, #jobs-rows dd")];
  const named = (cell) => cell.parentElement.firstElementChild.textContent;
  const isText = ({ nodeType }) => nodeType === 3;
  const isBare = (node) => isText(node) || !node.matches("[data-subject]");
  const within = (node) => (isText(node) ? node : [...node.childNodes].filter(isText));
  const texts = (cell) => [...cell.childNodes].filter(isBare).flatMap(within);
  const bare = cells.filter((cell) => cell.dataset.subject === undefined);
  return bare.map((cell) => [named(cell), texts(cell).map(({ data }) => data).join(" ")]);
}"""
ADDRESS = """async () => {
  const { unpack } = await import("/page/packed.js");
  const pairs = location.hash.slice(1).split("&").map((part) => part.split("=").map(decodeURIComponent));
  const parts = Object.fromEntries(pairs);
  const moved = (word) => unpack(word ?? "") ?? {};
  const letters = ["a", "b", "c"].filter((letter) => /^[0-9a-f]{64}/.test(parts[letter] ?? ""));
  const others = letters.map((letter) => [letter.toUpperCase(), parts[letter].split(".")]);
  return {
    on: (parts.on ?? "a").toUpperCase(), alone: !letters.length, key: parts.database,
    moved: moved(parts.live),
    others: others.map(([name, [key, live]]) => ({ name, key, moved: moved(live) })),
  };
}"""
REPORT = """() => [...document.querySelectorAll("#results-body > .headline > div")].map((row) => (
  [row.querySelector("dt").textContent, row.querySelector("dd").textContent]))"""
NAMES = "now", "as analyzed"
STATED = re.compile(r"(?P<what>mean STE|peak-to-peak STE|largest pressure) at (?P<torque>\S+ N m)")
EXACT = ("CPU time", "time", "memory", "model", "misaligned by, µm", "of the mesh")
"""Rows whose numbers are no results: costs, what was typed, what was counted."""
NUMBER = re.compile(r"[+−-]?\d[\d.]*(?:e[+-]?\d+)?")
CHANGE = re.compile(r"change from (?P<first>[^;]*?) of (?P<what>[^;]*);(?P<rest>.*)")
ROUNDING = 1e-9


@dataclass(frozen=True)
class Printed:
    """A number on the page."""

    subject: str
    value: float | None
    error: float | None
    unit: str
    text: str
    whole: str

    @property
    def what(self) -> str:
        """The figure that it is."""
        return self.subject.partition(";")[0]

    @property
    def is_level(self) -> bool:
        return self.what.startswith("level of")

    def of_design(self, name: str) -> str:
        """Return the subject of the same number of another design."""
        parts = self.subject.split("; ")
        return "; ".join([*parts[:2], name, *parts[3:]])


def printed(page: Page) -> list[Printed]:
    """Return every number of the page that has a subject."""
    return [Printed(**found) for found in page.evaluate(COLLECT)]


def contradictions(page: Page, address: str) -> list[str]:
    """Return what contradicts itself on the page at rest, or the answers of its service."""
    numbers = printed(page)
    found = [*_differing(numbers), *_beyond_their_errors(numbers), *_arithmetic(numbers)]
    found += [*_bare(page), *_of_the_report(numbers, page.evaluate(REPORT))]
    return [*found, *_of_the_service(numbers, page.evaluate(ADDRESS), address)]


def _differing(numbers: Iterable[Printed]) -> Iterator[str]:
    """Yield subjects whose numbers, errors or texts differ between two places."""
    by_subject = defaultdict(list)
    for number in numbers:
        by_subject[number.subject].append(number)
    for subject, places in by_subject.items():
        if len({(place.value, place.error) for place in places}) > 1:
            yield f"differ: {subject}: {[(place.value, place.error) for place in places]}"


def _place(error: float) -> int:
    """Return the decimal place of the second digit of an error."""
    return 1 - int(f"{error:.1e}".partition("e")[2])


def _beyond_their_errors(numbers: Iterable[Printed]) -> Iterator[str]:
    """Yield texts with other digits than their value and error leave."""
    for number in numbers:
        if number.value is None or number.text.startswith(("no change", "within", "below")):
            is_below = number.error is None or number.value is None or abs(number.value) <= number.error
            if not is_below and not number.is_level:
                yield f"digits: {number.subject}: {number.text} of {number.value} ± {number.error}"
            continue
        texts = NUMBER.findall(number.text)
        if not texts:
            yield f"digits: {number.subject}: no number in {number.text!r}"
            continue
        text = texts[0].replace("−", "-")
        decimals = len(text.partition("e")[0].partition(".")[2])
        exponent = int(text.partition("e")[2] or 0)
        half = 0.5000001 * 10.0 ** (exponent - decimals)
        if number.error and decimals > max(0, _place(number.error)):
            yield f"digits: {number.subject}: {number.text} beyond ± {number.error}"
        if abs(float(text) - number.value) > max(
            half, 0.006 * abs(number.value) if number.error is None else half
        ):
            yield f"digits: {number.subject}: {number.text} is not {number.value}"


def _arithmetic(numbers: Iterable[Printed]) -> Iterator[str]:
    """Yield changes and levels that are not those of the numbers that stand beside them."""
    known = {number.subject: number for number in numbers}
    for number in known.values():
        match = CHANGE.fullmatch(number.subject)
        if match and number.value is not None:
            now = known.get(f"{match['what']};{match['rest']}")
            before = now and known.get(now.of_design(match["first"]))
            if now and before and now.value is not None and before.value is not None:
                yield from _of_change(number, now, before)
        if number.is_level and number.value is not None and not number.text.startswith("below"):
            amplitude = known.get(number.subject.removeprefix("level of "))
            if (
                amplitude
                and amplitude.value
                and not math.isclose(number.value, 20.0 * math.log10(amplitude.value), abs_tol=1e-6)
            ):
                yield f"arithmetic: {number.subject}: {number.value} dB of {amplitude.value} µm"


def _of_change(number: Printed, now: Printed, before: Printed) -> Iterator[str]:
    assert now.value is not None and before.value is not None
    change = now.value - before.value if number.unit == "dB" else 100.0 * (now.value / before.value - 1.0)
    if "below" not in now.text + before.text and not math.isclose(number.value or 0.0, change, abs_tol=1e-6):
        beside = f"beside {before.value} and {now.value}"
        yield f"arithmetic: {number.subject}: {number.value} {number.unit}, {beside}"


def _of_the_report(numbers: Iterable[Printed], rows: Iterable[tuple[str, str]]) -> Iterator[str]:
    """Yield figures of the stored result that the report writes otherwise than the curves as analyzed."""
    known = [number for number in numbers if "; as analyzed; " in number.subject]
    ripples = {number.subject: number.value for number in numbers if number.what == "peak to peak"}
    for number in numbers:  # of flanks that nobody moved
        now, before = (f"peak to peak; {number.of_design(name).partition('; ')[2]}" for name in NAMES)
        if "; now; " in number.subject and ripples.get(now, 0.0) == ripples.get(before):
            known.append(number)
    for name, text in rows:
        match = STATED.fullmatch(name)
        for number in known if match else ():
            what = match["what"].replace("-", " ").removesuffix(" STE")
            if number.what != what or not number.subject.endswith(f"; at {match['torque']}"):
                continue
            (own, *error), (theirs, *_) = (re.findall(r"\d[\d.]*", one) for one in (number.whole, text))
            places = min(len(one.partition(".")[2]) for one in (own, theirs))
            is_stated = text.partition(";")[0].count("±") == 1 and error
            other_error = is_stated and f"± {error[0]}" not in text
            if abs(float(own) - float(theirs)) > 0.51 * 10.0**-places or other_error:
                yield f"differ: {number.subject}: {number.whole}, in the report {text}"


def _bare(page: Page) -> Iterator[str]:
    for name, text in page.evaluate(BARE):
        if name not in EXACT and re.search(r"\d", text.replace("re 1 µm", "")):
            yield f"bare: {name}: {text}"


FIGURES: Mapping[str, tuple[str, int | None]] = {
    "peak to peak": ("peak_to_peak", None),
    "mean": ("mean", None),
    **{f"harmonic {order}": ("harmonics", order - 1) for order in range(1, 21)},
}


def _of_the_service(numbers: Iterable[Printed], state: Mapping[str, Any], address: str) -> Iterator[str]:
    if not state["key"]:
        return
    own = "now" if state["alone"] else state["on"]
    designs = {
        own: (state["key"], state["moved"]),
        "as analyzed": (state["key"], {}),
        **{other["name"]: (other["key"], other["moved"]) for other in state["others"]},
    }
    answers: dict[tuple[str, float], dict[str, Any]] = {}
    for number in numbers:
        parts = number.subject.split("; ")
        point = re.match(r"at ([\d.e+-]+) N m", parts[-1])
        if number.what not in FIGURES or len(parts) != 4 or point is None or parts[2] not in designs:
            continue
        asked = parts[2], float(point[1])
        if asked not in answers:
            key, moved = designs[asked[0]]
            question = {name: moved[name] for name in ("misalignment_um", "pinion", "wheel") if name in moved}
            answer = httpx2.post(
                f"{address}/v1/databases/{key}/ste", json=question | {"torque_n_m": [asked[1]]}, timeout=300.0
            )
            assert answer.status_code == 200, answer.text
            answers[asked] = answer.json()["curves"][0]
        name, index = FIGURES[number.what]
        for suffix, value in (("um", number.value), ("error_um", number.error)):
            known = answers[asked].get(f"{name}_{suffix}")
            known = known[index] if index is not None and known is not None else known
            if value is not None and (known is None or not math.isclose(value, known, rel_tol=ROUNDING)):
                yield f"answer: {number.subject}: {suffix} {value}, the service {known}"
