"""Which scans a DICOMweb service has, for choosing one: as those of a folder, but not yet here.

What a service tells makes the list; the small picture is decoded from one file of a series, and
its files come when it is chosen.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from palpate.base.errors import VolumeFormatError
from palpate.base.progress import Progress, silent
from palpate.base.reader_process import apart
from palpate.io.browse import Choice
from palpate.io.dicom.header import read_header
from palpate.io.dicom.pixels import read_slice
from palpate.io.dicomweb.address import WebAddress
from palpate.io.dicomweb.series import RemoteSeries, fetch_middle, fetch_series, remote_series
from palpate.io.preview import preview

__all__ = ["browsed_web"]

MOST_PICTURED = 12
"""Pictures that are fetched, each a file of its own."""


@contextmanager
def browsed_web(given: str, *, progress: Progress = silent) -> Iterator[list[Choice]]:
    """Gives the scans of a service, as long as pictures of them are wanted.

    Raises:
        OptionError: What is given is no address.
        DicomWebError: The server is not there, refuses, does not speak DICOMweb, or has none.
    """
    address = WebAddress.of(given)
    listed = remote_series(address, progress=progress)
    with TemporaryDirectory(prefix="palpate-") as folder:
        yield [_choice(address, one, Path(folder)) for one in listed]


def _middle_of(file: Path) -> NDArray[np.uint8]:
    header = read_header(file)
    if header is None or header.samples != 1:
        raise VolumeFormatError("no image of a scan; allowed: CT, MR and other scans")
    pixel = header.frames[0].pixel_spacing or (1.0, 1.0)
    return preview(read_slice(header, len(header.frames) // 2), (pixel[1], pixel[0]))


def _choice(address: WebAddress, one: RemoteSeries, folder: Path) -> Choice:
    def picture() -> NDArray[np.uint8]:
        file = fetch_middle(address, one, folder)
        return apart(_middle_of, file, path=file)

    def fetch(target: Path, progress: Progress) -> None:
        fetch_series(address, one, target, progress=progress)

    flat = one.size is not None and one.size[2] == 1
    return Choice(
        path=Path(),
        patient=one.patient,
        study=one.study_told,
        name=one.description,
        modality=one.modality,
        size=one.size or (),
        refused="it is a single picture; allowed: two slices or more" if flat else None,
        picture=picture,
        fetch=fetch,
    )
