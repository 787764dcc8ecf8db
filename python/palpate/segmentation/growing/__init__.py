"""A region that grows from a click or from seeds: where it could end, and where it does."""
