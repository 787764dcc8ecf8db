"""Palpate: examine medical scans by touch.

Lengths mm, times s, forces N, stiffness N/mm; points (x, y, z) in LPS, arrays [z, y, x].

    >>> import palpate
    >>> volume = palpate.read("head.mha")
    >>> scene = palpate.Scene(volume, [volume.threshold(1300)])
    >>> with palpate.Session(scene) as session:
    ...     session.place((120.0, 20.0, 110.0))
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from palpate.errors import (
        DicomWebError,
        EmptySegmentError,
        MeshFormatError,
        OptionError,
        PalpateError,
        RecordingFormatError,
        SeriesChoiceError,
        VolumeFormatError,
    )
    from palpate.export import export_scene
    from palpate.gap import Gap
    from palpate.io import read
    from palpate.io_dicomweb import fetch_series, remote_series
    from palpate.io_dicomweb_address import WebAddress
    from palpate.labels import Label, Labels, read_labels
    from palpate.painted_cut import PaintedCut
    from palpate.phantom_scan import Phantom, phantom
    from palpate.recording import Recording, Replay
    from palpate.registration import Registration, register
    from palpate.registration_options import RegistrationError, SearchOptions
    from palpate.scene import Scene
    from palpate.scripted_path import ScriptedPath
    from palpate.segment import Segment
    from palpate.session import Session, SessionOptions
    from palpate.surface import Surface
    from palpate.touch_settings import TouchSettings
    from palpate.volume import Volume

__all__ = [
    "DicomWebError",
    "EmptySegmentError",
    "Gap",
    "Label",
    "Labels",
    "MeshFormatError",
    "OptionError",
    "PaintedCut",
    "PalpateError",
    "Phantom",
    "Recording",
    "RecordingFormatError",
    "Registration",
    "RegistrationError",
    "Replay",
    "Scene",
    "ScriptedPath",
    "SearchOptions",
    "Segment",
    "SeriesChoiceError",
    "Session",
    "SessionOptions",
    "Surface",
    "TouchSettings",
    "Volume",
    "VolumeFormatError",
    "WebAddress",
    "export_scene",
    "fetch_series",
    "phantom",
    "read",
    "read_labels",
    "register",
    "remote_series",
]

_HOMES = {
    "DicomWebError": "errors",
    "EmptySegmentError": "errors",
    "MeshFormatError": "errors",
    "OptionError": "errors",
    "PalpateError": "errors",
    "RecordingFormatError": "errors",
    "SeriesChoiceError": "errors",
    "VolumeFormatError": "errors",
    "export_scene": "export",
    "Gap": "gap",
    "read": "io",
    "fetch_series": "io_dicomweb",
    "remote_series": "io_dicomweb",
    "WebAddress": "io_dicomweb_address",
    "Label": "labels",
    "Labels": "labels",
    "read_labels": "labels",
    "PaintedCut": "painted_cut",
    "Phantom": "phantom_scan",
    "phantom": "phantom_scan",
    "Scene": "scene",
    "ScriptedPath": "scripted_path",
    "Registration": "registration",
    "register": "registration",
    "RegistrationError": "registration_options",
    "SearchOptions": "registration_options",
    "Segment": "segment",
    "Recording": "recording",
    "Replay": "recording",
    "Session": "session",
    "SessionOptions": "session",
    "Surface": "surface",
    "TouchSettings": "touch_settings",
    "Volume": "volume",
}
"""Module of each public name: imported when first asked for, so that the package starts fast."""


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{home}"), name)
