"""A segment as a command or a recipe asks for it: one way to make it, then changes of its shape.

What is asked for is checked before anything is read.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

import msgspec

from palpate.base.errors import OptionError
from palpate.base.progress import Progress, silent
from palpate.base.request import Request, words
from palpate.base.segment_file_options import AnotherPatient, Resample
from palpate.base.typed_numbers import parse_point, parse_threshold
from palpate.segmentation.threshold_presets import PRESETS, preset_range

if TYPE_CHECKING:
    from palpate.labels.labels import Labels
    from palpate.segmentation.growing.region_growing import Growing
    from palpate.segmentation.operations import ShapeKind
    from palpate.segmentation.segment_steps import SegmentSteps, ShapeStep
    from palpate.volumes.segment import Segment
    from palpate.volumes.volume import Volume

__all__ = ["Made", "SegmentRequest"]

Made: TypeAlias = "tuple[list[Segment], tuple[str, ...]]"
"""Segments, and what a person should know of them."""

SIGNED = ("grow", "shrink", "hollow-inside", "hollow-outside")
"""Changes whose side is told by the sign."""


class SegmentRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate segment``."""

    threshold: Annotated[
        str | float | None,
        words(
            "Values from LOW to HIGH, or for CT a tissue: bone, compact bone, spongy "
            "bone, soft tissue, muscle, fat, skin, lung.",
            form="LOW[,HIGH]",
        ),
    ] = None
    otsu: Annotated[
        int | None,
        words("Otsu's thresholds with this number of classes.", form="2..4"),
    ] = None
    grow: Annotated[
        list[str],
        words(
            "Grow a region from a point in LPS, in mm; repeatable.",
            form="X,Y,Z",
        ),
    ] = msgspec.field(default_factory=list)
    seeds: Annotated[
        Path | None,
        words(
            "Grow the segments of a file until they meet (watershed); one of them "
            "marks the background.",
            reads=True,
        ),
    ] = None
    auto: Annotated[bool, words("Use TotalSegmentator, which must be installed.")] = False
    fast: Annotated[bool, words("With `auto=True`: work at 3 mm, which takes minutes.")] = False
    spread: Annotated[
        float | None,
        words(
            "Range of values for `grow=POINT`, in standard deviations around the point; by default "
            "found from edges."
        ),
    ] = None
    passage: Annotated[
        float | None,
        words(
            "For `grow=POINT`: do not grow through passages narrower than this, in mm; by default "
            "found from edges."
        ),
    ] = None
    most: Annotated[
        float | None, words("For `grow=POINT`: maximum volume of the segment in ml.")
    ] = None
    keep_largest: Annotated[bool, words("Keep only the largest connected component.")] = False
    drop_below: Annotated[
        float | None, words("Remove connected components smaller than this, in ml.")
    ] = None
    fill: Annotated[bool, words("Fill holes.")] = False
    between_slices: Annotated[bool, words("Interpolate between painted slices.")] = False
    smooth: Annotated[
        float | None,
        words("Smooth the mask with a Gaussian of this standard deviation in mm."),
    ] = None
    median: Annotated[
        float | None,
        words("Smooth the mask with a median filter of this radius in mm."),
    ] = None
    joint: Annotated[
        float | None,
        words(
            "Smooth all segments jointly with a Gaussian of this standard deviation "
            "in mm; no gaps appear."
        ),
    ] = None
    opening: Annotated[
        float | None,
        words("Morphological opening with a ball of this radius in mm: removes thin bridges."),
    ] = None
    closing: Annotated[
        float | None,
        words("Morphological closing with a ball of this radius in mm: closes narrow gaps."),
    ] = None
    margin: Annotated[
        float | None,
        words("Grow the segment by this margin in mm, or shrink it if negative."),
    ] = None
    hollow: Annotated[
        float | None,
        words("Keep a shell of this thickness in mm inside the border, or outside if negative."),
    ] = None
    unite: Annotated[
        Path | None, words("Union with the segments of a file.", form="FILE", reads=True)
    ] = None
    subtract: Annotated[
        Path | None, words("Subtract the segments of a file.", form="FILE", reads=True)
    ] = None
    intersect: Annotated[
        Path | None, words("Intersect with the segments of a file.", form="FILE", reads=True)
    ] = None
    resample: Resample = False
    another_patient: AnotherPatient = False
    name: Annotated[str | None, words("Name of the segment.")] = None

    def check(self) -> None:
        """Refuses what cannot be done whatever the scan is.

        Raises:
            OptionError: No way to make a segment is given or several are, or an option is wrong.
        """
        given = (self.threshold, self.otsu, self.grow or None, self.seeds, self.auto or None)
        ways = sum(way is not None for way in given)
        if ways != 1:
            raise OptionError(
                f"{ways} ways to make a segment given; allowed: one of `threshold=LOW,HIGH`, "
                "`otsu=CLASSES`, `grow=X,Y,Z`, `seeds=FILE`, `auto=True`"
            )
        if self.fast and not self.auto:
            raise OptionError("`fast=True` given; allowed: with `auto=True` only")
        if not self.grow and not self.spread is self.passage is self.most is None:
            raise OptionError("options of growing given; allowed: with `grow=X,Y,Z` only")
        if self.grow:
            self._growing.check()
        for point in self.grow:
            parse_point(point)
        self._check_threshold()

    def check_on(self, volume: Volume, *, progress: Progress = silent) -> None:
        """Refuses what cannot be done with a scan, before any segment is made.

        Raises:
            PalpateError: A tissue is given for values that are not HU, or a file of segments cannot
                be read or does not fit the scan.
        """
        self._bounds(volume)
        for file in (self.seeds, *(other for _, other in self._others())):
            # what another step writes is not there yet
            if file is not None and file.exists():
                self._read(file, volume, progress)

    @property
    def names(self) -> tuple[str, ...] | None:
        """Names of the segments that it makes; None where files or programs know them."""
        if self.auto or self.seeds is not None:
            return None
        if self.otsu is not None:
            parts = [f"Otsu {number} of {self.otsu}" for number in range(1, self.otsu + 1)]
            return tuple(part if self.name is None else f"{self.name}, {part}" for part in parts)
        return (self.name or ("region" if self.grow else "threshold"),)

    def make(self, volume: Volume, *, progress: Progress = silent) -> Made:
        """Makes what is asked for out of a scan.

        Raises:
            OptionError: It cannot be, or nothing is left of it.
        """
        from palpate.segmentation.operations import changed_shape, smoothed_together
        from palpate.segmentation.segment_steps import apply_step

        made, warnings = self._found(volume, progress)
        for change in self._changes():
            step = change.kind.replace("-", " ")
            progress(step, None)
            if change.kind == "joint":
                made = smoothed_together(made, deviation=change.amount)
            else:
                made = [apply_step(one, change) for one in made]
            if not any(one.voxel_count for one in made):
                allowed = "thicker walls" if "hollow" in step else "smaller changes"
                raise OptionError(
                    f"nothing is left of the segment after {step} {change.amount:g}; "
                    f"allowed: {allowed}"
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
        from palpate.segmentation.growing.region_growing import Growing

        usual = Growing()
        return Growing(
            spread=self.spread,
            passage=self.passage,
            most_ml=usual.most_ml if self.most is None else self.most,
        )

    def _found(self, volume: Volume, progress: Progress) -> Made:
        from palpate.segmentation.operations import grown, grown_from_seeds, otsu

        if self.auto:
            from palpate.segmentation.automatic import found_automatically

            found = found_automatically(volume, fast=self.fast, progress=progress)
            return [each.segment for each in found.labels], found.warnings
        if self.seeds is not None:
            read = self._read(self.seeds, volume, progress)
            seeds = [each.segment for each in read.labels]
            return grown_from_seeds(volume, seeds, progress=progress), read.warnings
        if self.otsu is not None:
            return otsu(volume, classes=self.otsu), ()
        bounds = self._bounds(volume)
        if bounds is not None:
            return [volume.threshold(*bounds, name="threshold")], ()
        points = [parse_point(point) for point in self.grow]
        return [grown(volume, points, growing=self._growing, progress=progress)], ()

    def steps(self, volume: Volume) -> SegmentSteps:
        """Returns what it asks for as a list of steps, for ``Session.set_steps``.

        Raises:
            OptionError: It asks for something else than a threshold and changes of its shape.
        """
        from palpate.segmentation.segment_steps import SegmentSteps

        self.check()
        bounds, changes = self._bounds(volume), tuple(self._changes())
        alone = self.joint is None and not list(self._others())
        if bounds is None or not alone:
            raise OptionError(
                "these options given as steps of one segment; allowed: a threshold and changes of "
                "its shape, without other segments"
            )
        made = volume.threshold(*bounds)
        return SegmentSteps(made.range or (bounds[0], volume.range[1]), changes)

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

    def _read(self, file: Path, volume: Volume, progress: Progress) -> Labels:
        from palpate.labels.labels import read_labels

        return read_labels(
            file,
            volume,
            resample=self.resample,
            another_patient=self.another_patient,
            progress=progress,
        )

    def _all_of(
        self, file: Path, volume: Volume, progress: Progress
    ) -> tuple[Segment, tuple[str, ...]]:
        """Returns all segments of a file as one."""
        import numpy as np

        read = self._read(file, volume, progress)
        masks = [each.segment.mask() != 0 for each in read.labels]
        union = np.logical_or.reduce(masks) if masks else np.zeros(volume.shape, bool)
        return volume.segment(union, name=file.name), read.warnings

    def _changes(self) -> Iterator[ShapeStep]:
        """Lists what is to be done with the shape, in order."""
        from palpate.segmentation.segment_steps import ShapeStep

        amounts: tuple[tuple[ShapeKind, float | None], ...] = (
            ("keep-largest", 1.0 if self.keep_largest else None),
            ("drop-small", self.drop_below),
            ("fill-holes", 0.0 if self.fill else None),
            ("between-slices", 0.0 if self.between_slices else None),
            ("smooth", self.smooth),
            ("median", self.median),
            ("joint", self.joint),
            ("open", self.opening),
            ("close", self.closing),
            ("shrink" if (self.margin or 0.0) < 0.0 else "grow", self.margin),
            ("hollow-outside" if (self.hollow or 0.0) < 0.0 else "hollow-inside", self.hollow),
        )
        for kind, amount in amounts:
            if amount is not None:
                yield ShapeStep(kind=kind, amount=abs(amount) if kind in SIGNED else amount)
