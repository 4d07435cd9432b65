"""Recordings from outside: channels of measured series, read by a confined process, with their units."""
