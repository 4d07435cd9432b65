"""The types of a study, of its function and of the client's process follow from its row of the registry."""

from importlib import import_module
from inspect import signature

import lineofaction as loa
from lineofaction.client import AsyncLineOfActionClient, AsyncProcess, LineOfActionClient, Process
from lineofaction.gearbox import computations, registry
from lineofaction.gearbox.registry import STUDIES


def test_every_row_has_its_own_computation():
    for row in STUDIES.values():
        computation = import_module(f"lineofaction.gearbox.studies.{row.package}.run").RUN
        assert row.run is computation
        assert type(computation).inputs is row.inputs


def test_every_row_is_a_function():
    assert registry.__all__ == sorted(row.package for row in STUDIES.values())
    assert computations.__all__ == [name.upper() for name in registry.__all__]
    for row in STUDIES.values():
        function = getattr(loa, row.package)
        assert function is getattr(registry, row.package) is row.function
        assert next(iter(signature(function).parameters)) == "subject"
        assert function.__doc__.startswith(row.description)


def test_every_row_is_a_process_of_both_clients():
    blocking, awaited = LineOfActionClient(), AsyncLineOfActionClient()
    for row in STUDIES.values():
        assert isinstance(getattr(blocking, row.package), Process)
        assert isinstance(getattr(awaited, row.package), AsyncProcess)
        assert str(signature(blocking.process(row))) == str(signature(getattr(awaited, row.package)))
        assert row.package in dir(blocking) and row.package in dir(loa)
        assert (row.takes.subject == "case or scene") == (row.argument == "subject")


def test_what_a_file_of_inputs_is_called_and_whether_it_may_be_left_out_are_those_of_the_types():
    filed = {row.name: row.takes.bare for row in STUDIES.values() if row.takes.from_file}
    bare = {"optimize": True, "deflect": True}
    assert filed == bare | {"change": False, "force-waves": False, "study": False}
