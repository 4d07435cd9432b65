from own_process import ROOT, python

RUN_UP_PROGRAM = """
from numba.core.dispatcher import Dispatcher
from dynamics.simulation import compile_ahead, simulate
from dynamics.loads import TimeLaw
from geared_scenes import gear_pair_scene

compile_ahead()
found, compiled = [], Dispatcher.compile

def watched(self, signature):
    known = len(self.overloads)
    address = compiled(self, signature)
    if len(self.overloads) > known:
        found.append(f"{self.py_func.__module__}.{self.py_func.__name__}")
    return address

Dispatcher.compile = watched
simulate(gear_pair_scene(speed=TimeLaw.ramp(0.0, 30.0, 0.02), duration=0.02))
print([name for name in found if name.startswith("dynamics.integrators")])
"""


def test_after_it_a_run_up_finds_all_loops_of_the_integrators():
    with python("-c", RUN_UP_PROGRAM, settings={"PYTHONPATH": str(ROOT / "tests" / "fakes")}) as process:
        assert process.communicate()[0] == "[]\n"
