"""Readers of the formats of recordings, by libraries; they run in a confined process (`signals.worker`)."""
