"""The first message to a page: the scan and all it takes to draw it."""

from __future__ import annotations

from palpate import protocol
from palpate.base.package_version import package_version
from palpate.export.dicom_source import why_no_dicom
from palpate.segmentation.threshold_presets import PRESETS
from palpate.server.messages.soft_tissue import models, presets
from palpate.server.page_words import page_words
from palpate.session.session import Session
from palpate.volumes.scan_hash import scan_identity
from palpate.volumes.volume import Volume

__all__ = ["hello_of", "scan_of"]


def hello_of(session: Session) -> protocol.Hello:
    """Returns the first message, without what changes: segments, and what is kept."""
    settings = protocol.Settings(**session.settings())
    stiffness, force = session.device_limits
    return protocol.Hello(
        protocol=protocol.PROTOCOL_VERSION,
        version=package_version(),
        scan=scan_of(session.scene.volume),
        kept=[],
        segments=[],
        settings=settings,
        defaults=settings,
        device=session.device,
        device_limits=protocol.DeviceLimits(
            stiffness=stiffness, force=force, reach=session.device_reach
        ),
        presets=presets(),
        models=models(),
    )


def scan_of(volume: Volume) -> protocol.Scan:
    """Returns the scan of a message."""
    histogram = volume.histogram
    return protocol.Scan(
        name=volume.name,
        title=volume.title,
        identity=scan_identity(volume),
        patient=volume.traits.patient,
        modality=volume.modality,
        unit=volume.unit,
        dimensions=volume.dimensions,
        spacing=volume.spacing,
        patient_from_grid=[float(number) for number in volume.patient_from_grid.ravel()],
        slope=volume.slope,
        intercept=volume.intercept,
        range=volume.range,
        histogram=protocol.Histogram(
            low=histogram.low,
            high=histogram.high,
            counts=[int(count) for count in histogram.counts],
        ),
        soft_tissue=volume.anchors.soft_tissue,
        bone=volume.anchors.bone,
        presets=_presets(volume),
        volume=_place_of(volume),
        rereadable=volume.source is not None,
        no_dicom=why_no_dicom(volume),
        orientation_known=volume.traits.orientation_known,
        warnings=[page_words(warning) for warning in volume.warnings],
        notes=[page_words(note) for note in volume.notes],
    )


def _place_of(volume: Volume) -> tuple[int, int] | None:
    """Returns which of how many volumes a scan is, where others can be read from its place."""
    siblings = volume.traits.siblings
    if siblings is None or volume.source is None:
        return None
    return siblings.number, len(siblings.keys)


def _presets(volume: Volume) -> list[protocol.ThresholdPreset]:
    """Lists ranges of tissues, as far as the scan's values go; none without HU."""
    if volume.unit != "HU":
        return []
    lowest, highest = volume.range
    ranges = (
        (name, max(low, lowest), highest if high is None else min(high, highest))
        for name, (low, high) in PRESETS.items()
    )
    return [protocol.ThresholdPreset(*each) for each in ranges if each[1] < each[2]]
