"""Calls that tell other services about jobs: who may be called, rows in the database, signed requests."""
