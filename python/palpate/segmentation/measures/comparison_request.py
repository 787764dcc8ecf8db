"""A comparison with a reference as a command or a recipe asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from palpate.base.progress import Progress, silent
from palpate.base.request import Request, words
from palpate.base.segment_file_options import AnotherPatient, Resample

if TYPE_CHECKING:
    from palpate.labels.grid import Labels
    from palpate.segmentation.measures.comparison import Comparison
    from palpate.volumes.scene import Scene
    from palpate.volumes.volume import Volume

__all__ = ["CompareRequest"]


class CompareRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate compare``."""

    reference: Annotated[
        Path,
        words(
            "Segments to compare with: label map, .seg.nrrd, DICOM SEG, RTSTRUCT, or a folder of "
            "masks.",
            reads=True,
        ),
    ]
    segment: Annotated[
        str | None,
        words("Name or number of the segment to compare; by default all, by their names."),
    ] = None
    against: Annotated[str | None, words("Name or number of its counterpart in the reference.")] = (
        None
    )
    resample: Resample = False
    another_patient: AnotherPatient = False
    out: Annotated[
        Path | None,
        words("Table to write (.csv, .json).", short="o", writes=(".csv", ".json")),
    ] = None

    def check_on(self, volume: Volume, *, progress: Progress = silent) -> None:
        """Refuses what cannot be done with a scan, before any segment is made.

        Raises:
            PalpateError: The reference cannot be read, or does not fit the scan.
        """
        # what another step writes is not there yet
        if self.reference.exists():
            self._read(volume, progress)

    def compare(self, scene: Scene, *, progress: Progress = silent) -> Comparison:
        """Compares the segments of a scene, and writes the table where one is asked for.

        Raises:
            PalpateError: The reference cannot be read, or does not fit the scan or the segments.
            OSError: The disk refuses the table.
        """
        from palpate.segmentation.measures.comparison import compare
        from palpate.segmentation.measures.comparison_table import comparison_text

        reference = self._read(scene.volume, progress)
        progress("comparing with the reference", None)
        found = compare(scene, reference, segment=self.segment, against=self.against)
        if self.out is not None:
            from palpate.base.whole_file import whole_file

            text = comparison_text(found, self.out.suffix.lower())
            with whole_file(self.out) as unfinished:
                unfinished.write_text(text, "utf-8")
        return found

    def _read(self, volume: Volume, progress: Progress) -> Labels:
        from palpate.labels.labels import read_any_labels

        return read_any_labels(
            self.reference,
            volume,
            resample=self.resample,
            another_patient=self.another_patient,
            progress=progress,
        )
