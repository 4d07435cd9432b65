"""The body of a gear and its supports: blank, seat of the bore, shaft; light."""
