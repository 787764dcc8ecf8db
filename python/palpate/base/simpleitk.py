"""SimpleITK, imported late and without the warnings that ITK prints by itself."""

from __future__ import annotations

import re
from collections.abc import Sequence
from importlib import import_module
from types import ModuleType
from typing import Any, Protocol

from numpy.typing import NDArray

__all__ = ["Grid", "Image", "Reader", "Transform", "image_on", "reason_of", "simpleitk"]


class Grid(Protocol):
    """Geometry of a scan in the patient, LPS [mm]; see ``palpate.volumes.volume.Volume``."""

    @property
    def spacing(self) -> tuple[float, float, float]: ...  # noqa: D102
    @property
    def origin(self) -> tuple[float, float, float]: ...  # noqa: D102
    @property
    def direction(self) -> NDArray[Any]: ...  # noqa: D102


class Image(Protocol):
    """The part of ``SimpleITK.Image`` that is used; numbers are in the order x, y, z."""

    def GetSpacing(self) -> tuple[float, float, float]: ...  # noqa: N802, D102
    def GetOrigin(self) -> tuple[float, float, float]: ...  # noqa: N802, D102
    def GetDirection(self) -> tuple[float, ...]: ...  # noqa: N802, D102


class Transform(Protocol):
    """The part of ``SimpleITK.Transform`` that is used; points are patient, LPS [mm]."""

    def GetDimension(self) -> int: ...  # noqa: N802, D102
    def IsLinear(self) -> bool: ...  # noqa: N802, D102
    def TransformPoint(self, point: Sequence[float]) -> tuple[float, ...]: ...  # noqa: N802, D102


class Reader(Protocol):
    """The part of ``SimpleITK.ImageFileReader`` that is used."""

    def GetSize(self) -> tuple[int, ...]: ...  # noqa: N802, D102
    def GetSpacing(self) -> tuple[float, ...]: ...  # noqa: N802, D102
    def GetNumberOfComponents(self) -> int: ...  # noqa: N802, D102
    def GetPixelIDValue(self) -> int: ...  # noqa: N802, D102
    def GetMetaDataKeys(self) -> Sequence[str]: ...  # noqa: N802, D102
    def GetMetaData(self, key: str) -> str: ...  # noqa: N802, D102
    def SetExtractIndex(self, index: Sequence[int]) -> None: ...  # noqa: N802, D102
    def SetExtractSize(self, size: Sequence[int]) -> None: ...  # noqa: N802, D102
    def Execute(self) -> Image: ...  # noqa: N802, D102


def simpleitk() -> ModuleType:
    """Returns the module SimpleITK; its warnings are part of a volume's ``warnings``."""
    module = import_module("SimpleITK")
    module.ProcessObject.SetGlobalWarningDisplay(False)  # noqa: FBT003  # its only form
    return module


def image_on(grid: Grid, array: NDArray[Any]) -> Any:  # noqa: ANN401  # SimpleITK has no types
    """Returns an array [z, y, x] on a grid as a ``SimpleITK.Image``."""
    image = simpleitk().GetImageFromArray(array)
    image.SetSpacing(grid.spacing)
    image.SetOrigin(grid.origin)
    image.SetDirection(grid.direction.ravel().tolist())
    return image


def reason_of(error: RuntimeError) -> str:
    """Returns the last line of a message of ITK, without the addresses of its objects."""
    last = str(error).strip().splitlines()[-1].strip()
    return re.sub(r"ITK ERROR: |sitk::ERROR: |\(0x[0-9a-f]+\)", "", last).rstrip(".")
