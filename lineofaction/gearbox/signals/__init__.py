"""Recordings from outside: channels of measured series, read by a confined process, with their units."""

from lineofaction.gearbox.signals.channel import Channel
from lineofaction.gearbox.signals.recording import (
    ENDINGS,
    UNIVERSAL,
    Recording,
    begins_with_time,
    read_frequency_responses,
    read_recording,
)

__all__ = [
    "ENDINGS",
    "UNIVERSAL",
    "Channel",
    "Recording",
    "begins_with_time",
    "read_frequency_responses",
    "read_recording",
]
