"""The lists of fields on the page of case files are those of the declarations."""

import case_file_page
from repository import ROOT

from dynamics.housings import Material
from fe_contact.flank.modification import FlankModification
from lineofaction.gearbox.schemas.declared import figures

PAGE = (ROOT / "docs" / "case-file.md").read_text("utf-8")


def test_the_lists_are_current():
    assert case_file_page.page(PAGE) == PAGE, (
        "write them anew: python scripts/case_file_page.py docs/case-file.md"
    )


def test_every_declared_dataclass_has_a_list():
    named = [found[2] for found in case_file_page.LIST.finditer(PAGE)]
    assert sorted(named) == sorted(case_file_page.BY_NAME)


def test_an_entry_says_the_unit_the_bounds_and_the_default():
    entries = case_file_page.definitions(figures(FlankModification)).split("\n\n")
    usual = entries[0].replace("\n", " ")
    assert (
        "`.._um`: [0, 1000]; default 0." in usual
        and "`tip_relief_um`\n: Tip relief at the tip diameter." in entries
    )
    assert '`.._shape`: `"linear"`, `"parabolic"`, ' in usual and usual.endswith('; default `"linear"`.')
    assert "`tip_relief_shape`\n: Tip relief over its length." in entries
    assert any(entry.endswith(" [-1000, 1000]; default 0.") for entry in entries)
    assert any(entry.endswith(" [5, 85]; default 30.") for entry in entries)


def test_a_meaning_that_the_name_says_is_left_out():
    entries = {figure.field: case_file_page.definition(figure) for figure in figures(Material)}
    assert entries["youngs_modulus_gpa"].startswith("`youngs_modulus_gpa`\n: [0.001, 2000]; ")
    assert entries["thermal_expansion_per_k"].startswith("`thermal_expansion_per_k`\n: Coefficient of ")


def test_a_list_keeps_the_entries_of_others_and_renews_its_own():
    declared = figures(FlankModification)
    before = "`seat`\n: How the bore sits.\n\n`tip_relief_um`\n: As it was."
    renewed = case_file_page.definitions(declared, before)
    assert renewed == f"`seat`\n: How the bore sits.\n\n{case_file_page.definitions(declared)}"


def test_what_another_table_says_of_a_field_is_not_repeated():
    declared, said = figures(FlankModification), dict[str, str]()
    first = case_file_page.definitions(declared, "", said, "[first]")
    again = case_file_page.definitions(declared, "", said, "[second]")
    assert first == case_file_page.definitions(declared)
    entries = again.replace("\n", " ")
    assert "As of `[first]`: " in entries and all(f"`{figure.field}`" in entries for figure in declared)
    assert case_file_page.definitions(declared, again, said, "[second]") == again


def test_no_list_holds_what_another_declares():
    entries = {name: set(map(case_file_page.definition, own)) for name, own in case_file_page.BY_NAME.items()}
    declared = set().union(*entries.values())
    for found in case_file_page.LIST.finditer(PAGE):
        assert not (set(found[3].split("\n\n")) - entries[found[2]]) & declared, found[2]
