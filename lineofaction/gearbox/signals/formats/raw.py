"""Channels as a reader of recordings returns them, and the error for a file without usable channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

MAX_CHANNELS = 1024
MAX_SAMPLES = 20_000_000
"""Most samples of all channels that are read together: half a GB with their times."""


class UnusableFile(Exception):
    """A file without readable channels: the accepted content, a remedy, and the field at fault."""

    def __init__(self, bound: str, remedy: str = "Export it again.", value: str = "") -> None:
        self.bound, self.remedy, self.value = bound, remedy, value
        super().__init__(bound)


@dataclass(frozen=True)
class RawChannel:
    """A channel before it is checked; `values` and `abscissa` are arrays of numbers (n,).

    `abscissa` is an array, or the first value and the step of an even one; `nodes` has response node and
    direction, reference node and direction of a frequency response.
    """

    name: str
    values: Any
    abscissa: Any
    unit: str = ""
    over: str = "time"
    label: str = ""
    direction: str = ""
    nodes: tuple[int, ...] = ()


class SampleBudget:
    """Count of the samples that a reader is about to take, up to a number of channels and samples."""

    def __init__(self, max_channels: int = MAX_CHANNELS) -> None:
        self.max_channels = max_channels
        self.channels = self.samples = 0

    def take(self, samples: int) -> None:
        """Count one more channel of so many samples.

        Raises `UnusableFile`: there are too many of either.
        """
        self.channels += 1
        self.samples += samples
        if self.channels > self.max_channels or self.samples > MAX_SAMPLES:
            bound = f"a file of at most {self.max_channels} channels and {MAX_SAMPLES} samples"
            raise UnusableFile(bound, "Export a shorter stretch, or name the channels that are needed.")


def wanted(name: str, names: Sequence[str]) -> bool:
    """Whether a channel is to be read: all are if none is named."""
    return not names or name in names
