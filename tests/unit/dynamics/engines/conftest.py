"""What the tests of other engines share."""

import numpy as np
import pytest
from mesh_elements import helical_element

from dynamics.engines import MeshElement


@pytest.fixture
def element() -> MeshElement:
    return helical_element()


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(11)
