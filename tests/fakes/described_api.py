"""The description of the API with all its processes, made once: it takes a second."""

import tempfile
from pathlib import Path
from typing import Any

from service.app import create_app
from service.settings import Settings

with tempfile.TemporaryDirectory(prefix="loa-description-") as _directory:
    DESCRIPTION: dict[str, Any] = create_app(Settings(data_directory=Path(_directory))).openapi()
