"""At 80 and at 120 columns a verb answers in its first lines, and nothing is cut."""

import contextlib
import io
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from command_line import loa
from small_table import small_table
from spur_case import spur_case

from lineofaction.cli.commands import app
from lineofaction.cli.output import EMPHASIS, console, print_parts, table
from lineofaction.cli.verb_warnings import in_lines
from lineofaction.cli.verbs.of_studies import GROUPS, StudyGroup
from lineofaction.report.presentation import effect_text

COLUMNS = (80, 120)
FIRST = 14
SCENE = Path(__file__).parents[3] / "examples" / "palermo_scene.toml"
ANSWERS: dict[str, tuple[tuple[str, ...], str]] = {
    "help": (("--help",), "Usage: loa"),
    "geometry": (("geometry", "CASE"), r"Gear pair .*: center distance .*\ncontact ratio"),
    "plan": (("plan", "CASE"), r"draft: [\d.]+ CPU s, [\d.]+ GiB"),
    "ste": (("ste", "TABLE", "--torque", "1"), r"peak to peak +[\d.]+ +± [\d.]+ µm"),
    "ste --table": (("ste", "TABLE", "--torque", "1", "--table"), "position"),
    "report": (("report", "TABLE", "--still", "-o", "PAGE"), "written to"),
    "compare": (("compare", "TABLE", "OTHER", "-o", "PAGE"), "peak to peak at"),
    "status": (("status", "FOLDER"), "missing"),
    "new": (("new", "--spur", "-o", "NEW"), "A spur pair"),
    "complaint": (
        ("complaint", "SCENE", "--order", "20", "--speed-rpm", "600"),
        r"complaint: order 20.0 of .*, harmonic 1",
    ),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("terminal")
    project = folder / "unit"
    project.mkdir()
    (project / "case.toml").write_text(spur_case(torques=[100.0]))
    table = small_table()
    table.to_netcdf(folder / "ste.nc")
    table.to_netcdf(folder / "other.nc")
    names = {"CASE": project / "case.toml", "TABLE": folder / "ste.nc", "OTHER": folder / "other.nc"}
    return names | {
        "PAGE": folder / "page.html",
        "FOLDER": project,
        "SCENE": SCENE,
        "NEW": folder / "new.toml",
    }


@pytest.mark.drawn
@pytest.mark.law
@pytest.mark.parametrize("columns", COLUMNS)
@pytest.mark.parametrize("verb", ANSWERS)
def test_the_answer_stands_first_and_nothing_is_cut(verb, columns, files, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(columns))
    files["NEW"].unlink(missing_ok=True)
    arguments, answer = ANSWERS[verb]
    done = loa(*(files.get(word, word) for word in arguments))
    assert done.exit_code == 0, done.output
    lines = done.stdout.splitlines()
    assert re.search(answer, "\n".join(lines[:FIRST])), done.stdout
    assert "…" not in done.stdout and "..." not in done.stdout.replace("[OPTIONS] COMMAND [ARGS]...", "")
    assert not re.search(r"\d um\b", done.stdout)
    sentences = ("warning (", *(str(path) for path in files.values()))  # which a terminal wraps
    long = [line for line in lines if len(line) > columns and not any(each in line for each in sentences)]
    assert long == []


@pytest.mark.parametrize("columns", COLUMNS)
def test_a_wide_table_stands_in_blocks_and_no_word_is_broken(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", str(columns))
    head = ["mesh", "load case", *(f"quantity-{k}, unit" for k in range(12))]
    rows = [["second stage", "load case 1", *(f"{k}.125 ± 0.0004" for k in range(12))]]
    console().print(table(head, rows, "title", head[:2]))
    printed = capsys.readouterr().out
    assert max(map(len, printed.splitlines())) <= columns
    blocks = printed.split("\n\n")
    assert len(blocks) > 1 and all("second stage" in block and "load case 1" in block for block in blocks)
    assert [cell for cell in rows[0][2:] if cell not in printed] == []
    assert [k for k in range(12) if f"quantity-{k}," not in printed] == []


REASON = "the nominal force bends and twists the shaft by 19.1 µm along the line of action"
EFFECTS = {
    "entries": [
        {"effect": effect, "part": part, "on": True, "reason": f"{REASON} of {part}", "influence_um": 19.1}
        for effect in ("flexible_shafts", "moving_application_point")
        for part in ("input", "intermediate")
    ]
}


@pytest.mark.parametrize("columns", COLUMNS)
def test_effects_stand_once_named_and_with_their_reasons_below(columns, monkeypatch, capsys):
    """A reason took 24 columns of 80 beside a second table of the same rows, some without a name."""
    monkeypatch.setenv("COLUMNS", str(columns))
    print_parts(effect_text(EFFECTS))
    title, head, beside, *lines = capsys.readouterr().out.splitlines()
    assert (title, head.split()[:2]) == ("Effects: change without each", ["effect", "on"])
    assert beside == "  where and why"
    named = [line.partition("  ")[0] for line in lines if not line.startswith("  ")]
    assert named == ["flexible shafts", "moving application point"]
    below = " ".join(line.strip() for line in lines if line.startswith("  "))
    assert below.count("input: the nominal force") == below.count("intermediate: the nominal") == 2
    assert max(map(len, (head, *lines))) <= columns
    assert len(lines) <= 2 * (2 + 2 * 2)


@pytest.mark.parametrize("unit", ["N m", "CPU s", "kg m²", "N s/m", "N m/rad"])
def test_a_unit_is_not_parted(unit, monkeypatch, capsys):
    """Neither in a head nor in a sentence, at any width: "torque N" stood above "m"."""
    for columns in range(20, 120):
        monkeypatch.setenv("COLUMNS", str(columns))
        words = f"largest of all over {unit}"
        console().print(
            table(["mesh", words, f"{words} and at rest"], [["one", "1.5", "3"]], text_columns=["mesh"])
        )
        assert capsys.readouterr().out.count(unit) == 2
        assert f"12 {unit}" in in_lines(f"at rest the gear has 12 {unit} in its first mesh", columns)


def test_a_text_wraps_only_where_that_saves_a_block(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    name, head = (
        "bearing of the output, motor side",
        ["force of", "order", *(f"number {k}" for k in range(6))],
    )
    console().print(table(head, [[name, "0.3333 (stage 1)", *["1234567"] * 6]], text_columns=head[:2]))
    assert capsys.readouterr().out.count(name) == 2
    console().print(table(head[:6], [[name, "0.3333 (stage 1)", *["1234567"] * 4]], text_columns=head[:2]))
    (line, wrapped) = capsys.readouterr().out.splitlines()[-2:]
    assert line.split()[-4:] == ["1234567"] * 4 and wrapped in name


def test_decimal_points_of_a_column_stand_below_each_other(capsys):
    """Errors, too; a unit stays at its number ("-11      %" above "-0.1234 %"), what is none at the right."""
    rows = [
        ["draft", "16", "7.035 ±0.041", "-11 %"],
        ["fine", "4.25", "11.6 ±0.1", "+3.2345 %"],
        ["", "", "-", ""],
    ]
    console().print(table(["mesh", "CPU s", "mean µm", "p-p"], rows, text_columns=["mesh"]))
    head, *lines = capsys.readouterr().out.splitlines()
    assert head.split() == ["mesh", "CPU", "s", "mean", "µm", "p-p"]
    (whole, mean, part), (point, other, lower) = (
        [re.search(mark, line).start() for mark in marks]
        for line, marks in zip(
            lines, ([r" 16 ", r"\.035", r"-11"], [r"\.25", r"\.6 ", r"\.2345 %"]), strict=False
        )
    )
    assert (whole + 3, mean, part + 3) == (point, other, lower)
    assert lines[0].index("±") == lines[1].index("±") and "-11 %" in lines[0]
    assert lines[2].rstrip().endswith("-") and lines[2].index("-") == lines[0].index("±") + 5


class Terminal(io.StringIO):
    """A stream that is one."""

    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("columns", COLUMNS)
def test_a_terminal_breaks_sentences_between_words_and_leaves_paths_whole(columns, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(columns))
    path = f"/tmp/{'unit-' * 30}/flank.nc"
    text = f"error: {'peak-to-peak transmission error ' * 6}of\n  {path} and what follows it {'µm ' * 60}"
    lines = in_lines(text, Terminal()).splitlines()
    assert max(len(line) for line in lines if line != path) <= columns < len(path)
    assert path in lines
    assert " ".join(lines).split() == text.split()
    assert in_lines(text, io.StringIO()) == text, "a pipe has lines of any length"
    shown = Terminal()
    monkeypatch.setattr("sys.stdout", shown)
    console().print(text, soft_wrap=True, style=EMPHASIS)
    printed = re.sub(r"\x1b\[[\d;]*m", "", shown.getvalue())
    assert [line.strip() for line in printed.splitlines()] == [line.strip() for line in lines]


# Styles: on a terminal, and there alone.


def seen_on_a_terminal(arguments: list[str], **environment: str) -> str:
    """Return what a program writes to a terminal of 100 columns."""
    reader, writer = os.openpty()
    own = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "FORCE_COLOR")}
    own |= {"TERM": "xterm-256color", "COLUMNS": "100"} | environment
    command = [sys.executable, "-m", "lineofaction.cli", *arguments]
    with subprocess.Popen(command, stdout=writer, stderr=writer, stdin=subprocess.DEVNULL, env=own) as done:
        os.close(writer)
        text = b""
        with contextlib.suppress(OSError):  # the end of a terminal that nobody writes to
            while part := os.read(reader, 65536):
                text += part
    os.close(reader)
    assert done.returncode == 0, text.decode()
    return text.decode().replace("\r\n", "\n")


BOLD, CYAN, GREY = "\x1b[1m", "\x1b[36m", "\x1b[90m"


@pytest.mark.skipif(sys.platform == "win32", reason="terminals of POSIX")
def test_the_finding_is_bold_errors_are_colored_and_what_is_beside_is_grey(files):
    arguments = ["ste", str(files["TABLE"]), "--torque", "1"]
    shown = seen_on_a_terminal(arguments)
    first = next(line for line in shown.splitlines() if "gear pair" in line)
    assert first.startswith(BOLD)
    assert re.search(re.escape(CYAN) + r"± [\d.]+\x1b", shown)
    assert re.search(re.escape(GREY) + "next: loa report", shown)
    plain = loa(*arguments).output
    assert "\x1b" not in plain
    assert re.sub(r"\x1b\[[\d;]*m", "", shown).split() == plain.split()  # a long path breaks its line
    assert "\x1b[3" not in seen_on_a_terminal(arguments, NO_COLOR="1")
    study = ["complaint", str(SCENE), "--order", "20", "--speed-rpm", "600"]
    assert f"{BOLD}complaint: order 20.0 of " in seen_on_a_terminal(study)


def test_a_table_in_a_pipe_is_as_wide_as_it_needs(capsys):
    names = [f"column_{k:02}" for k in range(15)]
    console().print(table(names, [["1"] * 15]))
    head, row = capsys.readouterr().out.splitlines()
    assert (head.split(), row.split()) == (names, ["1"] * 15)
    assert len(head) > 120


# The help: every verb once, under its group, and whole.


def check_help(columns: int) -> None:
    done = loa("--help")
    assert done.exit_code == 0, done.exception
    shown = done.stdout.split("Start:\n", 1)[1].splitlines()
    own = typer.main.get_command(app)
    assert isinstance(own, StudyGroup)
    heads = [line.removesuffix(":").lower() for line in shown if re.fullmatch(r"[A-Z][a-z]+:", line)]
    assert ["start", *heads] == list(GROUPS)
    listed = [line.split()[0] for line in shown if re.match(r"  [a-z][a-z-]*(  |$)", line)]
    verbs = own.list_commands(typer.Context(own))
    assert sorted(listed) == sorted(verbs)
    assert max(map(len, shown)) <= columns
    text = "".join("".join(shown).split())  # a line may end behind a hyphen
    for verb in verbs:
        said = own.get_command(typer.Context(own), verb)
        assert "".join((said.short_help or said.help).split()) in text


@pytest.mark.parametrize("columns", COLUMNS)
def test_the_help_has_every_verb_in_one_group_and_cuts_no_line(columns, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(columns))
    check_help(columns)
