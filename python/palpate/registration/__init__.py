"""Registration: where the points of one scan lie in another."""
