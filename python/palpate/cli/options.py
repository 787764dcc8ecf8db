"""Options that several commands have."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from palpate.cli.written_files import WRITES

__all__ = [
    "Browser",
    "Mesh",
    "MeshFrame",
    "MeshSpacing",
    "MeshUnit",
    "Plot",
    "Port",
    "Rate",
    "Resample",
    "Scan",
    "ScanOrNone",
    "ScanOrScene",
    "Segments",
    "Threshold",
    "Transform",
    "With",
    "WithFrame",
    "WithSeries",
]

Scan = Annotated[
    Path,
    typer.Argument(
        help="DICOM folder, file or zip archive; NIfTI, NRRD, MetaImage, MINC or other image file; "
        "folder of PNG or TIFF slices.",
        metavar="PATH",
    ),
]
ScanOrNone = Annotated[
    Path | None,
    typer.Argument(
        help="DICOM folder, file or zip archive; NIfTI, NRRD, MetaImage, MINC or other image file; "
        "folder of PNG or TIFF slices; saved scene. Without a path, the page asks "
        "for a scan.",
        metavar="[PATH]",
    ),
]
ScanOrScene = Annotated[
    Path,
    typer.Argument(help="Scan, as for `palpate open`, or a saved .palpate scene.", metavar="PATH"),
]
Threshold = Annotated[
    str | None,
    typer.Option(help="Make a segment of the values from LOW to HIGH.", metavar="LOW[,HIGH]"),
]
Segments = Annotated[
    Path | None,
    typer.Option(help="Segments: label map, .seg.nrrd, DICOM SEG, RTSTRUCT, or a folder of masks."),
]
Resample = Annotated[
    bool,
    typer.Option(
        "--resample",
        help="Resample segments from another grid to that of the scan (nearest neighbour).",
    ),
]
AnotherPatient = Annotated[
    bool,
    typer.Option(
        "--another-patient",
        help="Take DICOM segments of another patient, study or frame of reference as they are.",
    ),
]
With = Annotated[
    Path | None,
    typer.Option(
        "--with",
        help="Second scan to show together with the first, such as MR or RTDOSE with CT.",
    ),
]
WithSeries = Annotated[
    str | None,
    typer.Option("--with-series", help="DICOM series of --with: UID, description, or number."),
]
WithFrame = Annotated[
    int | None,
    typer.Option("--with-frame", help="Volume of --with, if that is an image file with several."),
]
Transform = Annotated[
    Path | None,
    typer.Option(help="Transform (.tfm) for --with; maps points of the first scan to the second."),
]
Mesh = Annotated[
    Path | None,
    typer.Option(help="Closed mesh (.stl, .ply, .obj, .glb) to open as a movable segment."),
]
MeshFrame = Annotated[
    str | None, typer.Option(help="Frame of the mesh, LPS or RAS, if the file does not state it.")
]
MeshUnit = Annotated[
    str | None, typer.Option(help="Unit of the mesh, mm or m, if the file does not state it.")
]
MeshSpacing = Annotated[
    float | None,
    typer.Option(
        "--mesh-spacing",
        "--spacing",
        help="Voxel size of the mesh in mm; by default fine enough for its thickness.",
    ),
]
Port = Annotated[int, typer.Option(help="Port on 127.0.0.1; 0 chooses a free one.")]
Browser = Annotated[bool, typer.Option(help="Open the page in the browser if there is a display.")]
Plot = Annotated[Path | None, typer.Option(help="Plot the results (.png, .svg, .pdf)."), WRITES]
Rate = Annotated[int, typer.Option(help="Servo rate in Hz: 1000 or 4000.")]
