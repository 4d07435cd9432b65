"""Scenes that end badly, each in its own way, and one that does not."""

import math
import os
import subprocess
import sys
import time

from lineofaction.hardcases import HardScene, Measured


def good() -> list[Measured]:
    return [Measured("one", 1.0, maximum=1.0, minimum=1.0), Measured("for information", 5.0)]


def out_of_bounds() -> list[Measured]:
    return [Measured("two", 2.0, maximum=1.0)]


def no_number() -> list[Measured]:
    return [Measured("nothing", math.nan)]


def unbounded() -> list[Measured]:
    return [Measured("it ran", 1.0)]


def raising() -> list[Measured]:
    raise ZeroDivisionError("by nothing")


def crashing() -> list[Measured]:
    os._exit(7)


def hanging() -> list[Measured]:
    time.sleep(600.0)
    return good()


def starting() -> list[Measured]:
    subprocess.run([sys.executable, "-c", "import time\nwhile time.process_time() < 0.1: pass"], check=True)
    return good()


def scene(measure, time_limit: float = 60.0) -> HardScene:
    return HardScene(measure.__name__, "fake", "It is.", "It holds.", measure, time_limit)


GOOD, OUT_OF_BOUNDS, NO_NUMBER, UNBOUNDED = map(scene, (good, out_of_bounds, no_number, unbounded))
RAISING, CRASHING, HANGING = scene(raising), scene(crashing), scene(hanging, 0.2)
STARTING = scene(starting)
