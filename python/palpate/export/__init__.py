"""Export: segments and scans as files that other programs read."""
