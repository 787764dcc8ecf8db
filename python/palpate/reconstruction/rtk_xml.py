"""XML of RTK's geometry files: what each projection states, as text.

Values that all projections share stand once, before them. A document type may be named, as RTK
does; entities are refused, so nothing is expanded or fetched.
"""

from __future__ import annotations

from pathlib import Path
from typing import NoReturn
from xml.parsers import expat

from palpate.base.errors import VolumeFormatError
from palpate.base.nearest import perhaps

__all__ = ["MATRIX", "PARAMETERS", "stated_in"]

ROOT, PROJECTION, MATRIX = "RTKThreeDCircularGeometry", "Projection", "Matrix"
PARAMETERS = (
    "GantryAngle",
    "OutOfPlaneAngle",
    "InPlaneAngle",
    "SourceToIsocenterDistance",
    "SourceToDetectorDistance",
    "SourceOffsetX",
    "SourceOffsetY",
    "ProjectionOffsetX",
    "ProjectionOffsetY",
    "RadiusCylindricalDetector",
    "CollimationUInf",
    "CollimationUSup",
    "CollimationVInf",
    "CollimationVSup",
)
OLDER = {"Angle": "GantryAngle"}
"""Names that RTK still reads."""
VERSIONS = ("2", "3")
"""Versions that RTK itself still reads."""
MOST_BYTES = 1 << 25
"""Bytes of a file: more than 50 000 projections."""
ALLOWED = f"an XML file of RTK ({ROOT}, version {' or '.join(VERSIONS)})"


def stated_in(path: Path) -> list[dict[str, str]]:
    """Returns what a geometry file states of each projection, by name.

    Raises:
        FileNotFoundError: ``path`` does not exist.
        VolumeFormatError: It is no geometry file.
    """
    if not path.is_file():
        raise FileNotFoundError(f"{path} does not exist; allowed: {ALLOWED}")
    size = path.stat().st_size
    if size > MOST_BYTES:
        raise VolumeFormatError(f"{path} has {size} bytes; allowed: at most {MOST_BYTES}")
    found = _Reading(path)
    parser = expat.ParserCreate()
    parser.StartElementHandler = found.begin
    parser.EndElementHandler = found.end
    parser.CharacterDataHandler = found.take
    parser.EntityDeclHandler = found.refuse_entity
    parser.buffer_text = True
    try:
        with path.open("rb") as file:
            parser.ParseFile(file)
    except expat.ExpatError as error:
        raise VolumeFormatError(f"{path} is no XML ({error}); allowed: {ALLOWED}") from None
    if not found.projections:
        raise VolumeFormatError(f"{path} describes no projections; allowed: one or more")
    return found.projections


class _Reading:
    """What was read so far."""

    def __init__(self, path: Path) -> None:
        self.projections: list[dict[str, str]] = []
        self._path = path
        self._open: list[str] = []
        self._shared: dict[str, str] = {}
        self._own: dict[str, str] | None = None
        """Of the projection that is being read."""
        self._text = ""

    def begin(self, name: str, attributes: dict[str, str]) -> None:
        """Takes the start of an element."""
        depth = len(self._open)
        within = self._own is not None
        if depth == 0:
            self._begin_file(name, attributes.get("version"))
        elif depth == 1 and name == PROJECTION:
            self._own = {}
        elif depth > 1 + within or not self._is_known(name, within=within):
            known = [*PARAMETERS, MATRIX] if within else [*PARAMETERS, PROJECTION]
            self._refuse(f"{name!r} is not known here{perhaps(name, known)}", ", ".join(known))
        self._open.append(name)
        self._text = ""

    def _begin_file(self, name: str, version: str | None) -> None:
        if name != ROOT:
            raise VolumeFormatError(f"{self._path} holds {name!r}; allowed: {ALLOWED}")
        if version not in VERSIONS:
            told = "states no version" if version is None else f"is of version {version!r}"
            raise VolumeFormatError(
                f"{self._path} {told}; allowed: {' or '.join(VERSIONS)}, as RTK reads (write the "
                "geometry again with a newer RTK)"
            )

    @staticmethod
    def _is_known(name: str, *, within: bool) -> bool:
        return name in PARAMETERS or name in OLDER or (within and name == MATRIX)

    def take(self, text: str) -> None:
        """Takes text within an element."""
        self._text += text

    def end(self, name: str) -> None:
        """Takes the end of an element."""
        self._open.pop()
        if not self._open:
            return
        if name == PROJECTION:
            self.projections.append({**self._shared, **(self._own or {})})
            self._own = None
            return
        name = OLDER.get(name, name)
        stated = self._shared if self._own is None else self._own
        if name in stated:
            self._refuse(f"{name} is stated twice", "once")
        stated[name] = self._text.strip()

    def refuse_entity(self, name: str, *_: object) -> None:
        """Refuses a declaration that stands for other text."""
        raise VolumeFormatError(
            f"{self._path} declares the entity {name!r}; allowed: a file without entities"
        )

    def _refuse(self, told: str, allowed: str) -> NoReturn:
        number = len(self.projections) + 1
        where = self._path if self._own is None else f"{self._path}, projection {number}"
        raise VolumeFormatError(f"{where}: {told}; allowed: {allowed}")
