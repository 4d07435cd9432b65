"""Runs that make a database from a checked request, in as many passes as its tolerance needs."""
