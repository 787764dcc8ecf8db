"""The last autosave of a scene whose file is damaged is found, on both ways of opening it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import SimpleITK
from palpate.base.errors import SceneFormatError
from palpate.base.progress import silent
from palpate.cli.scenes import saved_scene
from palpate.io.reading import read
from palpate.saved.autosave import autosave_of, note_scene
from palpate.saved.journal import Journal
from palpate.saved.scene_file import save_scene
from palpate.session.session import Session, SessionOptions
from palpate.volumes.scene import Scene
from running_server import LibraryClient


def cut(content: bytes) -> bytes:
    """Only the first half has come."""
    return content[: len(content) // 2]


def flipped(content: bytes) -> bytes:
    """Bytes in the middle are others."""
    middle = len(content) // 2
    return (
        content[:middle]
        + bytes(each ^ 0x55 for each in content[middle:][:64])
        + content[middle + 64 :]
    )


def emptied(_: bytes) -> bytes:
    """Nothing is left."""
    return b""


DAMAGES = pytest.mark.parametrize("damage", [cut, flipped, emptied])
Damage = Callable[[bytes], bytes]


@pytest.fixture
def scan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scan of noise, and a state of its own."""
    monkeypatch.setenv("PALPATE_STATE", str(tmp_path / "state"))
    values = np.random.default_rng(3).integers(-1000, 2000, (10, 12, 14), np.int16)
    path = tmp_path / "noise.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(path))
    return path


def saved(scan: Path, path: Path, *, passing: bool = False) -> None:
    """Saves a scene with a segment, and leaves the journal of its session."""
    session = Session(Scene(read(scan)), options=SessionOptions(real_time=False))
    journal = Journal(session, tell=lambda _: None)
    journal.start()
    mask = np.ones(session.scene.volume.shape, np.uint8)
    session.add_segment(session.scene.volume.segment(mask, name="all"))
    session.run(0.01)
    note_scene(save_scene(path, session), path, passing=passing)
    session.stop()
    journal.close()


@DAMAGES
def test_the_command_line_names_how_the_autosave_is_opened(
    scan: Path, tmp_path: Path, damage: Damage
) -> None:
    path = tmp_path / "scene.palpate"
    saved(scan, path)
    path.write_bytes(damage(path.read_bytes()))
    with pytest.raises(SceneFormatError, match=r"damaged.*; the last autosave of") as told:
        saved_scene(path, silent)
    assert f"palpate open {scan} --recover" in str(told.value)


def test_a_scene_that_a_page_has_saved_is_found_by_its_name(scan: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.palpate"
    saved(scan, path, passing=True)
    downloads = tmp_path / "downloads"
    downloads.mkdir()
    for name in ("scene.palpate", "scene(1).palpate", "scene (2).palpate"):
        (downloads / name).write_bytes(b"")
        kept = autosave_of(downloads / name)
        assert kept is not None
        assert kept.place == scan
    (downloads / "other.palpate").write_bytes(b"")
    assert autosave_of(downloads / "other.palpate") is None


def test_a_scene_elsewhere_of_the_same_name_is_not_taken_for_this_one(
    scan: Path, tmp_path: Path
) -> None:
    path = tmp_path / "scene.palpate"
    saved(scan, path)
    values = np.zeros((4, 5, 6), np.int16)
    other = tmp_path / "other.mha"
    SimpleITK.WriteImage(SimpleITK.GetImageFromArray(values), str(other))
    (tmp_path / "folder").mkdir()
    saved(other, tmp_path / "folder" / "scene.palpate")
    path.write_bytes(b"")
    kept = autosave_of(path)
    assert kept is not None
    assert kept.place == scan


def test_without_an_autosave_only_the_reason_is_told(scan: Path, tmp_path: Path) -> None:
    path = tmp_path / "scene.palpate"
    with Session(Scene(read(scan)), options=SessionOptions(real_time=False)) as session:
        note_scene(save_scene(path, session), path)
    path.write_bytes(b"")
    with pytest.raises(SceneFormatError) as told:
        saved_scene(path, silent)
    assert "last autosave" not in str(told.value)


@DAMAGES
def test_a_page_is_offered_the_autosave_and_opens_it(
    scan: Path, tmp_path: Path, client: LibraryClient, damage: Damage
) -> None:
    path = tmp_path / "scene.palpate"
    saved(scan, path)
    path.write_bytes(damage(path.read_bytes()))
    offer, failed = client.job("open", {"path": str(path)})
    assert "damaged" in failed["reason"]
    assert (offer["kind"], offer["scan"]) == ("autosave", "noise")
    client.job("open", {"find": offer["find"]})
    opened = client.workbench.opened
    assert opened is not None
    assert opened.name == "noise"
    assert [each["voxels"] for each in opened.session.segments()][-1] == 10 * 12 * 14
    # undo still leads back to before it
    assert opened.session.undo()


def test_a_damaged_scene_leaves_the_open_scan_as_it_is(
    scan: Path, tmp_path: Path, client: LibraryClient
) -> None:
    path = tmp_path / "scene.palpate"
    saved(scan, path)
    path.write_bytes(flipped(path.read_bytes()))
    client.job("open", {"path": str(scan)})
    before = client.workbench.opened
    assert client.job("open", {"path": str(path)})[-1]["kind"] == "failed"
    assert client.workbench.opened is before


def test_a_dropped_scene_without_content_is_found_by_its_name(
    scan: Path, tmp_path: Path, client: LibraryClient
) -> None:
    saved(scan, tmp_path / "scene.palpate", passing=True)
    upload = client.upload({"scene.palpate": b""})
    found = client.job("find", {"upload": upload})[0]
    offer, failed = client.job("open", {"find": found["find"]})
    assert "no scene file, or a damaged one" in failed["reason"]
    assert offer["find"] is not None


def test_an_autosave_whose_scan_is_gone_is_told_without_a_way_to_open_it(
    scan: Path, tmp_path: Path, client: LibraryClient
) -> None:
    path = tmp_path / "scene.palpate"
    saved(scan, path)
    path.write_bytes(b"")
    scan.unlink()
    offer, _ = client.job("open", {"path": str(path)})
    assert offer["find"] is None
    with pytest.raises(SceneFormatError, match="once its scan 'noise' is opened again"):
        saved_scene(path, silent)
