"""Segmentation: segments made from scans and from other segments."""
