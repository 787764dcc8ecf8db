"""``palpate bench open``: time from the command to the first picture of a DICOM series.

The series is written for the benchmark: 275 slices of 512 x 512, uncompressed as scanners write
them, interpolated between the slices of a chest. A browser waits; then the command starts, reads
and serves, and the page draws in software. Reading alone is compared with SimpleITK's reader of
series, alternately, in this process; the files are in the system's cache.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from palpate.base.progress import Progress, silent
from palpate.base.simpleitk import simpleitk
from palpate.bench.goals.opening import OPEN_CASE, OPEN_ROWS
from palpate.bench.haptics_data import LIDC, data_file
from palpate.bench.page import chromium, opened, served
from palpate.bench.pictures.first_picture import used_until_picture
from palpate.bench.report import Row, rows_in
from palpate.io.reading import read
from palpate.volumes.volume import Volume

if TYPE_CHECKING:
    from pydicom.dataset import FileDataset

__all__ = ["measure", "rows_of", "write_series"]

SLICES = 275
RUNS = 3
"""Number of runs, of which the median counts."""
SIZE = {"width": 1280, "height": 800}
"""Size of the browser's window [pixels]."""


def measure(*, slices: int = SLICES, runs: int = RUNS, progress: Progress = silent) -> list[Row]:
    """Measures the opening of a series made from the LIDC chest.

    Raises:
        OptionError: There is no browser.
        MissingDataError: The chest is missing.
    """
    chromium()
    times: dict[str, list[float]] = defaultdict(list)
    with TemporaryDirectory() as made:
        folder = Path(made)
        progress(f"writing {slices} slices", None)
        write_series(read(data_file(LIDC)), folder, slices=slices)
        for run in range(runs):
            progress("opening and reading", run / runs)
            for name, taken in _pictures(folder).items():
                times[name].append(taken)
            began = time.perf_counter()
            volume = read(folder)
            times["read"].append(time.perf_counter() - began)
            times["itk"].append(_itk_reads(folder, volume))
    return rows_of(times, volume.memory_bytes)


def rows_of(times: Mapping[str, list[float]], memory: int) -> list[Row]:
    """Returns the rows of times [s] and of the memory of the values [bytes]."""
    report = {name: median(taken) for name, taken in times.items()}
    report["ratio"] = report["itk"] / report["read"]
    report["bytes"] = float(memory)
    return rows_in(OPEN_ROWS, {OPEN_CASE: report})


def _pictures(folder: Path) -> dict[str, float]:
    """Returns the times until the page is served, has a picture, and has that of all slices [s].

    The processor time of the browser until its picture is among them.
    """
    with opened(None, **SIZE, drawer=None) as page:
        began = time.perf_counter()
        with served(folder) as url:
            served_after = time.perf_counter() - began
            used = used_until_picture(page, url)
            shown_after = time.perf_counter() - began
            page.wait("window.palpate?.ready === true")
            whole_after = time.perf_counter() - began
    return {"served": served_after, "picture": shown_after, "whole": whole_after, **used}


def _itk_reads(folder: Path, expected: Volume) -> float:
    """Returns the time of SimpleITK for the same values [s].

    Raises:
        RuntimeError: The values differ.
    """
    sitk = simpleitk()
    began = time.perf_counter()
    reader = sitk.ImageSeriesReader()
    reader.SetFileNames(reader.GetGDCMSeriesFileNames(str(folder)))
    values = sitk.GetArrayFromImage(reader.Execute())
    taken = time.perf_counter() - began
    if not np.array_equal(values, expected.array):
        raise RuntimeError("SimpleITK reads other values of the series")
    return taken


# --- the series ---------------------------------------------------------------------------


def write_series(volume: Volume, folder: Path, *, slices: int) -> None:
    """Writes a scan as a number of uncompressed DICOM slices over its length."""
    from pydicom.uid import generate_uid

    series, frame = generate_uid(), generate_uid()
    ends = len(volume.array) - 1
    step = volume.spacing[2] * ends / (slices - 1)
    for number in range(slices):
        place = ends * number / (slices - 1)
        lower = min(int(place), ends - 1)
        share = place - lower
        pixels = volume.array[lower] * (1.0 - share) + volume.array[lower + 1] * share
        position = np.array(volume.origin) + volume.direction[:, 2] * step * number
        dataset = _slice(np.rint(pixels), volume, position)
        dataset.SeriesInstanceUID, dataset.FrameOfReferenceUID = series, frame
        dataset.InstanceNumber = number + 1
        dataset.save_as(folder / f"{number:04}.dcm", enforce_file_format=True)


def _slice(
    pixels: NDArray[np.float64], volume: Volume, position: NDArray[np.float64]
) -> FileDataset:
    from pydicom.dataset import FileDataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid

    meta = FileMetaDataset()
    meta.MediaStorageSOPClassUID = CTImageStorage
    meta.MediaStorageSOPInstanceUID = generate_uid()
    meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset = FileDataset("", {}, file_meta=meta, preamble=b"\0" * 128)
    dataset.SOPClassUID, dataset.SOPInstanceUID = CTImageStorage, meta.MediaStorageSOPInstanceUID
    dataset.Modality, dataset.PatientID = "CT", "bench"
    dataset.Rows, dataset.Columns = pixels.shape
    dataset.SamplesPerPixel, dataset.PhotometricInterpretation = 1, "MONOCHROME2"
    dataset.BitsAllocated = dataset.BitsStored = 16
    dataset.HighBit, dataset.PixelRepresentation = 15, 1
    dataset.RescaleSlope, dataset.RescaleIntercept = volume.slope, volume.intercept
    dataset.PixelSpacing = [f"{volume.spacing[1]:.7g}", f"{volume.spacing[0]:.7g}"]
    dataset.ImageOrientationPatient = [f"{cosine:.7g}" for cosine in volume.direction.T[:2].ravel()]
    dataset.ImagePositionPatient = [f"{place:.7g}" for place in position]
    dataset.PixelData = pixels.astype("<i2").tobytes()
    return dataset
