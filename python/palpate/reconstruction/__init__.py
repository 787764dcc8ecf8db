"""Reconstruction: scans from projections, by filtered back-projection."""
