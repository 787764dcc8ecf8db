"""Segments to files: masks, and segmentations of 3D Slicer (``.seg.nrrd``).

Source: "Segmentation file format", 3D Slicer developer guide.
"""

from __future__ import annotations

from pathlib import Path

from palpate.errors import OptionError
from palpate.segment import Segment
from palpate.simpleitk import reason_of, simpleitk

__all__ = ["SEGMENT_SUFFIXES", "write_segments"]

SEGMENT_SUFFIXES = (".seg.nrrd", ".nrrd", ".nii.gz", ".nii", ".mha")
"""Endings of names, longer ones first."""


def write_segments(segments: list[Segment], path: Path) -> None:
    """Writes segments of one scan as labels 1, 2, … on its grid; a later one lies on top.

    The file is there whole or not at all.

    Raises:
        OptionError: There is none, or more than a byte can number, or the name says no format.
        OSError: The disk refuses it.
    """
    suffix = next((one for one in SEGMENT_SUFFIXES if path.name.lower().endswith(one)), None)
    if suffix is None:
        raise OptionError(
            f"{path.name!r} given; allowed: a name with {', '.join(SEGMENT_SUFFIXES)}"
        )
    if not 1 <= len(segments) <= 255:
        raise OptionError(f"{len(segments)} segments given; allowed: 1 to 255")
    volume = segments[0].volume
    labels = segments[0].mask()
    for number, segment in enumerate(segments[1:], start=2):
        labels[segment.mask() != 0] = number
    sitk = simpleitk()
    image = sitk.GetImageFromArray(labels)
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    image.SetDirection(volume.direction.ravel().tolist())
    if suffix == ".seg.nrrd":
        for place, segment in enumerate(segments):
            _describe(image, place, segment)
    unfinished = path.with_name(f".{path.name}.part{suffix}")
    try:
        sitk.WriteImage(image, str(unfinished), useCompression=True)
        unfinished.replace(path)
    except RuntimeError as error:
        raise OSError(f"{path} cannot be written: {reason_of(error)}") from None
    finally:
        unfinished.unlink(missing_ok=True)


def _describe(image: object, place: int, segment: Segment) -> None:
    """Writes what Slicer wants to know of a segment into the header."""
    low, high = segment.bounding_box or ((0, 0, 0), (1, 1, 1))
    extent = " ".join(f"{first} {end - 1}" for first, end in zip(low, high, strict=True))
    fields = {
        "ID": f"Segment_{place + 1}",
        "Name": " ".join(segment.name.split()) or f"segment {place + 1}",
        "LabelValue": str(place + 1),
        "Layer": "0",
        "Extent": extent,
    }
    for field, value in fields.items():
        image.SetMetaData(f"Segment{place}_{field}", value)  # type: ignore[attr-defined]
