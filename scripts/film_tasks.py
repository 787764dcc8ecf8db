"""Films what people do first, on real scans: `make films` runs it.

Each film goes from the open page to the end of a task as a person would go, with the mouse and the
keys, and says how many seconds and actions that took. A person needs time to look as well.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import SimpleITK
from browser import Browser, browser, palpate
from numpy.typing import NDArray

SIZE = {"width": 1366, "height": 768}
"""Of the browser's window [pixels]."""
RATE = 12.0
"""Pictures a second of a film."""
LOOK = 0.6
"""Time to look between two actions [s]."""
AIR, BONE = -400.0, 200.0
"""Values below and above what a needle goes through [HU]."""
WORK = 6.0
"""Time that a tool works [s]."""
LIVER = {"amos_0336": 6, "lidc0001_totalseg": 5}
"""Label of the liver in each scan's own segments."""


@dataclass
class Person:
    """Who sits at the page: moves the mouse from place to place, clicks, presses keys."""

    page: Browser
    scan: Path
    at: tuple[float, float] = (683.0, 384.0)
    actions: int = 0
    began: float = field(default_factory=time.monotonic)

    def goes_to(self, x: float, y: float) -> None:
        """Moves the mouse [pixels of the page]."""
        for share in np.linspace(0, 1, 12)[1:]:
            self.page.do(
                "point",
                x=self.at[0] + (x - self.at[0]) * share,
                y=self.at[1] + (y - self.at[1]) * share,
            )
        self.at = (x, y)

    def clicks(self, selector: str) -> None:
        """Clicks on an element, which comes into sight first."""
        element = f"document.querySelector({selector!r})"
        self.page.wait(f"{element} !== null")
        self.page.read(f"{element}.scrollIntoView({{block: 'nearest'}})")
        box = self.page.read(f"{element}.getBoundingClientRect().toJSON()")
        self.goes_to(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        self.page.do("mouse", down=True)
        self.page.do("mouse", down=False)
        self.acted()

    def presses(self, key: str) -> None:
        """Presses a key, as Playwright names it."""
        self.page.do("press", key=key)
        self.acted()

    def acted(self) -> None:
        """Counts an action, and looks at what came of it."""
        self.actions += 1
        time.sleep(LOOK)

    def touches(self, name: str, *, key: str | None = None) -> None:
        """Presses on a segment where it is seen, slides along it, and lifts off.

        With a key held, a tool works meanwhile in one place.
        """
        self.page.wait(
            "[...document.querySelectorAll('li[data-testid^=segment-] .name')]"
            f".some(({{ textContent }}) => textContent.includes({name!r}))"
        )
        x, y = self._seen(name)
        self.goes_to(x, y)
        self.page.do("mouse", down=True)
        self.page.wait("window.palpate.state.contact", seconds=20)
        if key is None:
            for _ in range(2):
                self.goes_to(x + 14, y + 6)
                self.goes_to(x, y)
            time.sleep(2 * LOOK)
        else:
            self.page.do("hold", key=key)
            time.sleep(WORK)
            self.page.do("hold", key=key, up=True)
        self.page.do("mouse", down=False)
        self.acted()

    def _seen(self, name: str) -> tuple[float, float]:
        """Returns where a segment is seen, near the middle of the view [pixels of the page]."""
        x, y, away = self.page.read(
            "(() => { const box = document.querySelector('[data-testid=canvas]')"
            ".getBoundingClientRect(); const { state, pick } = window.palpate;"
            f" const wanted = [...document.querySelectorAll('li[data-testid^=segment-]')]"
            f".find((row) => row.querySelector('.name').textContent.includes({name!r}))"
            ".dataset.testid.split('-')[1];"
            " let best = [0, 0, Infinity];"
            " for (let x = 40; x < box.width - 40; x += 12)"
            " for (let y = 90; y < box.height - 60; y += 12) {"
            " const away = Math.hypot(x - box.width / 2, y - box.height / 2);"
            " if (away < best[2] && String(pick(x, y)?.segment) === wanted)"
            " best = [box.x + x, box.y + y, away]; }"
            " return best; })()"
        )
        if away is None:
            raise SystemExit(f"{name} is not seen")
        return x, y

    @property
    def seconds(self) -> float:
        """Since the person began."""
        return time.monotonic() - self.began


@dataclass(frozen=True)
class Task:
    """What a person sets out to do."""

    name: str
    scan: str
    does: Callable[[Person], None]


def table_and_skin(person: Person) -> None:
    """Opens, removes the table, feels bone and skin."""
    page = person.page
    if not page.read("document.querySelector('[data-testid=table-bar]') !== null"):
        person.clicks("[data-testid=group-scan]")
        person.clicks("[data-testid=find-table]")
    page.wait("document.querySelector('[data-testid=table-remove]') !== null", seconds=60)
    time.sleep(2 * LOOK)
    person.clicks("[data-testid=table-remove]")
    page.wait("document.querySelector('[data-testid=table-remove]') === null", seconds=60)
    page.all_done()
    page.finish()
    person.presses("t")
    person.touches("bone")
    person.clicks("[data-testid=group-segments]")
    person.clicks("[aria-label='Add a segment by threshold']")
    page.all_done()
    page.finish()
    person.touches("Skin")


def liver(person: Person) -> None:
    """Finds the liver by one click in a slice, hides the bone, makes it soft and presses it."""
    page = person.page
    person.clicks("[data-testid=layout-four]")
    person.clicks("[data-testid=group-segments]")
    person.clicks("[data-testid=find-segments]")
    person.clicks("[data-testid=grow-click]")
    person.goes_to(*_liver_in_pane(page, person.scan))
    page.do("mouse", down=True)
    page.do("mouse", down=False)
    person.acted()
    page.wait("document.querySelector('[data-testid=grown-keep]') !== null", seconds=120)
    time.sleep(2 * LOOK)
    person.clicks("[data-testid=grown-keep]")
    page.finish()
    person.clicks("[data-testid=visible-1]")
    person.clicks("[data-testid=layout-view]")
    page.finish()
    row = page.read(
        "[...document.querySelectorAll('[data-testid^=matter-]')].at(-1).dataset.testid"
    )
    page.do("choose", testid=row.replace("matter", "material"), value="liver")
    person.acted()
    page.all_done()
    person.presses("t")
    person.touches("Region")


def drill(person: Person) -> None:
    """Comes closer, drills a hole into bone, looks at it from aside, and takes it back."""
    page = person.page
    person.goes_to(683.0, 384.0)
    page.do("wheel", y=-1200)
    person.acted()
    person.presses("t")
    person.presses("d")
    person.touches("bone", key="x")
    removed = page.read("window.palpate.state.tool.voxels")
    if not removed:
        raise SystemExit("no hole was drilled")
    page.all_done()
    # the tool stands before the hole
    person.presses("h")
    person.presses("Escape")
    person.goes_to(440.0, 600.0)
    page.do("mouse", down=True)
    person.goes_to(600.0, 600.0)
    page.do("mouse", down=False)
    person.acted()
    time.sleep(4 * LOOK)
    person.presses("Control+z")
    page.all_done()
    time.sleep(2 * LOOK)


def measure(person: Person) -> None:
    """Measures the liver in a slice, and saves the table of marks."""
    page = person.page
    person.clicks("[data-testid=layout-four]")
    page.finish()
    person.presses("m")
    x, y = _liver_in_pane(page, person.scan)
    for aside in (-30.0, 30.0):
        person.goes_to(x + aside, y)
        page.do("mouse", down=True)
        page.do("mouse", down=False)
        person.acted()
    page.wait("window.palpate.marks.length === 1")
    person.clicks("[data-testid=group-marks]")
    person.clicks("[data-testid=marks-save]")
    page.wait("document.querySelector('.notice')?.textContent.includes('marks.csv') === true")
    time.sleep(2 * LOOK)


def needle(person: Person) -> None:
    """Plans a path to the liver in a slice, brings a needle to the entry and pushes it in."""
    page = person.page
    person.clicks("[data-testid=layout-four]")
    person.presses("i")
    person.clicks("[data-testid=needle-skin]")
    page.all_done()
    page.finish()
    # all slices go through the place that is clicked: the axial one comes to the liver
    person.goes_to(*_liver_in_pane(page, person.scan))
    page.do("mouse", down=True)
    page.do("mouse", down=False)
    person.acted()
    page.finish()
    person.clicks("[data-testid=needle-plan]")
    target, entry = _way_to_liver(page, person.scan)
    for place in (target, entry):
        person.goes_to(*place)
        page.do("mouse", down=True)
        page.do("mouse", down=False)
        person.acted()
    time.sleep(2 * LOOK)
    person.clicks("[data-testid=needle-to-entry]")
    page.all_done()
    tip = _in_pane(page, "axial", page.read("window.palpate.state.proxy"))
    person.goes_to(*tip)
    page.do("hold", key="Shift")
    page.do("mouse", down=True)
    # as far as the needle still has to go, which its card tells
    for _ in range(12):
        now = _in_pane(page, "axial", page.read("window.palpate.state.proxy"))
        left = np.subtract(target, now)
        if np.hypot(*left) < 1.0:
            break
        person.goes_to(*(person.at + left / 2))
        time.sleep(LOOK / 2)
    page.wait("window.palpate.state.needle.inside")
    time.sleep(3 * LOOK)
    page.do("mouse", down=False)
    page.do("hold", key="Shift", up=True)
    person.acted()
    print(f"  {page.text('needle-ahead')} to the target, {page.text('needle-off')} off the line")


TASKS = [
    Task(f"{name}-{short}", scan, does)
    for short, scan in (
        ("amos", "amos_0336/amos_0336.mhd"),
        ("lidc", "lidc0001_totalseg/cxr.nii.gz"),
    )
    for name, does in (
        ("table", table_and_skin),
        ("liver", liver),
        ("drill", drill),
        ("measure", measure),
        ("needle", needle),
    )
]


def main(data: Path, films: Path, wanted: list[str]) -> None:
    """Films tasks whose names begin with one of those wanted, or all."""
    films.mkdir(parents=True, exist_ok=True)
    for task in TASKS:
        if not wanted or any(task.name.startswith(each) for each in wanted):
            _film(task, data, films)


def _film(task: Task, data: Path, films: Path) -> None:
    scan = data / task.scan
    with (
        TemporaryDirectory() as folder,
        palpate("open", scan, "--unit", "HU") as command,
        browser() as page,
    ):
        page.do("open", url=command.url, **SIZE)
        page.finish()
        page.do("film", folder=folder)
        person = Person(page, scan)
        task.does(person)
        seconds = person.seconds
        page.do("screenshot", path=str(films / f"{task.name}.png"))
        frames = [(moment, Path(folder) / name) for moment, name in page.do("cut")["value"]]
        _write(films / f"{task.name}.mp4", frames)
        if page.complaints:
            raise SystemExit(f"{task.name}: {page.complaints}")
    print(f"{task.name}: {seconds:.0f} s, {person.actions} actions")


def _write(path: Path, frames: list[tuple[float, Path]]) -> None:
    """Writes a film at an even rate: the page gives a picture whenever one has changed."""
    from palpate.pictures.film import write_film

    def pictures() -> Iterator[NDArray[np.uint8]]:
        moments = np.array([moment for moment, _ in frames])
        for now in np.arange(moments[0], moments[-1], 1 / RATE):
            shown = frames[int(np.searchsorted(moments, now, side="right")) - 1][1]
            colours = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(shown)))[..., :3]
            yield np.dstack([colours, np.full(colours.shape[:2], 255, np.uint8)])

    count = int(RATE * (frames[-1][0] - frames[0][0])) + 1
    write_film(pictures(), path, fps=RATE, count=count)


def _in_pane(page: Browser, name: str, point: list[float]) -> tuple[float, float]:
    """Returns where a slice has a point of the scene [pixels of the page]."""
    plane, box = _pane(page, name)
    off = np.subtract(point, plane["centre"])
    return (
        box["x"] + box["width"] / 2 + float(off @ plane["right"]) / plane["pixel"],
        box["y"] + box["height"] / 2 - float(off @ plane["up"]) / plane["pixel"],
    )


def _pane(page: Browser, name: str) -> tuple[dict[str, Any], dict[str, float]]:
    """Returns the plane of a slice, and its box on the page."""
    shown: dict[str, Any] = page.read(
        f"(({{ plane }}) => ({{ plane, box: document.querySelector('[data-testid=slice-{name}]')"
        ".getBoundingClientRect().toJSON() }))"
        f"(window.palpate.slices.find((slice) => slice.name === {name!r}))"
    )
    return shown["plane"], shown["box"]


def _way_to_liver(page: Browser, scan: Path) -> tuple[tuple[float, float], tuple[float, float]]:
    """Returns a target in the liver and an entry in the axial slice [pixels of the page].

    The way is straight from the patient's right, and meets no bone.
    """
    image = SimpleITK.ReadImage(str(scan))
    plane, box = _pane(page, "axial")
    x, middle = _liver_in_pane(page, scan, "axial")
    for y in sorted(np.arange(middle - 60, middle + 60, 4), key=lambda y: abs(y - middle)):
        off = np.arange(x, box["x"], -1.0) - box["x"] - box["width"] / 2
        points = (
            np.array(plane["centre"])
            + off[:, None] * plane["pixel"] * np.array(plane["right"])
            + (box["y"] + box["height"] / 2 - y) * plane["pixel"] * np.array(plane["up"])
        )
        places = [image.TransformPhysicalPointToIndex(point.tolist()) for point in points]
        values = np.array([image[p] if min(p) >= 0 else -1000 for p in places])
        outside = int(np.argmax(values < AIR))
        if values[0] > 0 and values[:outside].max() < BONE:
            return (x, float(y)), (x - outside - 2, float(y))
    raise SystemExit("every way to the liver meets bone")


def _liver_in_pane(page: Browser, scan: Path, pane: str = "coronal") -> tuple[float, float]:
    """Returns the middle of the liver in a slice [pixels of the page].

    It is where the scan's own labels have it.
    """
    folder = scan.parent
    name = "labels_from_meshes.nii.gz" if folder.name == "amos_0336" else "mask.nii.gz"
    labels = SimpleITK.ReadImage(str(folder / name))
    plane, box = _pane(page, pane)
    off = np.stack(np.meshgrid(np.arange(8, box["width"], 8), np.arange(8, box["height"], 8)), -1)
    middle = np.array([box["width"], box["height"]]) / 2
    across, down = np.moveaxis((off - middle) * plane["pixel"], -1, 0)
    points = (
        np.array(plane["centre"])
        + across[..., None] * np.array(plane["right"])
        - down[..., None] * np.array(plane["up"])
    )
    held = np.zeros(off.shape[:2], np.uint8)
    for place in np.ndindex(held.shape):
        index = labels.TransformPhysicalPointToIndex([float(c) for c in points[place]])
        if all(0 <= i < n for i, n in zip(index, labels.GetSize(), strict=True)):
            held[place] = labels[index] == LIVER[folder.name]
    depth = SimpleITK.GetArrayFromImage(
        SimpleITK.SignedMaurerDistanceMap(
            SimpleITK.GetImageFromArray(held), insideIsPositive=True, squaredDistance=False
        )
    )
    x, y = off[np.unravel_index(int(depth.argmax()), depth.shape)]
    return box["x"] + float(x), box["y"] + float(y)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
