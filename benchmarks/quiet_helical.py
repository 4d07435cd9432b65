"""Is the influence of effects estimated well where the ripple is small? Quiet helical pairs, in um."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.assessed_influence import FACTOR, FLOOR, SHARE, within_factor
from benchmarks.figures import Figure
from benchmarks.influence_estimates import PAGE
from benchmarks.marked_section import replace_section
from benchmarks.quiet_helical_cases import QuietPair, quiet_pairs
from fe_contact.analysis.checks.effect_ledger import toggled
from fe_contact.analysis.database.compute_database import compute_database
from fe_contact.analysis.request.influences import estimated_influences
from fe_contact.analysis.request.model_choice import decide
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import check_request
from fe_contact.effects.influence.influence import RIPPLE_FLOOR, Influence, signed
from fe_contact.options import AnalysisOptions, Run, TableAxes

SECTION = "quiet helical"
SUBJECT = "influence of effects on quiet helical pairs"
SLICES, POSITIONS = 15, 32
EFFECTS = ("tooth_coupling", "corner_contact", "profile_modification", "lead_modification", "misalignment")


@dataclass(frozen=True)
class AssessedInfluence:
    """One effect of one pair, estimated and computed."""

    pair: QuietPair
    effect: str
    estimated: Influence
    computed: Influence

    @property
    def right(self) -> tuple[bool, bool]:
        """Whether mean and peak-to-peak are within a factor 2; below 1 % and 20 nm both are nothing."""
        found = []
        for name in ("mean", "peak_to_peak"):
            scale = max(getattr(self.computed, f"full_{name}"), RIPPLE_FLOOR / FLOOR)
            estimated, computed = (getattr(one, name) / scale for one in (self.estimated, self.computed))
            found.append(within_factor(estimated, computed))
        return found[0], found[1]


def figures() -> list[Figure]:
    """Return how often the estimates are right, on pairs seen and unseen when they were made."""
    rows = []
    for title, group in groups(assessed()).items():
        count = f"{title} pairs: beyond a factor {FACTOR:g}, of {len(group)} effects"
        rows.append(Figure(SUBJECT, count, 100.0 - share_right(group), "%", 100.0 - SHARE))
    return rows


def groups(found: Sequence[AssessedInfluence]) -> dict[str, list[AssessedInfluence]]:
    """Return the effects of the pairs on which the estimates were worked on, and of the others."""
    titles = {"unseen": True, "seen": False}
    return {title: [one for one in found if one.pair.unseen is unseen] for title, unseen in titles.items()}


def share_right(found: Sequence[AssessedInfluence]) -> float:
    """Return how many per cent are right in mean and peak-to-peak."""
    return 100.0 * float(np.mean([all(one.right) for one in found])) if found else 100.0


@cache
def assessed() -> tuple[AssessedInfluence, ...]:
    """Toggle the effects of all pairs, once: about four CPU minutes."""
    with tempfile.TemporaryDirectory() as folder:
        return tuple(one for pair in quiet_pairs() for one in assessed_pair(pair, Path(folder)))


def assessed_pair(quiet: QuietPair, folder: Path) -> list[AssessedInfluence]:
    """Toggle the effects of one pair at its nominal load, on draft meshes in 15 slices."""
    sys.stderr.write(f"  {quiet.name}\n")
    checked = check_request(
        quiet.pair,
        TableAxes(torques=[quiet.torque], misalignments=(quiet.misalignment,)),
        AnalysisOptions(
            level="draft",
            positions=POSITIONS,
            effects={"corner_contact": "on"},
            receipt="minimal",
            on_violation="report",
        ),
    )
    assessed_names = [entry.name for entry in checked.ledger if entry.on and entry.name in EFFECTS]
    estimates = estimated_influences(checked, assessed_names)
    whole = _curve(checked, folder)
    found = []
    for name in assessed_names:
        other, estimate = _curve(toggled(checked, name, "off"), folder), estimates[name]
        assert estimate is not None
        computed = Influence(
            quiet.torque, quiet.misalignment, other[0] - whole[0], other[1] - whole[1], whole[0], whole[1]
        )
        found.append(AssessedInfluence(quiet, name, estimate, computed))
    return found


def _curve(checked: Checked, folder: Path) -> tuple[float, float]:
    """Compute mean and peak-to-peak, m."""
    decision = decide(checked, folder).in_slices(SLICES)
    table = compute_database(checked, checked.request.to_json(), Run(cache=folder), decision)
    curve = table.curve(force=float(table.force[-1]), misalignment=checked.request.scene.largest_misalignment)
    return float(curve.mean.value), float(curve.peak_to_peak.value)


def markdown(found: Sequence[AssessedInfluence]) -> str:
    """Return the section of influence.md."""
    shares = ", ".join(
        f"{share_right(group):.0f} % of {len(group)} on pairs {title} when the estimates were made"
        for title, group in groups(found).items()
    )
    lines = [
        f"Modified helical pairs at their nominal load, draft finite elements in {SLICES} slices.",
        f"Right within a factor {FACTOR:g} and in sign in both figures: **{shares}** (target {SHARE:g} %);",
        f"changes below 1 % and {1e9 * RIPPLE_FLOOR:g} nm count as zero. Estimated / computed in um,",
        "**bold** beyond a factor 2, *pairs* unseen.",
        "",
        "| pair | ripple | effect | mean | peak-to-peak |",
        "|---|---:|---|---:|---:|",
    ]
    lines += [_row(one) for one in found]
    return "\n".join(lines) + "\n"


def _row(one: AssessedInfluence) -> str:
    """One effect."""
    cells = []
    for name, right in zip(("mean", "peak_to_peak"), one.right, strict=True):
        text = " / ".join(signed(1e6 * getattr(each, name)) for each in (one.estimated, one.computed))
        cells.append(text if right else f"**{text}**")
    name = f"*{one.pair.name}*" if one.pair.unseen else one.pair.name
    ripple = f"{1e6 * one.computed.full_peak_to_peak:.2f}"
    return f"| {name} | {ripple} | {one.effect} | {cells[0]} | {cells[1]} |"


def publish(found: Sequence[AssessedInfluence], machine: dict[str, str]) -> None:
    """Write the section of the page between its marks."""
    versions = ", ".join(f"{name} {machine[name]}" for name in ("lineofaction", "numpy", "scipy"))
    replace_section(PAGE, SECTION, f"{markdown(found)}\nMeasured with {versions}.\n")
