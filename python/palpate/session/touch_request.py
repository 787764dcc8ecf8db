"""Touch by a script as a command, a recipe or a program asks for it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import msgspec

from palpate.base.errors import OptionError
from palpate.base.plot_file import ENDINGS, check_plot
from palpate.base.request import Request, words

__all__ = ["TouchRequest"]


class TouchRequest(Request, frozen=True, kw_only=True):
    """The options of ``palpate touch``."""

    segment: Annotated[
        str | None, words("Name or number of the segment, if there are several.")
    ] = None
    do: Annotated[
        Literal["press", "stroke", "drill"],
        words("press (in and out), stroke (along the surface), or drill."),
    ] = "press"
    at: Annotated[
        str,
        words(
            "Where: left, right, posterior, anterior, superior, inferior; axis 1+, axis 1-, … "
            "axis 3- (ends of principal axes, the longest first); or a point X,Y,Z in LPS, in mm.",
            form="PLACE",
        ),
    ] = "anterior"
    offset: Annotated[
        tuple[float, float, float],
        words("How far from there, in LPS, in mm.", form="X,Y,Z"),
    ] = (0.0, 0.0, 0.0)
    depth: Annotated[float, words("How deep below the surface, in mm.")] = 2.0
    length: Annotated[float, words("Length of a stroke in mm; the place is its middle.")] = 20.0
    along: Annotated[
        str | None,
        words("Direction of a stroke, told as a place; by default the longest principal axis."),
    ] = None
    speed: Annotated[float, words("Speed in mm/s.")] = 5.0
    radius: Annotated[float, words("Radius of the ball that touches, in mm.")] = 3.0
    material: Annotated[
        str | None,
        words("Soft tissue that gives way, such as liver, skin, fat, muscle; by default rigid."),
    ] = None
    rigid: Annotated[
        list[str],
        words("Name of another segment that is touched too, and rigid; repeatable."),
    ] = msgspec.field(default_factory=list)
    out: Annotated[
        Path | None,
        words("Force curve to write (.csv, .json).", short="o", writes=(".csv", ".json")),
    ] = None
    plot: Annotated[
        Path | None,
        words("Plot of the force curve (.png, .svg, .pdf).", writes=ENDINGS),
    ] = None

    def check(self) -> None:
        """Refuses what cannot be done, whatever the segment is.

        Raises:
            OptionError: A number or a word is not allowed, or a plot cannot be made here.
        """
        from palpate.segmentation.measures.surface_place import check_place

        check_place(self.at)
        for name, value, most in (
            ("depth", self.depth, 50.0),
            ("length", self.length, 500.0),
            ("speed", self.speed, 100.0),
            ("radius", self.radius, 20.0),
        ):
            if not 0.0 < value <= most:
                raise OptionError(f"{name} {value:g} given; allowed: more than 0, at most {most:g}")
        if self.do == "drill" and self.material is not None:
            raise OptionError("drill with a material given; allowed: a rigid segment to drill")
        check_plot(self.plot)
