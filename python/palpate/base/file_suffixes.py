"""Endings of files that are written."""

from __future__ import annotations

__all__ = ["IMAGE_SUFFIXES", "MESH_SUFFIXES"]

IMAGE_SUFFIXES = (".nii.gz", ".nii", ".nrrd", ".mha")
"""Of scans and label maps."""
MESH_SUFFIXES = (".stl", ".ply", ".obj", ".glb")
