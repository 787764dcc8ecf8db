"""An export as a command or a recipe asks for it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Annotated

from palpate.base.errors import OptionError
from palpate.base.request import Request, words
from palpate.export.kinds import Kind, check_export, kind_of
from palpate.labels.name_table import table_beside

__all__ = ["ExportRequest"]


class ExportRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate export`` on what is written."""

    out: Annotated[
        Path,
        words(
            "Output: .seg.nrrd, .nii.gz, .nrrd, .mha or .dcm file, or a new folder for DICOM.",
            form="OUT",
            short="o",
            # which ending fits depends on the kind
            writes=("",),
        ),
    ]
    kind: Annotated[
        Kind | None,
        words(
            "Format: seg-nrrd, labels, scan, dicom-seg, dicom-labelmap, rtstruct or dicom (all "
            "DICOM objects); by default it follows from the name of the output.",
            name="as",
        ),
    ] = None
    only: Annotated[
        list[str] | None, words("Export only the segment with this name; repeatable.")
    ] = None
    keep_identity: Annotated[
        bool,
        words("Keep the patient's identity in DICOM and refer to the original series."),
    ] = False
    pixels_checked: Annotated[
        bool,
        words(
            "Say that you have looked for text in the pixels of all images. Asked for where they "
            "are declared to have some, or are of a kind that often has, such as ultrasound."
        ),
    ] = False

    def kind_for(self, *, has_segments: bool) -> Kind:
        """Returns what is to be written: what was asked for, or what its name says.

        Raises:
            OptionError: The name says nothing known.
        """
        return kind_of(self.out, has_segments=has_segments) if self.kind is None else self.kind

    def table(self, planned: Iterable[Path]) -> Path | None:
        """Returns the table of names that comes beside the output; None where there is none.

        Args:
            planned: Files that will be there by then.
        """
        if self.kind_for(has_segments=True) != "labels":
            return None
        return table_beside(self.out, planned=planned)

    def check(self) -> None:
        """Refuses what could not be written, whatever the scan is.

        Raises:
            OptionError: The name does not fit, its folder does not exist, or a DICOM object would
                refer to nothing; or no segment is named where some are to be.
        """
        if self.only == []:
            raise OptionError(
                "only given without a name; allowed: names of segments, or leave it out"
            )
        kind = self.kind_for(has_segments=True)
        check_export(self.out, kind, keep_identity=self.keep_identity)
