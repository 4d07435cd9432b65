"""A verb that is called again for an equal scene and equal inputs gets the result of the first call.

The files of a verb are written one by one, each by a call; what it computes for them is the same.
"""

import pickle
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import pytest


@contextmanager
def computed_once(study: ModuleType) -> Iterator[None]:
    """Let a study of scenes in housings (its module `run`) compute what is equal once."""
    compute, known = study.RUN.compute, {}

    def remembered(subject: Any, inputs: Any, means: Any) -> Any:
        key = subject.inputs.model_dump_json(), inputs.model_dump_json(), pickle.dumps(dict(subject.housings))
        if key not in known:
            known[key] = compute(subject, inputs, means)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study.RUN, "compute", remembered)
        yield
