"""Saved work: scene files, journals, autosaves and recent scans."""
