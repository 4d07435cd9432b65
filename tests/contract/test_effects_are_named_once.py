"""An effect is named in its file and in the registry: everything else asks what it adds or brings."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from dynamics.effects import EFFECTS as OF_DYNAMICS
from fe_contact.contact import ContactModel
from fe_contact.effects import EFFECTS as OF_CONTACT

ROOT = Path(__file__).parents[2]
PRODUCT = ("dynamics", "fe_contact", "model_studies", "lineofaction", "service")
EXAMPLES = ("lineofaction/hardcases/", "service/page/files.py", "service/schemas/examples.py")
WORDS = {"axial", "backlash", "friction", "lateral", "misalignment", "tilt"}
"""Effects whose names are directions or quantities too: refused where an effect is chosen or looked up."""
REMAINS = {
    ("dynamics/simulation/documents.py", "flexible_shafts"): "heading of the case that a result echoes",
    ("fe_contact/planning/plan.py", "finite_width"): "key of the hash by which tables are stored",
    ("fe_contact/ste/curve.py", "finite_width"): "source of an error in stored tables",
    ("fe_contact/analysis/estimates/assessed_table.py", "finite_width"): "the same source",
    ("lineofaction/gearbox/convert/scene.py", "shaft_deflection"): "the ledger of a stored table",
    (
        "lineofaction/gearbox/studies/sensitivity/run.py",
        "corner_contact",
    ): "field of the result's file",
}
CHOSEN_BY = ("choices", "decided", "effect", "effects", "ledger", "neglected", "turned_on")


def files_of(effects: Sequence[object]) -> set[Path]:
    return {Path(inspect.getfile(type(effect))).resolve() for effect in effects}


def parents(tree: ast.AST) -> dict[ast.AST, ast.AST]:
    return {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}


def chooses(node: ast.Constant, above: dict[ast.AST, ast.AST]) -> bool:
    """Whether a word stands where an effect is chosen: looked up in choices or a ledger, or compared."""
    parent = above[node]
    if isinstance(parent, ast.Call) and isinstance(parent.func, ast.Attribute):
        return ast.unparse(parent.func.value).split(".")[-1] in CHOSEN_BY
    if isinstance(parent, ast.Subscript):
        return ast.unparse(parent.value).split(".")[-1] in CHOSEN_BY
    if isinstance(parent, ast.Compare):
        return ast.unparse(parent.left).split(".")[-1] in CHOSEN_BY
    holder = above.get(parent)
    if isinstance(parent, ast.Dict) and isinstance(holder, ast.keyword):
        return holder.arg in CHOSEN_BY
    if isinstance(parent, ast.Dict) and isinstance(holder, ast.Assign):
        return ast.unparse(holder.targets[0]) in CHOSEN_BY
    return False


def excused(node: ast.AST, above: dict[ast.AST, ast.AST]) -> bool:
    """Whether a name is an example, in a list of exports, or what an effect is asked for by."""
    while node in above:
        node = above[node]
        if isinstance(node, ast.keyword) and node.arg == "examples":
            return True
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] == "named":
            return True
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__":
            return True
    return False


def named_in(source: str, names: set[str], classes: set[str]) -> Iterator[tuple[int, str]]:
    """Yield line and name wherever an effect is named."""
    tree = ast.parse(source)
    above = parents(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and "effects" in (node.module or "").split("."):
            yield from ((node.lineno, alias.name) for alias in node.names if alias.name in classes)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in names:
            choosing = node.value not in WORDS or chooses(node, above)
            if choosing and not excused(node, above):
                yield node.lineno, node.value


def all_named() -> list[tuple[str, int, str]]:
    """Return every place in the product where an effect is named outside its file and the registry."""
    effects = (*OF_DYNAMICS, *OF_CONTACT)
    names, classes = {effect.name for effect in effects}, {type(effect).__name__ for effect in effects}
    own = files_of(effects) | {ROOT / package / "effects/registry.py" for package in PRODUCT}
    places = []
    for package in PRODUCT:
        for file in sorted((ROOT / package).rglob("*.py")):
            path = file.relative_to(ROOT).as_posix()
            if file.resolve() not in own and not path.startswith(EXAMPLES):
                places += [(path, *place) for place in named_in(file.read_text(), names, classes)]
    return places


@pytest.mark.law
def test_no_effect_is_named_outside_its_file_and_the_registry() -> None:
    places = all_named()
    assert [place for place in places if (place[0], place[2]) not in REMAINS] == []
    assert {(path, name) for path, _, name in places} == set(REMAINS)


@pytest.mark.parametrize(
    "line",
    [
        'if scene.effects.get("axial") == "off": pass',
        'ledger.on("backlash", mesh)',
        'found = [entry for entry in entries if entry.effect == "friction"]',
        'run(effects={"tilt": "on"})',
        'names = ["gyroscopic"]',
        "from dynamics.effects.gyroscopic import Gyroscopic",
    ],
)
def test_each_way_to_name_an_effect_is_seen(line: str) -> None:
    names = {effect.name for effect in OF_DYNAMICS}
    assert list(named_in(line, names, {"Gyroscopic"}))


def test_what_effects_of_the_contact_bring_is_brought_once() -> None:
    brought = [effect.brings for effect in OF_CONTACT if effect.brings]
    assert len(set(brought)) == len(brought)
    switches = {"across_face", "corner_contact", "finite_width"}
    assert switches <= set(brought) & set(vars(ContactModel()))


def test_what_effects_of_dynamics_add_is_added_once() -> None:
    added = [addition for effect in OF_DYNAMICS for addition in effect.adds]
    assert len(set(added)) == len(added)
