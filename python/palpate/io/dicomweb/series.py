"""Series of a DICOMweb service: which it has (QIDO-RS), and their files, brought here (WADO-RS).

Through dicomweb-client. A server is not trusted: how much it may send is bounded, files are put
under numbers, and what is not of the series that was asked for is refused.

Source: DICOM PS3.18, 10.4 (retrieve) and 10.6 (search).
"""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from palpate.base.errors import DicomWebError, SeriesChoiceError
from palpate.base.progress import Progress, silent
from palpate.io.dicom.dates import written_date
from palpate.io.dicom.dose import RTDOSE
from palpate.io.dicom.header import DERIVED_OBJECTS
from palpate.io.dicomweb.address import WebAddress
from palpate.io.dicomweb.answer import Found, bytes_of, list_of, text_of, uid_of, whole_of
from palpate.io.dicomweb.http import asking, client_of, in_parallel, pool_of

if TYPE_CHECKING:
    from dicomweb_client.web import DICOMwebClient

__all__ = ["RemoteSeries", "choose_remote", "fetch_middle", "fetch_series", "remote_series"]

MOST_SERIES = 500
"""Most series listed for one service."""
MOST_LIST_BYTES = 1 << 26
"""Most bytes of the lists of a service."""
MOST_FILES = 50_000
MOST_BYTES = 16 * 2**30
"""Most bytes of a series, as for archives."""
SPARE = 2**28
"""Disk space that is left free [bytes]."""
PAGE = 1000
"""Files requested in one list."""
PATIENCE = 0.2
"""Time between two checks for cancellation [s]."""

OF_SERIES = (
    "PatientName", "PatientID", "StudyDate", "StudyDescription", "SeriesDescription",
    "NumberOfSeriesRelatedInstances",
)  # fmt: skip
OF_FILES = ("Rows", "Columns", "BitsAllocated", "SamplesPerPixel", "NumberOfFrames")


@dataclass(frozen=True, kw_only=True)
class RemoteSeries:
    """A series as its server describes it."""

    study: str
    uid: str
    patient: str = ""
    """Name and identifier of the patient."""
    study_told: str = ""
    """Date and description of the study."""
    description: str = ""
    modality: str = ""
    number: int = 0
    files: int | None = None
    """Number of files; None where the server does not state it."""
    picture: tuple[int, int] | None = None
    """Columns and rows of its first file; None where the server does not state them."""
    frames: int = 1
    """Number of frames of its first file."""
    file_bytes: int | None = None
    """Bytes of the pixels of its first file, before compression."""

    @property
    def size(self) -> tuple[int, int, int] | None:
        """Pixels along columns, rows and slices, as far as its first file states them."""
        if self.picture is None or self.files is None:
            return None
        return (*self.picture, self.files * self.frames)

    @property
    def bytes(self) -> int | None:
        """Bytes of all pixels, before compression."""
        if self.files is None or self.file_bytes is None:
            return None
        return self.files * self.file_bytes

    def __str__(self) -> str:
        files = "" if self.files is None else f", {self.files} files"
        said = f" {self.description!r}" if self.description else ""
        return f"{self.uid}{said} {self.modality}{files}"


# --- which there are --------------------------------------------------------------------


def remote_series(address: WebAddress, *, progress: Progress = silent) -> list[RemoteSeries]:
    """Lists the image series of a service or a study, newest studies first.

    Raises:
        DicomWebError: The server is not reachable, refuses, does not speak DICOMweb, or has no
            series.
    """
    with asking(address, MOST_LIST_BYTES) as budget:
        progress(f"asking {address} for series", None)
        with client_of(address, budget) as client:
            listed = [_series_of(found, address) for found in _search(client, address)]
        images = [one for one in listed if one.modality not in DERIVED_OBJECTS]
        if not images:
            what = "images" if listed else "series that fit"
            raise DicomWebError(
                f"the server at {address} has no {what}; allowed: a service or study with scans"
            )
        if len(images) > MOST_SERIES:
            raise DicomWebError(
                f"the server at {address} has more than {MOST_SERIES} series; allowed: one study, "
                "as in …/studies/UID, or a search, as in …/studies?PatientID=12345"
            )
        measured = []
        for done, one in enumerate(in_parallel(_measured, images, (address, budget))):
            progress(f"looking at {len(images)} series", done / len(images))
            measured.append(one)
    measured.sort(key=lambda one: (one.study, one.modality == RTDOSE, one.number, one.uid))
    return sorted(measured, key=lambda one: one.study_told[:8], reverse=True)


def choose_remote(
    address: WebAddress, listed: Sequence[RemoteSeries], wanted: str | None
) -> RemoteSeries:
    """Returns the only series, or the one of a UID, a description or a number.

    Raises:
        SeriesChoiceError: There are several, or not the requested one.
    """
    named = [one for one in listed if wanted in (None, one.uid, one.description)]
    if wanted is not None and wanted.isdecimal() and 1 <= int(wanted) <= len(listed):
        named = named or [listed[int(wanted) - 1]]
    if wanted is None:
        # a dose beside a scan leaves no doubt which one is meant
        named = [one for one in named if one.modality != RTDOSE] or named
    if len(named) == 1:
        return named[0]
    asked = f"{len(named) or 'no'} series" + ("" if wanted is None else f" {wanted!r}")
    raise SeriesChoiceError(
        f"the server at {address} has {asked}; allowed: one, with `series=UID`, its description or "
        "its number in the list"
    )


def _search(client: DICOMwebClient, address: WebAddress) -> list[Found]:
    filters = dict(address.filters)
    if address.series is not None:
        filters["SeriesInstanceUID"] = address.series
    return list_of(
        client.search_for_series(
            address.study, limit=MOST_SERIES + 1, fields=OF_SERIES, search_filters=filters
        )
    )


def _series_of(found: Found, address: WebAddress) -> RemoteSeries:
    study = text_of(found, "StudyInstanceUID") or address.study or ""
    date = written_date(text_of(found, "StudyDate"))
    return RemoteSeries(
        study=uid_of(study),
        uid=uid_of(text_of(found, "SeriesInstanceUID")),
        patient=_joined(text_of(found, "PatientName"), text_of(found, "PatientID")),
        study_told=_joined(date, text_of(found, "StudyDescription")),
        description=text_of(found, "SeriesDescription"),
        modality=text_of(found, "Modality"),
        number=whole_of(found, "SeriesNumber") or 0,
        files=whole_of(found, "NumberOfSeriesRelatedInstances"),
    )


def _measured(client: DICOMwebClient, one: RemoteSeries) -> RemoteSeries:
    """Returns a series with the size that its first file states."""
    files = list_of(client.search_for_instances(one.study, one.uid, limit=1, fields=OF_FILES))
    if not files:
        return one
    columns, rows = whole_of(files[0], "Columns"), whole_of(files[0], "Rows")
    return replace(
        one,
        picture=(columns, rows) if columns and rows else None,
        frames=whole_of(files[0], "NumberOfFrames") or 1,
        file_bytes=bytes_of(files[0]),
    )


# --- bringing one -----------------------------------------------------------------------


def fetch_series(
    address: WebAddress, one: RemoteSeries, folder: Path, *, progress: Progress = silent
) -> int:
    """Downloads the files of a series into a folder, several at a time.

    Returns:
        The number of files.

    Raises:
        DicomWebError: The server does not send them, or more than is allowed.
        OSError: The files cannot be written.
    """
    with asking(address, MOST_BYTES) as budget:
        progress("asking for the list of files", None)
        with client_of(address, budget) as client:
            files = _files_of(client, one)
        expected = _room_for(files, folder)
        said = f"fetching {len(files)} files" + (
            "" if expected is None else f", {expected / 2**20:.0f} MiB before compression"
        )
        progress(said, 0.0)
        work = [(folder / f"{number:05}.dcm", uid) for number, uid in enumerate(files)]

        def bring(client: DICOMwebClient, wanted: tuple[Path, str]) -> None:
            _bring(client, one, uid=wanted[1], path=wanted[0])

        with pool_of(bring, work, (address, budget)) as futures:
            waiting = set(futures)
            while waiting:
                done, waiting = wait(waiting, PATIENCE, FIRST_COMPLETED)
                for future in done:
                    future.result()
                progress(said, 1.0 - len(waiting) / len(files))
    return len(files)


def fetch_middle(address: WebAddress, one: RemoteSeries, folder: Path) -> Path:
    """Downloads the file in the middle of a series into a folder; returns its path.

    Raises:
        DicomWebError: The server does not send it.
    """
    with asking(address, MOST_BYTES) as budget, client_of(address, budget) as client:
        middle = (one.files or 1) // 2
        listed = list_of(client.search_for_instances(one.study, one.uid, limit=1, offset=middle))
        path = folder / one.uid
        _bring(client, one, uid=uid_of(text_of(listed[0], "SOPInstanceUID")), path=path)
        return path


def _files_of(client: DICOMwebClient, one: RemoteSeries) -> dict[str, int | None]:
    """Lists the files of a series by their UIDs, with the bytes of their pixels."""
    found: dict[str, int | None] = {}
    while len(found) <= MOST_FILES:
        # a server may give fewer than asked for, or take no heed of where to begin
        listed = list_of(
            client.search_for_instances(
                one.study, one.uid, limit=PAGE, offset=len(found), fields=OF_FILES
            )
        )
        new = {uid_of(text_of(each, "SOPInstanceUID")): bytes_of(each) for each in listed}
        if not new.keys() - found.keys():
            break
        found |= new
    if not found:
        raise DicomWebError("the server lists no file of this series; allowed: one with files")
    if len(found) > MOST_FILES:
        raise DicomWebError(f"the series has more than {MOST_FILES} files; allowed: fewer")
    return found


def _room_for(files: Mapping[str, int | None], folder: Path) -> int | None:
    """Returns the expected bytes of pixels, where the server states them and the disk has room."""
    sizes = [size for size in files.values() if size is not None]
    if len(sizes) < len(files):
        return None
    expected, room = sum(sizes), shutil.disk_usage(folder).free - SPARE
    if expected > min(MOST_BYTES, room):
        raise DicomWebError(
            f"the series has {expected / 2**20:.0f} MiB; allowed: at most "
            f"{max(0, min(MOST_BYTES, room)) / 2**20:.0f} MiB, and room on the disk"
        )
    return expected


def _bring(client: DICOMwebClient, one: RemoteSeries, *, uid: str, path: Path) -> None:
    # as it is stored, in whatever transfer syntax
    dataset = client.retrieve_instance(
        one.study, one.uid, uid, media_types=(("application/dicom", "*"),)
    )
    if str(dataset.get("SeriesInstanceUID")) != one.uid:
        raise DicomWebError("the server sends a file of another series; allowed: what is asked for")
    dataset.save_as(path, enforce_file_format=True)


def _joined(*texts: str) -> str:
    return " ".join(text for text in texts if text)
