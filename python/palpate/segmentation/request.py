"""A segment as a command or a recipe asks for it: one way to make it, then changes of its shape.

What is asked for is checked before anything is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.typed_numbers import parse_point, parse_threshold
from palpate.segmentation.operations import (
    Growing,
    ShapeKind,
    changed_shape,
    grown,
    grown_from_seeds,
    otsu,
    smoothed_together,
)
from palpate.segmentation.threshold_presets import PRESETS, preset_range
from palpate.volumes.segment import Segment
from palpate.volumes.volume import Volume

__all__ = ["Made", "SegmentRequest"]

Made = tuple[list[Segment], tuple[str, ...]]
"""Segments, and what a person should know of them."""

SIGNED = ("grow", "shrink", "hollow-inside", "hollow-outside")
"""Changes whose side is told by the sign."""


class SegmentRequest(
    msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, rename="kebab"
):
    """The options of ``palpate segment``, under their names there."""

    threshold: str | float | None = None
    otsu: int | None = None
    grow: list[str] = []
    seeds: Path | None = None
    auto: bool = False
    fast: bool = False
    spread: float | None = None
    passage: float | None = None
    most: float | None = None
    keep_largest: bool = False
    drop_below: float | None = None
    fill: bool = False
    between_slices: bool = False
    smooth: float | None = None
    median: float | None = None
    joint: float | None = None
    opening: float | None = None
    closing: float | None = None
    margin: float | None = None
    hollow: float | None = None
    unite: Path | None = None
    subtract: Path | None = None
    intersect: Path | None = None
    name: str | None = None

    def check(self) -> None:
        """Refuses what cannot be done whatever the scan is.

        Raises:
            OptionError: No way to make a segment is given or several are, or an option is wrong.
        """
        given = (self.threshold, self.otsu, self.grow or None, self.seeds, self.auto or None)
        ways = sum(way is not None for way in given)
        if ways != 1:
            raise OptionError(
                f"{ways} ways to make a segment given; allowed: one of --threshold, --otsu, "
                "--grow, --seeds, --auto"
            )
        if self.fast and not self.auto:
            raise OptionError("--fast given; allowed: with --auto only")
        if not self.grow and not self.spread is self.passage is self.most is None:
            raise OptionError("options of growing given; allowed: with --grow only")
        if self.seeds is not None and not self.seeds.exists():
            raise FileNotFoundError(f"{self.seeds} does not exist; allowed: a file with segments")
        self._growing.check()
        for point in self.grow:
            parse_point(point)
        for _, file in self._others():
            if not file.exists():
                raise FileNotFoundError(f"{file} does not exist; allowed: a file with segments")
        self._check_threshold()

    def make(self, volume: Volume, *, progress: Progress = silent) -> Made:
        """Makes what is asked for out of a scan.

        Raises:
            OptionError: It cannot be, or nothing is left of it.
        """
        made, warnings = self._found(volume, progress)
        for kind, amount in self._changes():
            progress(kind.replace("-", " "), None)
            if kind == "joint":
                made = smoothed_together(made, deviation=amount)
            else:
                made = [changed_shape(one, kind, amount=amount) for one in made]
            if not any(one.voxel_count for one in made):
                step = kind.replace("-", " ")
                allowed = "thicker walls" if "hollow" in kind else "smaller changes"
                raise OptionError(
                    f"nothing is left of the segment after {step} {amount:g}; allowed: {allowed}"
                )
        for kind, file in self._others():
            progress(f"{kind} with {file.name}", None)
            other, told = self._all_of(file, volume, progress)
            warnings = (*warnings, *told)
            made = [changed_shape(one, kind, other=other) for one in made]
        if self.name is not None:
            for one in made:
                one.name = self.name if len(made) == 1 else f"{self.name}, {one.name}"
        made = [one for one in made if one.voxel_count > 0]
        if not made:
            raise OptionError(
                "nothing is left of the segment; allowed: values or masks that leave some"
            )
        of_shapes = dict.fromkeys(sentence for one in made for sentence in one.warnings)
        return made, (*warnings, *of_shapes)

    @property
    def _growing(self) -> Growing:
        usual = Growing()
        return Growing(
            spread=usual.spread if self.spread is None else self.spread,
            passage=usual.passage if self.passage is None else self.passage,
            most_ml=usual.most_ml if self.most is None else self.most,
        )

    def _found(self, volume: Volume, progress: Progress) -> Made:
        from palpate.labels.labels import read_labels
        from palpate.segmentation.automatic import found_automatically

        if self.auto:
            found = found_automatically(volume, fast=self.fast, progress=progress)
            return [each.segment for each in found.labels], found.warnings
        if self.seeds is not None:
            read = read_labels(self.seeds, volume, progress=progress)
            seeds = [each.segment for each in read.labels]
            return grown_from_seeds(volume, seeds, progress=progress), read.warnings
        if self.otsu is not None:
            return otsu(volume, classes=self.otsu), ()
        bounds = self._bounds(volume)
        if bounds is not None:
            return [volume.threshold(*bounds, name="threshold")], ()
        points = [parse_point(point) for point in self.grow]
        return [grown(volume, points, growing=self._growing, progress=progress)], ()

    def _check_threshold(self) -> None:
        given = None if self.threshold is None else str(self.threshold)
        if given is not None and given[:1].isalpha():
            # a word that is no preset is told those that are
            preset_range(given, unit="HU")
        else:
            parse_threshold(given)

    def _bounds(self, volume: Volume) -> tuple[float, float | None] | None:
        if isinstance(self.threshold, str) and self.threshold in PRESETS:
            return preset_range(self.threshold, unit=volume.unit)
        return parse_threshold(None if self.threshold is None else str(self.threshold))

    def _others(self) -> Iterator[tuple[ShapeKind, Path]]:
        """Lists what is done with segments of files."""
        if self.unite is not None:
            yield "unite", self.unite
        if self.subtract is not None:
            yield "subtract", self.subtract
        if self.intersect is not None:
            yield "intersect", self.intersect

    @staticmethod
    def _all_of(file: Path, volume: Volume, progress: Progress) -> tuple[Segment, tuple[str, ...]]:
        """Returns all segments of a file as one."""
        from palpate.labels.labels import read_labels

        read = read_labels(file, volume, progress=progress)
        masks = [each.segment.mask() != 0 for each in read.labels]
        union = np.logical_or.reduce(masks) if masks else np.zeros(volume.shape, bool)
        return volume.segment(union, name=file.name), read.warnings

    def _changes(self) -> Iterator[tuple[ShapeKind, float]]:
        """Lists what is to be done with the shape, in order."""
        if self.keep_largest:
            yield "keep-largest", 1.0
        if self.drop_below is not None:
            yield "drop-small", self.drop_below
        if self.fill:
            yield "fill-holes", 0.0
        if self.between_slices:
            yield "between-slices", 0.0
        lengths: tuple[tuple[ShapeKind, float | None], ...] = (
            ("smooth", self.smooth),
            ("median", self.median),
            ("joint", self.joint),
            ("open", self.opening),
            ("close", self.closing),
            ("shrink" if (self.margin or 0.0) < 0.0 else "grow", self.margin),
            ("hollow-outside" if (self.hollow or 0.0) < 0.0 else "hollow-inside", self.hollow),
        )
        for kind, length in lengths:
            if length is not None:
                yield kind, abs(length) if kind in SIGNED else length
