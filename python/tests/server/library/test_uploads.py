"""Files that a page drops: they are listed, opened, bounded, and gone with their scan."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import pytest
from palpate.server.library import upload as server_upload
from running_server import LibraryClient


def files_of(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder.parent).as_posix(): path.read_bytes() for path in folder.iterdir()
    }


def test_a_dropped_folder_is_listed_opened_and_gone_with_its_scan(
    client: LibraryClient, study: Path, tmp_path: Path
) -> None:
    upload = client.upload(files_of(study))
    found = client.job("find", {"upload": upload})[0]
    number = [one["name"] for one in found["scans"]].index("thick")
    client.job("open", {"find": found["find"], "choice": number})
    about = client.about()
    assert about["scan"] == "thick"
    # nothing that is gone soon is offered later
    assert about["recent"] == []
    # a scene holds the scan, since there is no place to find it at
    scene = client.ask("POST", "scene", {"view": {}, "copy": False})
    (tmp_path / "kept.palpate").write_bytes(scene.content)
    with zipfile.ZipFile(tmp_path / "kept.palpate") as archive:
        assert "scan.i16" in archive.namelist()
    opened = client.workbench.opened
    assert opened is not None
    assert opened.files is not None
    assert "temporary copy" in opened.session.scene.volume.warnings[-1]
    folder = Path(opened.files.name)
    assert folder.is_dir()
    client.job("open", {"path": str(study), "series": "1.2.3"})
    assert not folder.exists()


@pytest.mark.parametrize(
    "kind", ["head.nii.gz", "head.mhd", "head.nrrd", "study.zip", "one.palpate"]
)
def test_files_of_each_kind_can_be_dropped(
    client: LibraryClient,
    write_image: Any,
    study: Path,
    tmp_path: Path,
    small_values: Any,
    kind: str,
) -> None:
    if kind == "study.zip":
        with zipfile.ZipFile(tmp_path / kind, "w") as archive:
            for name, content in files_of(study).items():
                archive.writestr(name, content)
        paths = [tmp_path / kind]
    elif kind == "one.palpate":
        client.job("open", {"path": str(write_image(small_values))})
        scene = client.ask("POST", "scene", {"view": {}, "copy": True})
        (tmp_path / kind).write_bytes(scene.content)
        paths = [tmp_path / kind]
    else:
        path = write_image(small_values, kind)
        paths = [path, *([path.with_suffix(".raw")] if kind.endswith(".mhd") else [])]
    upload = client.upload({path.name: path.read_bytes() for path in paths})
    found, *_, done = client.job("find", {"upload": upload})
    assert done == {"kind": "done"}
    assert len(found["scans"]) == (3 if kind == "study.zip" else 1)
    assert client.job("open", {"find": found["find"], "choice": 0}) == [{"kind": "done"}]


@pytest.mark.parametrize(
    "name",
    ["../out", "a/../../out", "/etc/passwd", "a\\..\\b", "c:x", "", ".", "..", "a\n", "x" * 256],
)
def test_no_name_leads_out_of_the_upload(client: LibraryClient, name: str) -> None:
    answer = client.ask("POST", "library/uploads", [{"name": name, "size": 1}])
    assert answer.status_code == 400
    assert "leads elsewhere" in answer.text


def test_uploads_are_bounded(client: LibraryClient, monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(*files: tuple[str, int]) -> str:
        told = [{"name": name, "size": size} for name, size in files]
        return client.ask("POST", "library/uploads", told).text

    assert "17.0 GiB cannot be used. Use at most 16 GiB" in asked(("big", 17 << 30))
    assert "less than nothing" in asked(("a", -1))
    assert "two files have one name" in asked(("a", 1), ("A", 1))
    assert "0 files cannot be used" in asked()
    monkeypatch.setattr(server_upload, "SPARE", 1 << 60)
    assert "Use 0 MiB" in asked(("a", 1))


def test_a_file_brings_as_many_bytes_as_were_told(client: LibraryClient) -> None:
    told = [{"name": "a", "size": 3}, {"name": "b", "size": 2}]
    number = client.ask("POST", "library/uploads", told).json()["upload"]
    place = f"library/uploads/{number}"
    assert "more than the 3 bytes" in client.ask("PUT", f"{place}/0", b"abcd").text
    assert "2 of 3 bytes" in client.ask("PUT", f"{place}/0", b"ab").text
    assert client.ask("PUT", f"{place}/0", b"abc").status_code == 204
    assert "not waited for" in client.ask("PUT", f"{place}/0", b"abc").text
    assert "not waited for" in client.ask("PUT", f"{place}/7", b"").text
    answer = client.ask("POST", "library/find", {"upload": number})
    assert "1 files have not come" in answer.text
    assert client.ask("DELETE", place).status_code == 204
    assert "is gone" in client.ask("PUT", f"{place}/1", b"ab").text


def test_a_dropped_bomb_is_refused(client: LibraryClient, tmp_path: Path) -> None:
    path = tmp_path / "bomb.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("zeros", bytes(50 << 20))
    (failed,) = client.job("find", {"upload": client.upload({"bomb.zip": path.read_bytes()})})
    assert "Use at most 200 times" in failed["reason"]
