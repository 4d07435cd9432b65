"""From a checked request to a database, in as many passes as its tolerance needs."""
