"""A module whose import takes a while, and which counts the imports that began."""

import os
import time


def attempts() -> int:
    """Return how many imports of this module began in this process."""
    return int(os.environ.get(__name__, "0"))


os.environ[__name__] = str(attempts() + 1)
for _ in range(60):
    time.sleep(0.01)
