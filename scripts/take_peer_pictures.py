"""Takes pictures of Palpate, OHIF and niivue with the same scan: `make pictures-beside` runs it.

Each is led by ``viewer/e2e/peers.mjs`` as by a hand, in the same browser and window, from its
first page to bone in 3-D; in Palpate until it is touched. What the hand does is counted and told.
OHIF asks Orthanc for the scan; niivue and Palpate get it dropped onto their pages.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

from browser import ROOT, palpate
from orthanc import orthanc
from peer_scan import write_study
from peer_server import files_below, served

STUDY = "LIDC-IDRI-0001"
"""How the patient is called in the list."""
HERE = Path(__file__).parent


def main(data: Path, peers: Path, images: Path) -> None:
    """Takes the pictures of a scan in the data folder with programs that were fetched."""
    scan = data / "lidc0001_totalseg" / "cxr.nii.gz"
    with TemporaryDirectory() as made:
        folder = Path(made) / STUDY
        slices = write_study(scan, folder)
        _take_palpate(folder, images / "beside-palpate.png")
        _take_ohif(slices, peers / "ohif", images / "beside-ohif.png")
    _take_niivue(scan, peers / "niivue", images / "beside-niivue.png")


def _take_palpate(folder: Path, picture: Path) -> None:
    with palpate("open") as command:
        _take("palpate", command.url, picture, dropped=folder)


def _take_ohif(slices: list[Path], program: Path, picture: Path) -> None:
    files = files_below(program / "dist") | {"app-config.js": HERE / "peer_ohif.js"}
    with orthanc() as archive:
        archive.store(slices)
        with served(files, dicom=archive.dicomweb) as url:
            _take("ohif", url, picture)


def _take_niivue(scan: Path, program: Path, picture: Path) -> None:
    page = {"index.html": HERE / "peer_niivue.html"}
    with served(files_below(program / "dist") | page) as url:
        _take("niivue", url, picture, dropped=scan)


def _take(program: str, url: str, picture: Path, *, dropped: Path | None = None) -> None:
    """Leads a program to its picture and tells what that took."""
    arguments = [program, url, picture, *([dropped] if dropped else [])]
    led = subprocess.run(
        ["node", ROOT / "viewer" / "e2e" / "peers.mjs", *map(str, arguments)],
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    told = json.loads(led.stdout)
    print(
        picture, dict(Counter(act["towards"] for act in told["acts"])), f"{told['seconds']:.0f} s"
    )
    for act in told["acts"]:
        print(f"    {act['towards']}: {act['does']}")


if __name__ == "__main__":
    main(*(Path(argument).resolve() for argument in sys.argv[1:]))
