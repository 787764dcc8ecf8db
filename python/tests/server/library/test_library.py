"""Scans that pages find and open: lists, pictures, the exchange."""

from __future__ import annotations

import json
import zipfile
from base64 import b64decode
from io import BytesIO
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import palpate
import pytest
import SimpleITK
from orthanc import orthanc
from palpate.saved.recent import recent_scans
from running_server import PATIENCE, LibraryClient


def test_a_folders_series_are_listed_with_pictures_and_what_cannot_be_opened(
    client: LibraryClient, study: Path
) -> None:
    found, *pictures, last = client.job("find", {"path": str(study)})
    assert last == {"kind": "done"}
    assert found["kind"] == "found"
    scans = {one["name"]: one for one in found["scans"]}
    assert scans["thin"] == {
        "patient": "Doe^Jane",
        "study": "",
        "name": "thin",
        "part": "",
        "modality": "CT",
        "size": [4, 3, 4],
        "spacing": [0.75, 0.5, 2.5],
        "refused": None,
        "labels": None,
        "late": False,
    }
    assert scans["scout"]["refused"].startswith("it is a 2-D image")
    drawn = {found["scans"][each["choice"]]["name"]: each["png"] for each in pictures}
    assert set(drawn) == {"thin", "thick"}
    path = study.parent / "picture.png"
    path.write_bytes(b64decode(drawn["thin"]))
    picture = SimpleITK.GetArrayFromImage(SimpleITK.ReadImage(str(path)))
    # 3 mm by 1.5 mm; values rise along rows
    assert picture.shape == (48, 96)
    assert picture[0, 0] == 0
    assert picture[-1, -1] == 255
    assert np.all(np.diff(picture[0].astype(int)) >= 0)


def test_the_chosen_series_is_opened_and_remembered(client: LibraryClient, study: Path) -> None:
    assert client.about()["scan"] is None
    found = client.job("find", {"path": str(study)})[0]
    number = [one["name"] for one in found["scans"]].index("thick")
    assert client.job("open", {"find": found["find"], "choice": number}) == [{"kind": "done"}]
    about = client.about()
    assert (about["scan"], about["changed"], about["kept"]) == ("thick", False, True)
    assert [(one["path"], one["series"], one["name"]) for one in about["recent"]] == [
        (str(study), "1.2.4", "thick")
    ]
    voxels = np.frombuffer(client.ask("GET", "volume").content, "<i2").reshape(4, 3, 4)
    np.testing.assert_array_equal(voxels, palpate.read(study, series="1.2.4").array)

    # a recent one is opened by its place, and is first from then on
    client.job("open", {"path": str(study), "series": "1.2.3"})
    assert client.about()["scan"] == "thin"
    assert [one.name for one in recent_scans()] == ["thin", "thick"]
    assert client.ask("DELETE", "library/recent").status_code == 204
    assert client.about()["recent"] == []


def test_what_cannot_be_opened_is_told_and_the_open_scan_stays(
    client: LibraryClient, study: Path
) -> None:
    found = client.job("find", {"path": str(study)})[0]
    client.job("open", {"path": str(study), "series": "1.2.3"})
    number = [one["name"] for one in found["scans"]].index("scout")
    answer = client.ask("POST", "library/open", {"find": found["find"], "choice": number})
    assert (answer.status_code, answer.text[:15]) == (400, "it is a 2-D ima")
    (failed,) = client.job("open", {"path": str(study), "series": "9.9.9"})
    assert failed["kind"] == "failed"
    assert "no series '9.9.9'" in failed["reason"]
    (failed,) = client.job("find", {"path": str(study / "nowhere")})
    assert "does not exist" in failed["reason"]
    wrongs: list[Any] = [{"find": 99}, {"path": " "}, [], {"path": 7}]
    for wrong in wrongs:
        assert client.ask("POST", "library/open", wrong).status_code == 400
    assert client.ask("POST", "library/find", {}).status_code == 400
    assert client.about()["scan"] == "thin"


def test_changes_of_the_scan_that_is_closed_are_kept_and_told(
    client: LibraryClient, study: Path
) -> None:
    client.job("open", {"path": str(study), "series": "1.2.3"})
    opened = client.workbench.opened
    assert opened is not None
    mask = np.ones((4, 3, 4), np.uint8)
    number = opened.session.add_segment(opened.session.scene.volume.segment(mask, name="all"))
    opened.session.fill_box(number, low=(0, 0, 0), high=(2, 2, 2), solid=False)
    assert client.about()["changed"]
    client.job("open", {"path": str(study), "series": "1.2.4"})
    told = client.about()["told"]
    assert "Your changes are kept: the next start with this scan offers them." in told
    assert client.about()["told"] == []
    # and it does
    client.job("open", {"path": str(study), "series": "1.2.3"})
    opened = client.workbench.opened
    assert opened is not None
    assert opened.journal is not None
    assert opened.journal.offer is not None


# --- files that are dropped ---------------------------------------------------------------


@pytest.mark.parametrize("harm", ["segments.journal", "locked", "looks", "flipped"])
def test_a_damaged_scene_leaves_the_open_scan(
    client: LibraryClient, study: Path, tmp_path: Path, harm: str
) -> None:
    found = client.job("find", {"path": str(study)})[0]
    client.job("open", {"find": found["find"], "choice": 0})
    before = client.workbench.opened
    assert before is not None
    mask = np.ones(before.session.scene.volume.shape, bool)
    before.session.add_segment(before.session.scene.volume.segment(mask, name="all"))
    content = client.ask("POST", "scene", {"view": {}, "copy": True}).content
    with zipfile.ZipFile(BytesIO(content)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
        at = archive.getinfo("segments.journal").header_offset + 60
    if harm == "flipped":
        content = content[:at] + bytes([content[at] ^ 1]) + content[at + 1 :]
    else:
        about = json.loads(parts["scene.json"])
        if harm in about:
            about[harm] = [["no segment"]]
        parts["scene.json"] = json.dumps(about).encode()
        if harm in parts:
            parts[harm] = parts[harm][:-40]
        written = BytesIO()
        with zipfile.ZipFile(written, "w") as archive:
            for name, part in parts.items():
                archive.writestr(name, part)
        content = written.getvalue()
    path = tmp_path / "damaged.palpate"
    path.write_bytes(content)
    told = client.job("open", {"path": str(path)})
    assert told[-1]["kind"] == "failed"
    assert told[-1]["reason"]
    assert "\n" not in told[-1]["reason"]
    # the same session goes on, with its pages
    assert client.workbench.opened is before
    assert before.session.is_running
    assert client.ask("GET", "volume").status_code == 200


def test_the_library_needs_the_token(client: LibraryClient) -> None:
    base = f"http://127.0.0.1:{client.access.port}/api/library"
    for method, route in (("GET", "/"), ("POST", "/find"), ("PUT", "/uploads/1/0")):
        answer = httpx.request(method, base + route, trust_env=False, timeout=PATIENCE)
        assert answer.status_code == 403


@pytest.mark.data
def test_volumes_of_a_servers_series_are_listed_once_they_are_here(
    client: LibraryClient, write_series: Any
) -> None:
    for time in (1, 2):
        folder = write_series(
            "times",
            prefix=f"{time}-",
            uid="1.2.840.77",
            scale=(1.0, 1000.0 * time),
            PatientID="7",
            StudyInstanceUID="1.2.840.7",
            TemporalPositionIdentifier=time,
        )
    with orthanc() as server:
        server.store(folder.iterdir())
        found = client.job("find", {"path": server.dicomweb})[0]
        assert len(found["scans"]) == 1
        told, *pictures, last = client.job("open", {"find": found["find"], "choice": 0})
    assert last == {"kind": "done"}
    assert client.about()["scan"] is None
    assert [one["name"] for one in told["scans"]] == ["abdomen, time 1", "abdomen, time 2"]
    assert {each["choice"] for each in pictures} == {0, 1}
    # the server is gone by now: the files are here
    assert client.job("open", {"find": told["find"], "choice": 1}) == [{"kind": "done"}]
    assert client.about()["scan"] == "abdomen, time 2"
    voxels = np.frombuffer(client.ask("GET", "volume").content, "<i2")
    np.testing.assert_array_equal(voxels, palpate.read(folder, series="2").array.ravel())
    # they belong to that scan now, and go with it
    (failed,) = client.job("open", {"find": told["find"], "choice": 0})
    assert "is gone. Give the files again" in failed["reason"]
    assert client.about()["scan"] == "abdomen, time 2"


@pytest.mark.data
def test_a_series_of_a_server_is_listed_and_opened(
    client: LibraryClient, data_folder: Path
) -> None:
    head, small = (data_folder / "dcmqi_seg" / name for name in ("ct-3slice", "23x38x3/image"))
    with orthanc() as server:
        server.store([*head.iterdir(), *small.iterdir()])
        found, *pictures, last = client.job("find", {"path": server.dicomweb})
        assert last == {"kind": "done"}
        sizes = [tuple(one["size"]) for one in found["scans"]]
        assert set(sizes) == {(512, 512, 3), (23, 38, 3)}
        assert {each["choice"] for each in pictures} == {0, 1}
        wanted = {"find": found["find"], "choice": sizes.index((512, 512, 3))}
        assert client.job("open", wanted) == [{"kind": "done"}]
    voxels = np.frombuffer(client.ask("GET", "volume").content, "<i2").reshape(3, 512, 512)
    np.testing.assert_array_equal(voxels, palpate.read(head).array)
    opened = client.workbench.opened
    assert opened is not None
    assert any("temporary copy" in each for each in opened.session.scene.volume.warnings)
    # its files are not there later: nothing to open again
    assert client.about()["recent"] == []
    # the server is gone by now, and the open scan stays
    (failed,) = client.job("find", {"path": server.dicomweb})
    assert failed["reason"].startswith("no server answers at http://127.0.0.1:")
    (failed,) = client.job("open", wanted)
    assert failed["kind"] == "failed"
    assert client.about()["scan"] == "scan"


def test_a_second_scan_is_shown_with_the_open_one(
    client: LibraryClient, study: Path, tmp_path: Path
) -> None:
    refused = client.job("open", {"path": str(study), "beside": True})
    assert refused[-1]["reason"].startswith("no scan is open")
    found = client.job("find", {"path": str(study)})[0]
    thin = next(i for i, one in enumerate(found["scans"]) if one["name"] == "thin")
    client.job("open", {"find": found["find"], "choice": thin})
    opened = client.workbench.opened
    assert opened is not None
    assert client.job("open", {"find": found["find"], "choice": thin, "beside": True}) == [
        {"kind": "done"}
    ]
    # the same scan is open, with the same segments
    assert client.workbench.opened is opened
    second = opened.session.scene.second
    assert second is not None
    assert second.volume.dimensions == (4, 3, 4)

    # one that was dropped has its files as long as it is shown
    path = tmp_path / "dropped.mha"
    SimpleITK.WriteImage(SimpleITK.Image([5, 6, 7], SimpleITK.sitkInt16), str(path))
    upload = client.upload({"dropped.mha": path.read_bytes()})
    dropped = client.job("find", {"upload": upload})[0]
    client.job("open", {"find": dropped["find"], "beside": True})
    second = opened.session.scene.second
    assert second is not None
    assert (second.volume.dimensions, second.volume.source) == ((5, 6, 7), None)

    scene = tmp_path / "scene.palpate"
    scene.write_bytes(client.ask("POST", "scene", {"view": {}}).content)
    refused = client.job("open", {"path": str(scene), "beside": True})
    assert refused[-1]["reason"].startswith("a scene was chosen")


def test_segments_of_files_are_added_to_the_open_scan(
    client: LibraryClient, study: Path, tmp_path: Path
) -> None:
    volume = palpate.read(study, series="1.2.3")
    labels = np.zeros(volume.shape, np.uint8)
    labels[1:3, :2, 1:], labels[3] = 1, 7
    image = SimpleITK.GetImageFromArray(labels)
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    path = tmp_path / "organs.nii.gz"
    SimpleITK.WriteImage(image, str(path))
    table = b"id,structure\n1,liver\n7,aorta\n"
    (refused,) = client.job("segments", {"path": str(path)})
    assert refused["reason"].startswith("no scan is open")
    client.job("open", {"path": str(study), "series": "1.2.3"})
    opened = client.workbench.opened
    assert opened is not None
    session, shown = opened.session, opened.live.segments
    before = [state["id"] for state in session.segments()]

    def added() -> list[tuple[str, int]]:
        states = [state for state in session.segments() if state["id"] not in before]
        return sorted((shown.name_of(state["id"]), state["voxels"]) for state in states)

    assert client.job("segments", {"path": str(path)}) == [{"kind": "done"}]
    assert added() == [("label 1", 12), ("label 7", 12)]
    for _ in range(2):
        assert session.undo()
    assert added() == []
    # one that was dropped with its table; nothing of it stays
    upload = client.upload({"organs.nii.gz": path.read_bytes(), "organs.csv": table})
    assert client.job("segments", {"upload": upload}) == [{"kind": "done"}]
    assert added() == [("aorta", 12), ("liver", 12)]
    assert client.ask("POST", "library/segments", {"upload": upload}).status_code == 400
    for _ in range(2):
        session.undo()

    image.SetSpacing([2.0 * length for length in volume.spacing])
    SimpleITK.WriteImage(image, str(path))
    (refused,) = client.job("segments", {"path": str(path)})
    assert "lies on another grid than the scan" in refused["reason"]
    assert added() == []
    assert client.job("segments", {"path": str(path), "resample": True}) == [{"kind": "done"}]
    assert [name for name, _ in added()] == ["label 1"]
    wrongs: list[Any] = [{}, {"path": " "}, {"upload": 99}, {"path": str(path), "upload": upload}]
    for wrong in wrongs:
        assert client.ask("POST", "library/segments", wrong).status_code == 400


def test_segments_in_the_place_of_a_scan_are_told_and_added_on_request(
    client: LibraryClient, study: Path, tmp_path: Path
) -> None:
    volume = palpate.read(study, series="1.2.3")
    labels = np.zeros(volume.shape, np.uint8)
    labels[:, :, 2:] = 3
    image = SimpleITK.GetImageFromArray(labels)
    image.SetSpacing(volume.spacing)
    x, y, z = volume.origin
    # less than half a voxel off
    image.SetOrigin((x + 0.4 * volume.spacing[0], y, z))
    path = tmp_path / "liver_mask.nii.gz"
    SimpleITK.WriteImage(image, str(path))
    told = {"kind": "labels", "name": path.name, "what": "a label map", "image": True}
    # nothing is opened unless that is asked
    assert client.job("find", {"path": str(path)}) == [told, {"kind": "done"}]
    assert client.about()["scan"] is None
    found, *_ = client.job("find", {"path": str(path), "taken_as": "scan"})
    assert (found["kind"], len(found["scans"])) == ("found", 1)

    client.job("open", {"path": str(study), "series": "1.2.3"})
    opened = client.workbench.opened
    assert opened is not None
    before = len(opened.session.segments())
    upload = client.upload({path.name: path.read_bytes()})
    assert client.job("find", {"upload": upload})[0] == told
    # it lies elsewhere: what was dropped stays, to be asked for again
    (refused,) = client.job("segments", {"upload": upload})
    assert "another grid" in refused["reason"]
    wanted = {"upload": upload, "resample": True}
    assert client.job("segments", wanted) == [{"kind": "done"}]
    assert len(opened.session.segments()) == before + 1
    assert client.ask("POST", "library/find", {"upload": upload}).status_code == 400
    # in a list beside a scan they are what they are
    image.SetOrigin(volume.origin)
    SimpleITK.WriteImage(image, str(study / path.name))
    listed = client.job("find", {"path": str(study)})[0]
    kinds = [one["labels"] for one in listed["scans"]]
    assert kinds == [None, None, None, "a label map"]
    assert client.job("segments", {"find": listed["find"], "choice": 3}) == [{"kind": "done"}]
    assert len(opened.session.segments()) == before + 2


def test_a_windows_title_names_no_file_that_was_not_given(
    client: LibraryClient, study: Path, write_image: Any
) -> None:
    values = np.full((4, 5, 6), 7, np.int16)
    path: Path = write_image(values, "DOE_JOHN.nrrd")
    folder = path.parent / "found"
    folder.mkdir()
    path.rename(folder / path.name)
    path = folder / path.name

    def title() -> str:
        assert client.workbench.opened is not None
        return client.workbench.opened.session.scene.volume.title

    # dropped, and found in a folder
    upload = client.upload({path.name: path.read_bytes()})
    for place in ({"upload": upload}, {"path": str(folder)}):
        found = client.job("find", place)[0]
        client.job("open", {"find": found["find"], "choice": 0})
        assert (client.about()["scan"], title()) == ("DOE_JOHN", "scan")
    # given by its path, at first and again
    found = client.job("find", {"path": str(path)})[0]
    client.job("open", {"find": found["find"], "choice": 0})
    assert title() == "DOE_JOHN"
    client.job("open", {"path": str(path)})
    assert title() == "DOE_JOHN"
    # what the files themselves say of the scan
    client.job("open", {"path": str(study), "series": "1.2.3"})
    assert title() == "CT thin"


def test_the_demo_is_opened_without_a_file_and_not_remembered(client: LibraryClient) -> None:
    *_, last = client.job("open", {"demo": True})
    assert last == {"kind": "done"}
    opened = client.workbench.opened
    assert opened is not None
    assert [segment.name for segment in opened.session.scene] == ["bone", "liver"]
    assert recent_scans() == []
