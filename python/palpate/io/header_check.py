"""Headers of MetaImage, NRRD and TIFF, held against their files before a library sees them."""

from __future__ import annotations

from pathlib import Path

from palpate.io.metaimage_header import check_metaimage
from palpate.io.nrrd_header import check_nrrd
from palpate.io.tiff_header import check_tiff

__all__ = ["check_header"]

CHECKS = (
    ((".mha", ".mhd"), check_metaimage),
    ((".nrrd", ".nhdr"), check_nrrd),
    ((".tif", ".tiff"), check_tiff),
)


def check_header(path: Path) -> None:
    """Refuses a header that promises what its file does not hold, or names other files.

    Formats are told by names, as the libraries do.

    Raises:
        VolumeFormatError: It does.
    """
    name = path.name.lower()
    if not path.is_file():
        return
    for endings, check in CHECKS:
        if name.endswith(endings):
            check(path)
