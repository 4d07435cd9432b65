"""Secrets of the settings from files: ``LOA_NAME_FILE`` in place of ``LOA_NAME``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, get_args

from pydantic import SecretStr
from pydantic.fields import FieldInfo
from pydantic_settings import BaseSettings, PydanticBaseSettingsSource

from lineofaction.gearbox.problems import BadInput

_MAX_CHARACTERS = 65_536
"""Most characters of a secret; the rest of its file is not read."""


def is_secret(field: FieldInfo) -> bool:
    """Whether the value of a setting is a secret."""
    return SecretStr in (field.annotation, *get_args(field.annotation))


class SecretFiles(PydanticBaseSettingsSource):
    """Reads the files that ``LOA_NAME_FILE`` names, for every setting that is a secret.

    Containers get secrets as files: unlike the environment they are not shown by `docker inspect`, and
    workers do not inherit them.
    """

    def __init__(self, settings_class: type[BaseSettings]) -> None:
        super().__init__(settings_class)
        self._prefix = str(settings_class.model_config["env_prefix"])

    def get_field_value(self, field: FieldInfo, field_name: str) -> tuple[str | None, str, bool]:
        """Return the secret of a field, None if no file is named; then the field's name and False.

        pydantic asks for these three; the last says that the value is no JSON to be decoded.
        Raises `BadInput`: the secret itself is in the environment too; or the file cannot be read, is empty
        or no text.
        """
        name = self._prefix + field_name.upper()
        file = os.environ.get(f"{name}_FILE") if is_secret(field) else None
        if not file:
            return None, field_name, False
        if os.environ.get(name):
            tip = f"Remove one of them, rather {name}."
            raise BadInput.of(field_name, "(not shown)", f"in {name} or in {name}_FILE, not in both", tip)
        return _content(Path(file), f"{name}_FILE", field_name), field_name, False

    def __call__(self) -> dict[str, Any]:
        """Return all secrets that are in files."""
        fields = self.settings_cls.model_fields.items()
        values = {name: self.get_field_value(field, name)[0] for name, field in fields}
        return {name: value for name, value in values.items() if value is not None}


def _content(file: Path, variable: str, field: str) -> str:
    """Return the content of a file, without the end of its line."""
    tip = f"It is named by {variable}; the user of the service must be able to read it."
    try:
        with file.open(encoding="utf-8") as stream:
            content = stream.read(_MAX_CHARACTERS).rstrip("\r\n")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is no UTF-8"
        raise BadInput.of(field, str(file), f"a file with the secret: {reason}", tip) from None
    if not content:
        raise BadInput.of(field, str(file), "a file with the secret: it is empty", tip)
    return content
