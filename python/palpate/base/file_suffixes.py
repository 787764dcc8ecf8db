"""Endings of files that are written."""

from __future__ import annotations

__all__ = ["FILM_SUFFIXES", "IMAGE_SUFFIXES", "MESH_SUFFIXES", "PICTURE_SUFFIXES"]

IMAGE_SUFFIXES = (".nii.gz", ".nii", ".nrrd", ".mha")
"""Of scans and label maps."""
MESH_SUFFIXES = (".stl", ".ply", ".obj", ".glb")
PICTURE_SUFFIXES = (".png", ".jpg", ".jpeg")
FILM_SUFFIXES = (".gif", ".mp4", ".webm")
