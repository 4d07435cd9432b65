"""What the tests of other engines share."""

import numpy as np
import pytest
from mesh_elements import helical_element


@pytest.fixture
def element():
    return helical_element()


@pytest.fixture
def rng():
    return np.random.default_rng(11)
