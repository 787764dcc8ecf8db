"""Errors in what a user provides: one exception for each kind, each with a one-line message.

A message says what was given and what is allowed. The command line prints it and ends with exit
code 2, without a traceback.
"""

from __future__ import annotations

__all__ = [
    "ConfirmationNeededError",
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
    """Base of all errors in what a user provides; the message says what is allowed."""


class OptionError(PalpateError, ValueError):
    """An option has a value that is not allowed."""


class VolumeFormatError(PalpateError, ValueError):
    """A file or folder cannot be read as one three-dimensional scan."""


class SeriesChoiceError(VolumeFormatError):
    """A folder holds several series, or not the requested one."""


class ConfirmationNeededError(PalpateError):
    """A person must say first that something was looked at; then the same is done."""


class EmptySegmentError(PalpateError, ValueError):
    """A threshold or mesh selects no voxel."""


class MeshFormatError(PalpateError, ValueError):
    """A file is not a mesh, or a mesh cannot be used."""


class RecordingFormatError(PalpateError, ValueError):
    """A file is not a recording, or is damaged."""


class SceneFormatError(PalpateError, ValueError):
    """A file is not a scene, is damaged, or its scan is missing."""


class DicomWebError(PalpateError):
    """A DICOMweb server is not reachable, refuses, or does not send what was requested."""
