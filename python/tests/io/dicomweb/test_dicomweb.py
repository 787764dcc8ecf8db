"""Scans of a DICOMweb server: a real one, and ones that answer what they should not."""

from __future__ import annotations

import gc
import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np
import palpate
import pytest
from orthanc import Orthanc, orthanc
from palpate.base.errors import DicomWebError, OptionError, SeriesChoiceError
from palpate.cli.commands import run
from palpate.io.browse import previews
from palpate.io.browse_web import browsed_web
from palpate.io.dicomweb import series as io_dicomweb
from palpate.io.dicomweb.address import WebAddress
from palpate.io.dicomweb.series import choose_remote, fetch_series, remote_series
from pydicom import dcmread

# --- addresses --------------------------------------------------------------------------


def test_an_address_says_what_is_meant_and_hides_what_is_secret() -> None:
    given = "https://ann:p%40ss@host:8042/dicom-web/studies/1.2/series/3.4/?PatientName=Doe*"
    address = WebAddress.of(given)
    assert address.service == str(address) == "https://host:8042/dicom-web"
    assert (address.study, address.series) == ("1.2", "3.4")
    assert address.login == ("ann", "p@ss")
    assert address.filters == (("PatientName", "Doe*"),)
    assert not address.local
    assert "p@ss" not in repr(address)
    assert "Doe" not in repr(address)
    assert WebAddress.of("http://[::1]:80/x", study="7").service == "http://[::1]:80/x"


@pytest.mark.parametrize(
    "given",
    ["", "/folder", "ftp://ann:secret@host/x", "http://", "http://host:port/x", "http://[x"],
)
def test_what_is_no_address_is_refused(given: str) -> None:
    with pytest.raises(OptionError, match="allowed: that of a DICOMweb service") as caught:
        WebAddress.of(given)
    assert "secret" not in str(caught.value)


def test_a_uid_that_leads_elsewhere_is_refused() -> None:
    with pytest.raises(OptionError, match="allowed: digits and dots"):
        WebAddress.of("http://host", study="1.2/../3")


RUN_LENGTHS = Path("pydicom_transfer_syntaxes", "emri_small_RLE.dcm")

# --- a real server ----------------------------------------------------------------------


@pytest.fixture(scope="module")
def server(data_folder: Path) -> Iterator[Orthanc]:
    """Orthanc with two series of CT, the segmentation of one, and frames of MR in one file."""
    data = data_folder / "dcmqi_seg"
    with orthanc() as started:
        started.store((data / "ct-3slice").iterdir())
        started.store((data / "23x38x3" / "image").iterdir())
        started.store([data / "liver.dcm", data_folder / RUN_LENGTHS])
        yield started


@pytest.mark.data
def test_a_series_of_a_server_is_read_as_its_files_are(
    server: Orthanc, data_folder: Path, tmp_path: Path
) -> None:
    files = data_folder / "dcmqi_seg" / "ct-3slice"
    expected = palpate.read(files)
    address = WebAddress.of(server.dicomweb)
    listed = remote_series(address)
    # segmentations refer to a scan and are none
    assert [one.modality for one in listed].count("CT") == 2
    assert "SEG" not in {one.modality for one in listed}
    one = next(each for each in listed if each.uid == expected.traits.series)
    assert (one.size, one.files, one.bytes) == ((512, 512, 3), 3, 512 * 512 * 3 * 2)
    assert "JANCT000" in one.patient

    said: list[str] = []
    fetched = fetch_series(address, one, tmp_path, progress=lambda what, _: said.append(what))
    assert fetched == 3
    assert "fetching 3 files, 2 MiB before compression" in said
    scan = palpate.read(tmp_path)
    np.testing.assert_array_equal(scan.array, expected.array)
    np.testing.assert_array_equal(scan.patient_from_grid, expected.patient_from_grid)
    assert (scan.unit, scan.traits.series) == ("HU", one.uid)


@pytest.mark.data
def test_frames_of_one_file_come_as_they_are_stored(
    server: Orthanc, data_folder: Path, tmp_path: Path
) -> None:
    address = WebAddress.of(server.dicomweb)
    one = next(each for each in remote_series(address) if each.modality == "MR")
    assert (one.files, one.size) == (1, (64, 64, 10))
    assert fetch_series(address, one, tmp_path) == 1
    (path,) = tmp_path.iterdir()
    # compressed on its way too
    assert dcmread(path).file_meta.TransferSyntaxUID == "1.2.840.10008.1.2.5"
    np.testing.assert_array_equal(
        palpate.read(tmp_path).array, palpate.read(data_folder / RUN_LENGTHS).array
    )


@pytest.mark.data
def test_the_command_lists_and_brings(
    server: Orthanc, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["import", "--dicomweb", server.dicomweb, "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert len(listed) > 1
    out = tmp_path / "ct"
    wanted = ["import", "--dicomweb", server.dicomweb, "-o", str(out)]
    assert run(wanted) == 2
    assert "allowed: one, with --series" in capsys.readouterr().err
    assert not out.exists()
    number = next(one["number"] for one in listed if one["slices"] == 3 and one["rows"] == 512)
    assert run([*wanted, "--series", str(number)]) == 0
    assert f"palpate open {out} shows them" in capsys.readouterr().out
    assert palpate.read(out).dimensions == (512, 512, 3)
    assert list(tmp_path.iterdir()) == [out]
    # the list for people names the same series
    assert run(["import", "--dicomweb", server.dicomweb]) == 0
    assert "512 x 512 x 3" in capsys.readouterr().out
    study = listed[number - 1]["study_uid"]
    assert run(["import", "--dicomweb", server.dicomweb, "--study", study, "--json"]) == 0
    assert {one["study_uid"] for one in json.loads(capsys.readouterr().out)} == {study}


@pytest.mark.data
def test_the_command_writes_a_series_as_one_file(
    server: Orthanc, data_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    expected = palpate.read(data_folder / "dcmqi_seg" / "ct-3slice")
    out = tmp_path / "ct.nii.gz"
    wanted = ["import", "--dicomweb", server.dicomweb, "--series", expected.traits.series]
    assert run([*wanted, "-o", str(out), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["dimensions"], told["unit"]) == ([512, 512, 3], "HU")
    assert [each["file"] for each in told["written"]] == [str(out)]
    np.testing.assert_array_equal(palpate.read(out).array, expected.array)
    assert list(tmp_path.iterdir()) == [out]


def times_on(server: Orthanc, write_series: Any) -> None:
    """Stores a series of two times."""
    for time in (1, 2):
        folder = write_series(
            "times",
            uid="1.2.840.77",
            prefix=f"{time}-",
            description="heart",
            scale=(1.0, 1000.0 * time),
            Modality="PT",
            PatientID="7",
            StudyInstanceUID="1.2.840.7",
            TemporalPositionIdentifier=time,
        )
    server.store(folder.iterdir())


@pytest.mark.data
def test_one_of_several_volumes_of_a_series_is_chosen(
    server: Orthanc, write_series: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    times_on(server, write_series)
    out = tmp_path / "heart.nrrd"
    wanted = ["import", "--dicomweb", server.dicomweb, "--series", "1.2.840.77"]
    assert run([*wanted, "-o", str(out)]) == 2
    assert (
        "series 1.2.840.77 holds 2 volumes; choose one with --volume NUMBER: [1] heart, time 1; "
        "[2] heart, time 2" in capsys.readouterr().err
    )
    assert run([*wanted, "-o", str(out), "--volume", "3"]) == 2
    assert "holds 2 volumes, and none is '3'" in capsys.readouterr().err
    assert not out.exists()
    assert run([*wanted, "-o", str(out), "--volume", "2"]) == 0
    assert palpate.read(out).array.min() == 2000
    capsys.readouterr()
    # all of them come into a folder, which is then like any other
    folder = tmp_path / "heart"
    assert run([*wanted, "-o", str(folder)]) == 0
    assert f"palpate import {folder} lists their 2 volumes" in capsys.readouterr().out
    assert run(["import", str(folder), "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert [one["series"] for one in listed] == ["heart, time 1", "heart, time 2"]


@pytest.mark.data
def test_a_search_in_the_address_narrows_the_list(server: Orthanc) -> None:
    everything = remote_series(WebAddress.of(server.dicomweb))
    uid = everything[0].uid
    found = remote_series(WebAddress.of(f"{server.dicomweb}/studies?SeriesInstanceUID={uid}"))
    assert [one.uid for one in found] == [uid]
    with pytest.raises(DicomWebError, match="has no series that fit"):
        remote_series(WebAddress.of(f"{server.dicomweb}?PatientID=nobody"))


@pytest.mark.data
def test_series_of_a_server_can_be_chosen_by_their_pictures(server: Orthanc) -> None:
    with browsed_web(server.dicomweb) as choices:
        drawn = dict(previews(choices))
        assert len(drawn) == len(choices)
        head = next(n for n, one in enumerate(choices) if one.size == (512, 512, 3))
        assert (drawn[head].shape, drawn[head].max()) == ((96, 96), 255)


@pytest.mark.data
def test_what_is_cancelled_leaves_nothing_on_its_way(server: Orthanc, tmp_path: Path) -> None:
    class LeftError(Exception):
        """Somebody has left."""

    def leave(what: str, _: float | None) -> None:
        if what.startswith("fetching"):
            raise LeftError

    address = WebAddress.of(server.dicomweb)
    with pytest.raises(LeftError):
        fetch_series(address, remote_series(address)[0], tmp_path, progress=leave)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.data
def test_more_than_is_allowed_is_refused(
    server: Orthanc, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    address = WebAddress.of(server.dicomweb)
    one = max(remote_series(address), key=lambda each: each.bytes or 0)
    monkeypatch.setattr(io_dicomweb, "MOST_BYTES", 2**20)
    with pytest.raises(DicomWebError, match="the series has 2 MiB; allowed: at most 1 MiB"):
        fetch_series(address, one, tmp_path)
    # a server that does not tell is stopped on the way
    monkeypatch.setattr(io_dicomweb, "_room_for", lambda *_: None)
    with pytest.raises(DicomWebError, match="the server sends more than 1 MiB"):
        fetch_series(address, one, tmp_path)


@pytest.mark.data
def test_who_has_no_password_is_told_how_to_give_it() -> None:
    with orthanc(login=("ann", "secret")) as closed:
        plain = WebAddress.of(closed.dicomweb)
        with pytest.raises(DicomWebError, match=r"refuses access with no name \(401\); allowed"):
            remote_series(plain)
        given = closed.dicomweb.replace("http://", "http://ann:secret@")
        with pytest.raises(DicomWebError, match="has no series that fit"):
            remote_series(WebAddress.of(given))
        wrong = WebAddress.of(given.replace("secret", "guess"))
        with pytest.raises(DicomWebError, match="this name and password") as caught:
            remote_series(wrong)
        assert "guess" not in str(caught.value)


# --- servers that are none --------------------------------------------------------------

Answer = Callable[[str], tuple[int, str, bytes]]


@contextmanager
def answering(answer: Answer) -> Iterator[str]:
    """Runs a server with these answers to paths: status, type and body; gives its address."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            try:
                status, kind, body = answer(self.path)
            except ConnectionAbortedError:
                # hangs up without a word
                self.close_connection = True
                return
            self.send_response(status)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(body)))
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_: Any) -> None:
            """Says nothing."""

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}/web"
        server.shutdown()


SERIES = {
    "0020000D": {"vr": "UI", "Value": ["1.2"]},
    "0020000E": {"vr": "UI", "Value": ["1.2.3"]},
    "00100010": {"vr": "PN", "Value": [{"Alphabetic": "Quixote^Alonso"}]},
    "00080060": {"vr": "CS", "Value": ["CT"]},
    "00201209": {"vr": "IS", "Value": [2]},
}


def test_a_port_where_nobody_answers_is_told() -> None:
    with answering(lambda _: (200, "text/html", b"")) as gone:
        pass
    with pytest.raises(DicomWebError, match=r"no server answers at .*; allowed: the address of"):
        remote_series(WebAddress.of(gone))


def test_a_server_that_hangs_up_once_is_asked_again() -> None:
    asked: list[str] = []

    def answer(path: str) -> tuple[int, str, bytes]:
        asked.append(path)
        if len(asked) == 1:
            raise ConnectionAbortedError
        return 200, "application/json", b"[]"

    with (
        answering(answer) as address,
        pytest.raises(DicomWebError, match="has no series that fit"),
    ):
        remote_series(WebAddress.of(address))
    assert len(asked) == 2
    assert asked[0] == asked[1]


@pytest.mark.parametrize(
    ("status", "body", "said"),
    [
        (404, b"", r"has no such resource \(404\)"),
        (403, b"Quixote", r"refuses access"),
        (500, b"Quixote", r"fails by itself \(500\)"),
        (400, b"Quixote", r"refuses what it was asked \(400\)"),
        (200, b"<html>Quixote</html>", "answers, but not as DICOMweb"),
        (200, b'{"found": ["Quixote"]}', "answers, but not as DICOMweb"),
        (200, b'["Quixote"]', "answers, but not as DICOMweb"),
        (200, b'[{"0020000E": {"Value": ["../Quixote"]}}]', "answers, but not as DICOMweb"),
        (200, b"[]", "has no series that fit"),
        (200, b"", "has no series that fit"),
        (204, b"", "has no series that fit"),
    ],
)
def test_what_is_no_dicomweb_is_told_without_the_servers_words(
    status: int, body: bytes, said: str
) -> None:
    with (
        answering(lambda _: (status, "text/html", body)) as address,
        pytest.raises(DicomWebError, match=said) as caught,
    ):
        remote_series(WebAddress.of(address))
    assert "Quixote" not in str(caught.value)


def test_endless_lists_are_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(io_dicomweb, "MOST_LIST_BYTES", 2**20)
    with (
        answering(lambda _: (200, "application/json", b" " * 2**24 + b"[]")) as address,
        pytest.raises(DicomWebError, match="sends more than 1 MiB"),
    ):
        remote_series(WebAddress.of(address))
    # Python warns here of a connection that was left open, and pytest fails of it
    gc.collect()


def test_files_of_others_and_files_that_are_none_are_refused(
    write_series: Any, tmp_path: Path
) -> None:
    other = next(write_series(uid="1.2.9").iterdir()).read_bytes()
    sent = {"body": other}
    lists = json.dumps([SERIES | {"00080018": {"vr": "UI", "Value": ["1.2.3.4"]}}]).encode()

    def answer(path: str) -> tuple[int, str, bytes]:
        if "/instances/" in path:
            return 200, "application/dicom", sent["body"]
        return 200, "application/dicom+json", lists

    with answering(answer) as given:
        address = WebAddress.of(given)
        one = choose_remote(address, remote_series(address), None)
        target = tmp_path / "fetched"
        target.mkdir()
        with pytest.raises(DicomWebError, match="sends a file of another series"):
            fetch_series(address, one, target)
        sent["body"] = b"no DICOM at all"
        with pytest.raises(DicomWebError, match="answers, but not as DICOMweb"):
            fetch_series(address, one, target)
        # a server that repeats its list for ever has one file
        sent["body"] = next(write_series("own", uid="1.2.3").iterdir()).read_bytes()
        assert fetch_series(address, one, target) == 1


def test_one_of_several_has_to_be_named() -> None:
    address = WebAddress.of("http://host/web")
    two = [io_dicomweb.RemoteSeries(study="1", uid=f"1.{n}", description=f"d{n}") for n in (5, 6)]
    for wanted in ("1.6", "d6", "2"):
        assert choose_remote(address, two, wanted) is two[1]
    for wrong in (None, "3", "d"):
        with pytest.raises(SeriesChoiceError, match="allowed: one, with `series="):
            choose_remote(address, two, wrong)
