"""Foundations of the package: errors, progress, the console, complete files, the state folder."""
