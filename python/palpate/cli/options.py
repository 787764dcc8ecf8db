"""Options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = [
    "Browser",
    "Fill",
    "MaxVoxels",
    "Mesh",
    "MeshFrame",
    "MeshSpacing",
    "MeshUnit",
    "Orientation",
    "Plot",
    "Port",
    "Rate",
    "Raw",
    "Resample",
    "Scan",
    "ScanOrNone",
    "Segments",
    "Series",
    "Threshold",
    "Transform",
    "Unit",
    "VoxelSize",
    "With",
]

Scan = Annotated[
    Path,
    typer.Argument(
        help="DICOM folder, file or zip archive; NIfTI, NRRD, MetaImage or MINC file; pictures.",
        metavar="PATH",
    ),
]
ScanOrNone = Annotated[
    Path | None,
    typer.Argument(
        help="DICOM folder, file or zip archive; NIfTI, NRRD, MetaImage or MINC file; pictures; a "
        "scene. Without it the page asks for a scan.",
        metavar="[PATH]",
    ),
]
Series = Annotated[
    str | None, typer.Option(help="DICOM series: its UID, description or number in the list.")
]
Orientation = Annotated[
    str | None, typer.Option(help="Sides toward which x, y, z run, such as LPS or RAS.")
]
Unit = Annotated[str | None, typer.Option(help="HU, where the values are known to be.")]
Raw = Annotated[
    str | None,
    typer.Option(
        help="Layout of raw voxels, such as 256x256x113,int16,big.",
        metavar="SIZE,TYPE[,ORDER[,SKIP]]",
    ),
]
VoxelSize = Annotated[
    str | None, typer.Option(help="Of raw voxels and pictures, in mm.", metavar="X,Y,Z")
]
Fill = Annotated[float | None, typer.Option(help="Value in the place of NaN and infinity.")]
MaxVoxels = Annotated[int, typer.Option(help="Largest scan that is read.")]
Threshold = Annotated[
    str | None, typer.Option(help="Values of the segment to touch.", metavar="LOW[,HIGH]")
]
Segments = Annotated[
    Path | None,
    typer.Option(help="Label map, .seg.nrrd, DICOM SEG or RTSTRUCT, or a folder of masks."),
]
Resample = Annotated[
    bool,
    typer.Option(
        "--resample", help="Segments of another grid are laid on the scan's: nearest voxels."
    ),
]
With = Annotated[
    Path | None, typer.Option("--with", help="Second scan, shown with the first: CT and MR.")
]
Transform = Annotated[
    Path | None,
    typer.Option(help="Of --with: .tfm that maps points of the first scan to the second's."),
]
Mesh = Annotated[
    Path | None,
    typer.Option(help="Closed .stl, .ply, .obj or .glb: becomes a segment that can be moved."),
]
MeshFrame = Annotated[str | None, typer.Option(help="LPS or RAS, where the mesh does not say.")]
MeshUnit = Annotated[str | None, typer.Option(help="mm or m, where the mesh does not say.")]
MeshSpacing = Annotated[
    float | None,
    typer.Option(
        "--mesh-spacing",
        "--spacing",
        help="Edge of the mesh's voxels in mm; else fine enough for its thickness.",
    ),
]
Port = Annotated[int, typer.Option(help="Port of 127.0.0.1; 0 takes a free one.")]
Browser = Annotated[bool, typer.Option(help="Open the page, where there is a display.")]
Plot = Annotated[Path | None, typer.Option(help="Draw the figures: .png, .svg or .pdf.")]
Rate = Annotated[int, typer.Option(help="Servo ticks a second: 1000 or 4000.")]
