"""Palpate: examine medical scans by touch.

Lengths mm, times s, forces N, stiffness N/mm; points (x, y, z) in LPS, arrays [z, y, x].

    >>> import palpate
    >>> volume = palpate.read("head.mha")
    >>> scene = palpate.Scene(volume, [volume.threshold(1300)])
    >>> with palpate.Session(scene) as session:
    ...     session.place((120.0, 20.0, 110.0))
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from palpate._aliases import alias_modules
from palpate.base.lazy_exports import lazy_exports

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
    from palpate.pictures.camera import Camera
    from palpate.pictures.render import render
    from palpate.registration.carry import Carrier
    from palpate.registration.inverse import Inverse
    from palpate.registration.options import RegistrationError, SearchOptions
    from palpate.registration.registration import Registration, register
    from palpate.segmentation.measures.comparison import Comparison, SegmentComparison, compare
    from palpate.segmentation.measures.landmarks import Landmark, landmarks
    from palpate.segmentation.measures.segment_statistics import (
        SegmentStatistics,
        ValueStatistics,
        statistics,
    )
    from palpate.session.gap import Gap
    from palpate.session.painted_cut import PaintedCut
    from palpate.session.recording import Recording, Replay
    from palpate.session.scripted_path import ScriptedPath
    from palpate.session.scripted_touch import TouchResult, touch
    from palpate.session.session import Session, SessionOptions
    from palpate.session.touch_request import TouchRequest
    from palpate.session.touch_settings import TouchSettings
    from palpate.volumes.material import Material, material_presets
    from palpate.volumes.mesh_read import (
        MeshFile,
        object_of_mesh,
        read_mesh,
        segment_of_mesh,
        suitable_spacing,
    )
    from palpate.volumes.mesh_write import write_mesh
    from palpate.volumes.phantom import Phantom, phantom
    from palpate.volumes.resampled import resampled
    from palpate.volumes.scene import Scene
    from palpate.volumes.second_scan import read_transform
    from palpate.volumes.segment import Segment
    from palpate.volumes.surface import Mesh, Surface
    from palpate.volumes.surface_report import SurfaceReport
    from palpate.volumes.volume import Volume

__all__ = [
    "Camera",
    "Carrier",
    "Comparison",
    "DicomWebError",
    "EmptySegmentError",
    "Gap",
    "Inverse",
    "Label",
    "Labels",
    "Landmark",
    "Material",
    "Mesh",
    "MeshFile",
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
    "SegmentComparison",
    "SegmentStatistics",
    "SeriesChoiceError",
    "Session",
    "SessionOptions",
    "Surface",
    "SurfaceReport",
    "TouchRequest",
    "TouchResult",
    "TouchSettings",
    "ValueStatistics",
    "Volume",
    "VolumeFormatError",
    "WebAddress",
    "compare",
    "export_scene",
    "fetch_series",
    "landmarks",
    "material_presets",
    "object_of_mesh",
    "phantom",
    "read",
    "read_labels",
    "read_mesh",
    "read_transform",
    "register",
    "remote_series",
    "render",
    "resampled",
    "segment_of_mesh",
    "statistics",
    "suitable_spacing",
    "touch",
    "write_mesh",
]

__getattr__ = lazy_exports(
    __name__,
    {
        "Camera": "pictures.camera",
        "Carrier": "registration.carry",
        "Comparison": "segmentation.measures.comparison",
        "DicomWebError": "base.errors",
        "EmptySegmentError": "base.errors",
        "Gap": "session.gap",
        "Inverse": "registration.inverse",
        "Label": "labels.labels",
        "Labels": "labels.labels",
        "Landmark": "segmentation.measures.landmarks",
        "Material": "volumes.material",
        "Mesh": "volumes.surface",
        "MeshFile": "volumes.mesh_read",
        "MeshFormatError": "base.errors",
        "OptionError": "base.errors",
        "PaintedCut": "session.painted_cut",
        "PalpateError": "base.errors",
        "Phantom": "volumes.phantom",
        "Recording": "session.recording",
        "RecordingFormatError": "base.errors",
        "Registration": "registration.registration",
        "RegistrationError": "registration.options",
        "Replay": "session.recording",
        "Scene": "volumes.scene",
        "ScriptedPath": "session.scripted_path",
        "SearchOptions": "registration.options",
        "Segment": "volumes.segment",
        "SegmentComparison": "segmentation.measures.comparison",
        "SegmentStatistics": "segmentation.measures.segment_statistics",
        "SeriesChoiceError": "base.errors",
        "Session": "session.session",
        "SessionOptions": "session.session",
        "Surface": "volumes.surface",
        "SurfaceReport": "volumes.surface_report",
        "TouchRequest": "session.touch_request",
        "TouchResult": "session.scripted_touch",
        "TouchSettings": "session.touch_settings",
        "ValueStatistics": "segmentation.measures.segment_statistics",
        "Volume": "volumes.volume",
        "VolumeFormatError": "base.errors",
        "WebAddress": "io.dicomweb.address",
        "compare": "segmentation.measures.comparison",
        "export_scene": "export.export",
        "fetch_series": "io.dicomweb.series",
        "landmarks": "segmentation.measures.landmarks",
        "material_presets": "volumes.material",
        "object_of_mesh": "volumes.mesh_read",
        "phantom": "volumes.phantom",
        "read": "io.reading",
        "read_labels": "labels.labels",
        "read_mesh": "volumes.mesh_read",
        "read_transform": "volumes.second_scan",
        "register": "registration.registration",
        "remote_series": "io.dicomweb.series",
        "render": "pictures.render",
        "resampled": "volumes.resampled",
        "segment_of_mesh": "volumes.mesh_read",
        "statistics": "segmentation.measures.segment_statistics",
        "suitable_spacing": "volumes.mesh_read",
        "touch": "session.scripted_touch",
        "write_mesh": "volumes.mesh_write",
    },
)

alias_modules()
