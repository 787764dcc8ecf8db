"""Scans and their contents: volumes, segments, scenes, surfaces, meshes and materials."""
