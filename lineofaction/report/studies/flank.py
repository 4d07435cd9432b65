"""Flank results as people see them: pressure over the flanks, contact lines, load over the face."""

from __future__ import annotations

from collections.abc import Iterator

from bounds import engineering
from fe_contact.analysis.flanks.load_distribution import LoadDistribution
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.effects import assumption_lines
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing.figure import Figure, number
from lineofaction.report.drawing.page import Headline, Page, Part, Section
from lineofaction.report.drawing.tables import facts
from lineofaction.report.presentation import Presentation
from lineofaction.report.tables.flanks import (
    contact_lines,
    contact_pattern_figure,
    line_load_figure,
    load_centroid_figure,
)
from lineofaction.report.tables.pair import pair_lead, pair_title
from lineofaction.report.tables.static_part import case_tables, contact_effects, edge_words


def page(flanks: LoadDistribution, database: SteDatabase | None = None) -> Page:
    """Return the page of flank results; beside their database, which has its own effects and case."""
    pair = flanks.scene.facts
    sections = (*_results(flanks), *_making(flanks, alone=database is None))
    return Page(pair_title(pair), pair_lead(pair), _headlines(flanks), sections, _alarms(flanks, database))


def _headlines(flanks: LoadDistribution) -> tuple[Headline, ...]:
    """Largest pressure and K_Hbeta."""
    at = operating_point(flanks)
    largest = f"{number(1e-6 * float(flanks.clear_pressure.max()))} MPa"
    headlines = [Headline("largest flank pressure", largest, f"{at}{edge_words(flanks.edge_pressure)}")]
    if flanks.face_position.size > 1:
        factor = flanks.mean_face_load_factor
        headlines.append(Headline("K_Hbeta over the cycle", number(factor, 3), at))
    return tuple(headlines)


def _results(flanks: LoadDistribution) -> tuple[Section, ...]:
    """Show the flanks; one slice has nothing to show over the face."""
    figures: tuple[Figure, ...] = (contact_pattern_figure(flanks),)
    text = f"At {operating_point(flanks)}, {flanks.position.size} positions of the mesh cycle."
    if flanks.face_position.size > 1:
        figures += (contact_lines(flanks), line_load_figure(flanks), load_centroid_figure(flanks))
    else:
        text += " The model is plane: what is shown is the same over the whole face."
    return (Section("Flanks", text, figures=figures),)


def _making(flanks: LoadDistribution, *, alone: bool) -> tuple[Section, ...]:
    """Show what the flank results cost; `alone`, without their database, also effects and case."""
    metadata = flanks.metadata
    if not metadata.receipt:
        return ()
    cost = {name: value for name, value in metadata.receipt.items() if name != "plan"}
    made = {**metadata.software_versions, "content_hash": metadata.content_hash}
    section = Section(
        "Receipt of the flank results",
        tables=(facts("Cost", cost),),
        folded=(facts("Made with", made),),
        part=Part.RECEIPT,
    )
    if not alone:
        return (section,)
    case = Section("Case", folded=case_tables(metadata.case), part=Part.INPUT)
    return contact_effects(metadata.effect_ledger), case, section


def _alarms(flanks: LoadDistribution, database: SteDatabase | None) -> tuple[str, ...]:
    """Say loudly if database and flank results are of different pairs."""
    if database is None:
        return ()
    mine, theirs = flanks.scene.facts, database.facts
    same = mine.teeth == theirs.teeth and all(
        abs(getattr(mine, name) - getattr(theirs, name)) <= 1e-9 * getattr(theirs, name)
        for name in ("base_pitch", "face_width")
    )
    return () if same else ("The flank results and the STE database are of different gear pairs.",)


def operating_point(flanks: LoadDistribution) -> str:
    """Say load and alignment."""
    scene = flanks.scene
    parts = [f"{number(scene.torque, 4)} N m"]
    if scene.misalignment:
        parts.append(f"misalignment {number(1e6 * scene.misalignment, 3)} µm")
    if scene.center_distance_change:
        parts.append(f"center distance {engineering(1e3 * scene.center_distance_change, 3, '+')} mm")
    return ", ".join(parts)


def text(flanks: LoadDistribution) -> Iterator[str]:
    """Yield the figures for people."""
    scene, receipt = flanks.scene, flanks.metadata.receipt
    yield (
        f"torque {scene.torque:.6g} N m, normal force {scene.normal_force:.6g} N, "
        f"misalignment {scene.misalignment / UM:.4g} um"
    )
    yield (
        f"largest pressure {1e-6 * flanks.clear_pressure.max():.4g} MPa{edge_words(flanks.edge_pressure)}, "
        f"largest line load {1e-3 * flanks.line_load.max():.4g} N/mm"
    )
    if flanks.face_position.size > 1:
        low, high = (1e3 * end for end in (flanks.load_centroid.min(), flanks.load_centroid.max()))
        yield (
            f"K_Hbeta {engineering(flanks.mean_face_load_factor, 3)} over the cycle, at most "
            f"{engineering(flanks.face_load_factor.max(), 3)} at one position; "
            f"load centroid {engineering(low, 3)} to {engineering(high, 3)} mm from mid-face"
        )
    yield from assumption_lines(receipt)


PAGE = Presentation(contact_pattern_figure, page, text, beside=page)
