"""Durable jobs: a table, a scheduler, and one child process per computation."""
