"""Scans and what is in them: volumes, segments, scenes, surfaces, meshes and materials."""
