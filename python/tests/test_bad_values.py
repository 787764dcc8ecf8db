"""Readers of all kinds on files with values that cannot be: each answer is one clear line.

Values are generated; a long form (PALPATE_LONG) tries many more of them.
"""

from __future__ import annotations

import copy
import json
import os
import shutil
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import palpate
import pytest
import trimesh
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from made_scans import series_writer
from palpate.base.errors import PalpateError
from palpate.bench.fuzz_import import laid, read_sample, sample_of
from palpate.bench.fuzz_samples import Sample, samples_in
from palpate.bench.structured_damage import restructured
from palpate.export.export import export_scene
from palpate.io.dicomweb import http as web_http
from palpate.io.dicomweb import series as web_series
from palpate.io.dicomweb.address import WebAddress
from palpate.io.reading import list_series
from palpate.labels.labels import read_labels
from palpate.recipes.recipe import read_recipe
from palpate.saved.scene_file import open_scene, save_scene
from palpate.session.appearance import appearances_of, keep_appearances, restore_appearances
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene

EXAMPLES = 400 if os.environ.get("PALPATE_LONG") else 25
"""Of each test."""

quick = settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
bad_values = st.one_of(
    st.none(),
    st.booleans(),
    st.sampled_from([0, -1, 2**31, 2**63, 10**30, 1e308, -1e308, 5e-324]),
    st.sampled_from(["", "nan", "1e400", "-1", "x" * 3000, "\x00", "../..", "\ud7ff", "1\n2"]),
    st.sampled_from([[], {}, [[]], [1], {"a": None}, [None] * 3, [1.5, "x"], [[1, 2], [3]]]),
)


def one_line(read: Callable[[], object]) -> None:
    """Reads; refused files are, in one line."""
    try:
        read()
    except (PalpateError, OSError) as error:
        said = str(error)
    else:
        return
    assert "\n" not in said
    assert len(said) < 1000


def places_in(value: Any, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Lists the ways to all values of a document."""
    found = [way] if way else []
    items: list[tuple[Any, Any]] = [*value.items()] if isinstance(value, dict) else []
    items += enumerate(value) if isinstance(value, list) else []
    for key, held in items:
        found += places_in(held, (*way, key))
    return found


def replaced(document: Any, place: int, value: Any) -> Any:
    """Returns a document with another value at one of its places."""
    ways = places_in(document)
    *way, last = ways[place % len(ways)]
    made = copy.deepcopy(document)
    holder = made
    for key in way:
        holder = holder[key]
    holder[last] = value
    return made


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small series, what is exported of it, and a scene."""
    folder = tmp_path_factory.mktemp("made")
    series = series_writer(folder)("series", StudyInstanceUID="1.2.3", FrameOfReferenceUID="1.2.4")
    volume = palpate.read(series)
    scene = Scene(volume, [volume.threshold(-850.0, name="upper")])
    export_scene(scene, folder / "seg.dcm", kind="dicom-seg", keep_identity=True)
    export_scene(scene, folder / "rt.dcm", kind="rtstruct", keep_identity=True)
    for name in ("a.seg.nrrd", "b.mha", "b.nii.gz"):
        export_scene(scene, folder / name)
    (folder / "b.csv").write_text("id,structure,red,green,blue\n1,one,1,0,0.5\n", "utf-8")
    for ending in (".stl", ".ply", ".obj", ".glb"):
        mesh = trimesh.creation.icosphere(subdivisions=1, radius=20.0)
        mesh.export(folder / f"mesh{ending}")
    with Session(scene, options=SessionOptions(real_time=False)) as session:
        looks = keep_appearances(session, appearances_of(session).__getitem__)
        save_scene(folder / "scene.palpate", session, looks=looks, copy=True)
        save_scene(folder / "link.palpate", session, looks=looks)
    return folder


@pytest.fixture(scope="module")
def others(made: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Sample]:
    """Files of neuroimaging, and objects of DICOM with the ways to read them."""
    listed = samples_in(made, tmp_path_factory.mktemp("others"))
    return [sample for sample in listed if sample.kind in ("dicom", "neuro", "segments")]


def damaged_at(path: Path, seed: int) -> Path:
    """Writes a damaged copy of a file beside it; returns its path."""
    generator = np.random.default_rng(seed)
    copied = path.with_name(f"damaged-{path.name}")
    copied.write_bytes(restructured(path.read_bytes(), generator))
    return copied


seeds = st.integers(0, 2**32 - 1)


@quick
@given(seed=seeds)
def test_scans_and_lists_of_series(made: Path, seed: int) -> None:
    folder = made / "broken"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(made / "series", folder)
    first = min(folder.iterdir())
    first.write_bytes(restructured(first.read_bytes(), np.random.default_rng(seed)))
    one_line(lambda: palpate.read(folder))
    one_line(lambda: list_series(folder))
    for name in ("b.mha", "b.nii.gz", "a.seg.nrrd"):
        one_line(partial(palpate.read, damaged_at(made / name, seed)))


@quick
@given(seed=seeds, name=st.sampled_from(["seg.dcm", "rt.dcm", "a.seg.nrrd", "b.mha", "b.csv"]))
def test_segments(made: Path, seed: int, name: str) -> None:
    volume = palpate.read(made / "series")
    path = damaged_at(made / name, seed)
    if name == "b.csv":
        # a table is read with the map beside it
        shutil.copyfile(made / "b.mha", made / "damaged-b.mha")
        path = made / "damaged-b.mha"
    one_line(lambda: read_labels(path, volume))


@quick
@given(seed=seeds)
def test_other_formats_and_objects_of_dicom(made: Path, others: list[Sample], seed: int) -> None:
    folder = made / "other"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    sample = sample_of(others, seed)
    one_line(partial(read_sample, sample, laid(sample, seed, folder)))


@quick
@given(seed=seeds, ending=st.sampled_from([".stl", ".ply", ".obj", ".glb"]))
def test_meshes(made: Path, seed: int, ending: str) -> None:
    path = damaged_at(made / f"mesh{ending}", seed)
    one_line(lambda: palpate.read_mesh(path, frame="LPS", unit="mm"))


@quick
@given(
    place=st.integers(0, 10**6),
    value=bad_values,
    name=st.sampled_from(["scene.palpate", "link.palpate"]),
)
def test_scenes(made: Path, place: int, value: object, name: str) -> None:
    path = made / "broken.palpate"
    with zipfile.ZipFile(made / name) as old, zipfile.ZipFile(path, "w") as new:
        about = json.loads(old.read("scene.json"))
        for member in old.namelist():
            if member != "scene.json":
                new.writestr(member, old.read(member))
        new.writestr("scene.json", json.dumps(replaced(about, place, value)))

    def opened() -> None:
        saved = open_scene(path)
        with Session(saved.scene(), options=SessionOptions(real_time=False)) as session:
            saved.restore(session)
            restore_appearances(session, saved.looks)

    one_line(opened)


RECIPE: dict[str, Any] = {
    "import": {"path": "b.mha", "unit": "HU", "voxel-size": "1,1,1"},
    "segment": [{"threshold": [200, 400], "keep-largest": True, "name": "ball"}],
    "surface": [{"segment": "ball", "out": "ball.stl", "smoothing": 2}],
    "export": [{"out": "labels.nii.gz", "only": ["ball"]}],
    "report": "report.html",
}


@quick
@given(place=st.integers(0, 10**6), value=bad_values, seed=seeds)
def test_recipes(made: Path, place: int, value: object, seed: int) -> None:
    path = made / "recipe.yaml"
    path.write_bytes(
        yaml.safe_dump(replaced(RECIPE, place, value), allow_unicode=True).encode(errors="replace")
    )
    one_line(lambda: read_recipe(path))
    path.write_bytes(restructured(yaml.safe_dump(RECIPE).encode(), np.random.default_rng(seed)))
    one_line(lambda: read_recipe(path))


@pytest.mark.parametrize(
    "text", ["[" * 5000, "- " * 5000, "{a: " * 5000, "? [a]\n: 1", "2001-99-99: 1"]
)
def test_a_recipe_of_strange_form(made: Path, text: str) -> None:
    path = made / "strange.yaml"
    path.write_text(text)
    with pytest.raises(PalpateError):
        read_recipe(path)


ANSWER = [
    {
        "0020000D": {"vr": "UI", "Value": ["1.2.3"]},
        "0020000E": {"vr": "UI", "Value": ["1.2.4"]},
        "00100010": {"vr": "PN", "Value": [{"Alphabetic": "Doe"}]},
        "00201209": {"vr": "IS", "Value": [7]},
        "00280010": {"vr": "US", "Value": [512]},
        "00280011": {"vr": "US", "Value": [512]},
    }
]


@quick
@given(place=st.integers(0, 10**6), value=bad_values)
def test_answers_of_servers(place: int, value: object) -> None:
    answer = replaced({"answer": ANSWER}, place, value)["answer"]

    class Client:
        def search_for_series(self, *_: object, **__: object) -> object:
            return answer

        search_for_instances = search_for_series

    @contextmanager
    def client_of(*_: object) -> Iterator[Client]:
        yield Client()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(web_series, "client_of", client_of)
        patch.setattr(web_http, "client_of", client_of)
        one_line(lambda: web_series.remote_series(WebAddress.of("http://127.0.0.1:1/x")))
