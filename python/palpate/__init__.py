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
    from palpate.base.errors import (
        DicomWebError,
        EmptySegmentError,
        MeshFormatError,
        OptionError,
        PalpateError,
        RecordingFormatError,
        SeriesChoiceError,
        VolumeFormatError,
    )
    from palpate.export.export import export_scene
    from palpate.io.dicomweb.address import WebAddress
    from palpate.io.dicomweb.series import fetch_series, remote_series
    from palpate.io.reading import read
    from palpate.labels.labels import Label, Labels, read_labels
    from palpate.registration.options import RegistrationError, SearchOptions
    from palpate.registration.registration import Registration, register
    from palpate.session.gap import Gap
    from palpate.session.painted_cut import PaintedCut
    from palpate.session.recording import Recording, Replay
    from palpate.session.scripted_path import ScriptedPath
    from palpate.session.session import Session, SessionOptions
    from palpate.session.touch_settings import TouchSettings
    from palpate.volumes.phantom import Phantom, phantom
    from palpate.volumes.scene import Scene
    from palpate.volumes.segment import Segment
    from palpate.volumes.surface import Surface
    from palpate.volumes.volume import Volume

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
    "DicomWebError": "base.errors",
    "EmptySegmentError": "base.errors",
    "MeshFormatError": "base.errors",
    "OptionError": "base.errors",
    "PalpateError": "base.errors",
    "RecordingFormatError": "base.errors",
    "SeriesChoiceError": "base.errors",
    "VolumeFormatError": "base.errors",
    "export_scene": "export.export",
    "Gap": "session.gap",
    "read": "io.reading",
    "fetch_series": "io.dicomweb.series",
    "remote_series": "io.dicomweb.series",
    "WebAddress": "io.dicomweb.address",
    "Label": "labels.labels",
    "Labels": "labels.labels",
    "read_labels": "labels.labels",
    "PaintedCut": "session.painted_cut",
    "Phantom": "volumes.phantom",
    "phantom": "volumes.phantom",
    "Scene": "volumes.scene",
    "ScriptedPath": "session.scripted_path",
    "Registration": "registration.registration",
    "register": "registration.registration",
    "RegistrationError": "registration.options",
    "SearchOptions": "registration.options",
    "Segment": "volumes.segment",
    "Recording": "session.recording",
    "Replay": "session.recording",
    "Session": "session.session",
    "SessionOptions": "session.session",
    "Surface": "volumes.surface",
    "TouchSettings": "session.touch_settings",
    "Volume": "volumes.volume",
}
"""Module of each public name: imported when first asked for, so that the package starts fast."""


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{home}"), name)
