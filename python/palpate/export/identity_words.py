"""Words, numbers and days by which a scan's files name somebody, found in texts that are kept.

Names are taken apart: each part of a double name counts, with and without accents. Long ones are
found within other words too, short ones where they stand alone; in scripts that part no words any
of them. Days are found in whatever writing, also those that no header tells.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydicom.dataset import Dataset

__all__ = ["ANONYMIZED", "IdentityWords"]

ANONYMIZED = "ANONYMIZED"
NUMBERED = (
    "PatientID", "OtherPatientIDs", "AccessionNumber", "StudyID", "StationName",
    "DeviceSerialNumber", "PatientTelephoneNumbers", "IssuerOfPatientID", "MedicalRecordLocator",
    "AdmissionID", "PatientAddress",
)  # fmt: skip
"""By what the source numbers patient, study and machine."""
PLACES = ("InstitutionName", "InstitutionAddress", "InstitutionalDepartmentName")
DAYS = (
    "PatientBirthDate", "StudyDate", "SeriesDate", "AcquisitionDate", "ContentDate",
)  # fmt: skip
UMLAUTS = (
    ("ä", "ae"), ("ö", "oe"), ("ü", "ue"), ("ß", "ss"), ("Ä", "Ae"), ("Ö", "Oe"), ("Ü", "Ue"),
)  # fmt: skip
LONG = 4
"""Letters of a word that is looked for within others too."""
TITLES = """
anonymized anonymous anon unknown none van von zu de del der den des la le el al di da do dos du bin
ibn mr mrs ms dr prof med md phd jr sr ii iii hospital clinic clinics university medical center
centre institute department radiology klinik klinikum universität krankenhaus hôpital clinique
centro ospedale street road avenue
"""
"""Parts of names, titles and addresses that name nobody."""
MONTHS = (
    "jan|feb|mar|apr|may|jun|jul|aug|sep|oct|nov|dec|mär|mrz|mai|okt|dez|fév|avr|juin|juil|aoû|déc|"
    "ene|abr|ago|dic|gen|mag|giu|lug|set|ott|maa|mei|out|fev"
)
"""How months begin in English, German, French, Spanish, Italian, Dutch and Portuguese."""
DAY = re.compile(
    # 2004-10-08, 8.10.04, 10/08/2004
    r"(?<![\w.])\d{1,4}(?P<mark>[-./])\d{1,2}(?P=mark)(?:\d{4}|\d{1,2})(?![\d.])"
    r"|(?<![\w.])(?:\d{1,2} \d{1,2} (?:19|20)\d\d|(?:19|20)\d\d \d{1,2} \d{1,2})(?![\d.])"
    # 20041008
    r"|(?<!\d)(?:19|20)\d\d(?:0[1-9]|1[0-2])(?:0[1-9]|[12]\d|3[01])(?!\d)"
    r"|\d{2,4}\s*[年년]\s*\d{1,2}\s*[月월](?:\s*\d{1,2}\s*[日일])?"
    # 8 October 2004, 08-Oct-04, 8. Okt.; October 8th, 2004; October 2004
    rf"|(?<![^\W_])(?:\d{{1,2}}(?:st|nd|rd|th)?\.?[-\s]*(?:of |de )?(?:{MONTHS})[^\W\d_]*"
    rf"\.?(?:,?[-\s]*(?:de )?\d{{2,4}})?|(?:{MONTHS})[^\W\d_]*\.?[-\s]*\d{{1,2}}"
    rf"(?:st|nd|rd|th)?(?:,?\s*\d{{4}})?|(?:{MONTHS})[^\W\d_]*\.?[-\s]*\d{{4}})(?![^\W_])",
    re.IGNORECASE,
)
"""A day, or a month of a year."""


class IdentityWords:
    """What names patient, people, places and days of some files."""

    def __init__(self, sources: Iterable[Dataset]) -> None:
        """Learns the words of the sources' headers."""
        words = {word for each in sources for word in _words(each)}
        words |= {variant for word in words for variant in _variants(word)}
        # longer ones first: they may hold shorter ones
        ordered = sorted(words, key=lambda word: (-len(word), word))
        self._any = _pattern(ordered)
        self._long = _pattern([word for word in ordered if len(word) >= LONG])

    def cleaned(self, text: str) -> str:
        """Returns a text without words that name somebody, and without days."""
        composed = unicodedata.normalize("NFC", text)
        kept = DAY.sub(ANONYMIZED, self._any.sub(ANONYMIZED, composed))
        return text if kept == composed else kept

    def names_in(self, text: str) -> bool:
        """Says whether a text names somebody."""
        return self._any.search(unicodedata.normalize("NFC", text)) is not None

    def names_in_bytes(self, content: bytes) -> bool:
        """Says whether bytes hold a word that is too long to be there by chance."""
        encodings = ("latin-1", "utf-8", "utf-16-le", "utf-16-be")
        texts = (content.decode(encoding, "replace") for encoding in encodings)
        return any(self._long.search(text) for text in texts)


def _words(dataset: Dataset) -> Iterator[str]:
    """Yields the words, numbers and days by which a header names somebody."""
    for element in dataset.iterall():
        if element.VR == "SQ" or element.value is None:
            continue
        for text in map(str, element.value if element.VM > 1 else [element.value]):
            whole = unicodedata.normalize("NFC", text.strip())
            if element.VR == "PN":
                groups = [part for part in re.split(r"[\^=\s,]+", whole) if part]
                yield from filter(_names, groups)
                yield from filter(_names, re.split(r"[\^=\s,.\-'’_()]+", whole))
            elif element.keyword in NUMBERED:
                yield from filter(_is_long, [whole])
                parts = re.findall(rf"[^\W_]{{{LONG},}}", whole)
                yield from (part for part in parts if re.search(r"\d", part))
            elif element.keyword in PLACES:
                yield from filter(_is_long, [whole])
                parts = re.findall(r"[^\W\d_]+", whole)
                yield from (part for part in parts if _is_long(part) and _names(part))
            elif element.keyword in DAYS:
                yield from filter(_is_long, [whole])


def _names(part: str) -> bool:
    """Says whether a part of a name names somebody: no initial, and no title."""
    return part.lower() not in TITLES.split() and (len(part) > 1 or _parts_no_words(part))


def _is_long(word: str) -> bool:
    return len(word) >= LONG and word.lower() not in TITLES.split()


def _variants(word: str) -> Iterator[str]:
    """Yields other spellings of a word: without accents, and with two letters for an umlaut."""
    bare = "".join(
        letter
        for letter in unicodedata.normalize("NFKD", word)
        if not unicodedata.combining(letter)
    )
    yield unicodedata.normalize("NFC", bare.translate(str.maketrans("łøđŁØĐ", "lodLOD")))
    for umlaut, letters in UMLAUTS:
        word = word.replace(umlaut, letters)
    yield word


def _parts_no_words(text: str) -> bool:
    """Says whether a script has no spaces between words: ideographs, kana, Thai."""
    return any("\u0e00" <= letter <= "\u0eff" or letter >= "\u2e80" for letter in text)


def _pattern(words: Iterable[str]) -> re.Pattern[str]:
    """Returns what finds words; short ones and numbers only where they stand alone."""
    found = [_one(word) for word in words]
    return re.compile("|".join(found) if found else r"(?!)", re.IGNORECASE)


def _one(word: str) -> str:
    escaped = re.escape(word)
    if word.isdecimal():
        return rf"(?<![\d.]){escaped}(?![\d.])"
    if len(word) >= LONG or _parts_no_words(word):
        return escaped
    return rf"(?<![^\W_]){escaped}(?![^\W_])"
