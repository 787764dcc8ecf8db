"""Raw voxels and pictures that pages find: a layout is asked for, tried, and remembered."""

from __future__ import annotations

from base64 import b64decode
from pathlib import Path

import numpy as np
import palpate
import pytest
import SimpleITK
from numpy.typing import NDArray
from running_server import LibraryClient


def picture_of(png: str, path: Path) -> NDArray[np.uint8]:
    path.write_bytes(b64decode(png))
    return np.asarray(SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path))))


@pytest.mark.data
def test_raw_slices_are_told_tried_opened_and_remembered(
    client: LibraryClient, data_folder: Path, tmp_path: Path
) -> None:
    folder = data_folder / "cthead_stanford" / "raw"
    found, done = client.job("find", {"path": str(folder)})
    assert done == {"kind": "done"}
    assert (found["kind"], found["name"], found["files"]) == ("bare", "raw", 113)
    assert found["layout"] == {
        "columns": 256,
        "rows": 256,
        "slices": None,
        "kind": "int16",
        "order": "big",
        "skip": 0,
    }
    assert found["voxel"] == [None, None, None]
    tried = {"find": found["find"], "raw": "256x256,int16,big,0", "voxel_size": [1, 1, 2]}
    answer = client.ask("POST", "library/layout", tried).json()
    assert answer["size"] == [256, 256, 113]
    assert picture_of(answer["png"], tmp_path / "seen.png").shape == (256, 256)
    wrong = client.ask("POST", "library/layout", {**tried, "raw": "256x300,int16,big,0"})
    assert wrong.status_code == 400
    assert wrong.text.startswith("CThead.1 has 131072 bytes; 256 × 300 int16 asks 153600")

    (refused,) = client.job("open", {**tried, "voxel_size": [1, 1, 0]})
    assert "lengths above 0" in refused["reason"]
    assert client.job("open", tried) == [{"kind": "done"}]
    opened = client.workbench.opened
    assert opened is not None
    volume = opened.session.scene.volume
    assert (volume.name, volume.spacing) == ("raw", (1.0, 1.0, 2.0))
    np.testing.assert_array_equal(
        volume.array,
        palpate.read(folder, raw="256x256,int16,big", voxel_size=(1.0, 1.0, 2.0)).array,
    )
    # opened again without being asked
    (recent,) = client.about()["recent"]
    again = {key: recent[key] for key in ("path", "series", "raw", "voxel_size")}
    assert (again["raw"], again["voxel_size"]) == ("256x256,int16,big,0", [1.0, 1.0, 2.0])
    assert client.job("open", {**again, "beside": True}) == [{"kind": "done"}]
    second = opened.session.scene.second
    assert second is not None
    assert second.volume.dimensions == (256, 256, 113)


def test_dropped_slices_have_a_name_and_pictures_a_size(
    client: LibraryClient, tmp_path: Path
) -> None:
    values = (np.arange(3 * 40 * 40) % 200).reshape(3, 40, 40)
    slices = {f"skull-{n}.raw": part.astype("<i2").tobytes() for n, part in enumerate(values, 1)}
    upload = client.upload(slices)
    found, _ = client.job("find", {"upload": upload})
    assert (found["kind"], found["name"]) == ("bare", "skull")
    wanted = {"find": found["find"], "raw": "40x40,int16,little,0", "voxel_size": [0.5, 0.5, 1]}
    assert client.job("open", wanted) == [{"kind": "done"}]
    opened = client.workbench.opened
    assert opened is not None
    assert opened.session.scene.volume.name == "skull"
    volume = opened.session.scene.volume
    assert "temporary copy" in volume.traits.warnings[-1]
    warnings = volume.warnings
    # each is told once
    assert len(set(warnings)) == len(warnings)
    assert client.about()["recent"] == []

    folder = tmp_path / "pictures"
    folder.mkdir()
    for number, part in enumerate(values):
        image = SimpleITK.GetImageFromArray(part.astype(np.uint8))
        SimpleITK.WriteImage(image, str(folder / f"{number}.png"))
    found, _ = client.job("find", {"path": str(folder)})
    assert (found["kind"], found["layout"], found["size"]) == ("bare", None, [40, 40, 3])
    tried = {"find": found["find"], "voxel_size": [1, 4, 2]}
    answer = client.ask("POST", "library/layout", tried).json()
    assert picture_of(answer["png"], tmp_path / "seen.png").shape == (256, 64)
    assert client.job("open", tried) == [{"kind": "done"}]
    opened = client.workbench.opened
    assert opened is not None
    np.testing.assert_array_equal(opened.session.scene.volume.array, values)
    # a list of scans has no layout
    refused = client.ask("POST", "library/layout", {"find": 99})
    assert "those files are gone" in refused.text
    # slices may be projections: the page can say so
    found, _ = client.job("find", {"path": str(folder), "taken_as": "scan"})
    assert found["kind"] == "bare"
