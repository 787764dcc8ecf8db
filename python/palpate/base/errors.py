"""What can go wrong with what a person gives: one exception per kind, one line each.

A message says what was given and what is allowed. The command line prints it and ends with
exit code 2; it is never a traceback.
"""

from __future__ import annotations

__all__ = [
    "DicomWebError",
    "EmptySegmentError",
    "MeshFormatError",
    "OptionError",
    "PalpateError",
    "RecordingFormatError",
    "SceneFormatError",
    "SeriesChoiceError",
    "VolumeFormatError",
]


class PalpateError(Exception):
    """Something given to Palpate cannot be used; the message says why and what can."""


class OptionError(PalpateError, ValueError):
    """An option has a value that is not allowed."""


class VolumeFormatError(PalpateError, ValueError):
    """A file or folder that cannot be read as one three-dimensional scan."""


class SeriesChoiceError(VolumeFormatError):
    """A folder holds several series, or not the one asked for."""


class EmptySegmentError(PalpateError, ValueError):
    """A threshold that selects no voxel."""


class MeshFormatError(PalpateError, ValueError):
    """A file that is no mesh, or a mesh that cannot be used."""


class RecordingFormatError(PalpateError, ValueError):
    """A file that is no recording, or a damaged one."""


class SceneFormatError(PalpateError, ValueError):
    """A file that is no scene, a damaged one, or one whose scan is gone."""


class DicomWebError(PalpateError):
    """A server that is not there, refuses, or does not send what it was asked for."""
