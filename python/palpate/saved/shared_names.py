"""Names that people gave, as files that are shared may hold them.

Where the headers of the scan's DICOM files are there, words and days that name somebody are taken
out, as in an export. Nothing else tells which words those are: without headers a name is replaced
by a number, unless a person has looked at it.
"""

from __future__ import annotations

from collections.abc import Callable

from palpate.base.progress import Progress, silent
from palpate.volumes.volume import Volume

__all__ = ["SharedNames"]


class SharedNames:
    """Replaces names, and remembers which ones were kept."""

    def __init__(self, cleaned: Callable[[str], str] | None, *, checked: bool = False) -> None:
        """Takes what takes out words that name somebody.

        Args:
            cleaned: Returns a text without such words; None where none are known.
            checked: Whether a person has looked at all names.
        """
        from palpate.export.identity_words import IdentityWords

        self._known = checked or cleaned is not None
        self._cleaned = IdentityWords([]).cleaned if cleaned is None else cleaned
        self.kept: list[str] = []
        self.replaced = 0
        """How many were replaced by numbers."""

    @classmethod
    def of(
        cls,
        volume: Volume,
        *,
        checked: bool = False,
        pixels_checked: bool = False,
        progress: Progress = silent,
    ) -> SharedNames:
        """Learns from the headers of a scan's files which words name somebody.

        Raises:
            UncheckedPixelsError: There may be text in the pixels, and nobody has looked.
            PalpateError: The files cannot be read.
        """
        from pydicom.dataset import Dataset

        from palpate.export.deidentify import Deidentifier, check_shown
        from palpate.export.dicom_source import dicom_source, why_no_dicom

        if why_no_dicom(volume) is not None:
            kind = Dataset()
            kind.Modality = volume.modality
            if not pixels_checked:
                check_shown([kind])
            return cls(None, checked=checked)
        with dicom_source(volume, complete=True, progress=progress) as source:
            words = Deidentifier(source.images, pixels_checked=pixels_checked)
        return cls(words.cleaned, checked=checked)

    def name(self, given: str, otherwise: str) -> str:
        """Returns a name for what is called ``given``; ``otherwise`` stands for an unknown one."""
        if given == otherwise:
            return given
        if not self._known:
            self.replaced += 1
            return otherwise
        kept = self._cleaned(given)
        if kept not in self.kept:
            self.kept.append(kept)
        return kept
