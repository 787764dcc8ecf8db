"""How a scan is read, as commands and recipes ask for it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from palpate.base.request import Request, words

if TYPE_CHECKING:
    from palpate.base.progress import Progress
    from palpate.volumes.volume import Volume

__all__ = ["ReadRequest"]


class ReadRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate.io.read``."""

    series: Annotated[
        str | int | None,
        words("DICOM series to read: UID, description, or number in the list."),
    ] = None
    frame: Annotated[
        int | None,
        words("Volume of an image file that holds several, such as times; 1 is the first."),
    ] = None
    orientation: Annotated[
        str | None,
        words("Directions in which x, y and z increase, such as LPS or RAS; overrides the file."),
    ] = None
    unit: Annotated[
        str | None,
        words("Unit of the values: HU for Hounsfield units, none if they are in no known unit."),
    ] = None
    fill: Annotated[float | None, words("Value that replaces NaN and infinity.")] = None
    strict: Annotated[bool, words("Refuse scans with NaN or infinity, without `fill=VALUE`.")] = (
        False
    )
    raw: Annotated[
        str | None,
        words(
            "Layout of raw voxels, such as 256x256x113,int16,big.",
            form="SIZE,TYPE[,ORDER[,SKIP]]",
        ),
    ] = None
    voxel_size: Annotated[
        tuple[float, float, float] | None,
        words("Voxel size of raw voxels and of PNG or TIFF slices, in mm.", form="X,Y,Z"),
    ] = None
    max_voxels: Annotated[int, words("Refuse scans with more voxels than this.")] = 1024**3

    def read(self, path: Path | Sequence[Path], progress: Progress) -> Volume:
        """Reads the scan at this place, or at these.

        Raises:
            PalpateError: It cannot be read, or there are several.
        """
        from palpate.io.reading import read

        return read(
            path,
            series=None if self.series is None else str(self.series),
            frame=self.frame,
            orientation=self.orientation,
            unit=self.unit,
            fill=self.fill,
            strict=self.strict,
            raw=self.raw,
            voxel_size=self.voxel_size,
            max_voxels=self.max_voxels,
            progress=progress,
        )
