"""Plan of a run from a pair, an accuracy and a contact model."""
