"""Durable jobs: their table, who claims them, and how they end."""
