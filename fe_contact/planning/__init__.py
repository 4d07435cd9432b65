"""From a pair, an accuracy and a contact model to a plan."""
