"""What carries the teeth of a gear, and what holds it: blank, seat of the bore, shaft; light."""
