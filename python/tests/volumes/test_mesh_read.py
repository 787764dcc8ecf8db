"""Meshes go out and come in, and become voxels."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from palpate import OptionError, Volume
from palpate.base.errors import EmptySegmentError, MeshFormatError
from palpate.cli.commands import run
from palpate.volumes.mesh_read import (
    closed,
    grid_around,
    hole_count,
    object_of_mesh,
    read_mesh,
    segment_of_mesh,
    suitable_spacing,
)
from palpate.volumes.mesh_write import SUFFIXES, write_mesh
from palpate.volumes.surface import Mesh, Surface


def ball(radius: float = 7.0) -> Volume:
    """A scan with a bright ball, turned and of thick slices."""
    z, y, x = np.meshgrid(*[np.arange(24) - 11.5] * 3, indexing="ij")
    inside = x**2 + y**2 + z**2 <= radius**2
    turned = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    return Volume(
        np.where(inside, 1000, 0).astype(np.int16),
        spacing=(0.7, 0.8, 1.5),
        origin=(-30.0, 20.0, 500.0),
        direction=turned,
    )


def mesh_of_ball() -> Mesh:
    return Surface(ball().threshold(500)).mesh()


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_written_is_read_again_in_the_same_place(tmp_path: Path, suffix: str) -> None:
    mesh = mesh_of_ball()
    path = tmp_path / f"ball{suffix}"
    write_mesh(mesh, path)
    again = read_mesh(path)
    assert (again.holes, again.notes) == (0, ())
    assert again.mesh.triangles.shape == mesh.triangles.shape
    offsets = again.mesh.vertices[:, None, :] - mesh.vertices[None, :, :]
    # files have single precision: 3e-5 mm at 500 mm, in GLB before it is turned
    assert np.abs(offsets).max(axis=2).min(axis=1).max() < 1e-3
    assert [one.name for one in tmp_path.iterdir()] == [path.name]


def test_headers_say_frame_and_unit(tmp_path: Path) -> None:
    for suffix in (".stl", ".ply", ".obj"):
        path = tmp_path / f"ball{suffix}"
        write_mesh(mesh_of_ball(), path)
        assert b"SPACE=LPS UNIT=mm" in path.read_bytes()[:400]


def test_the_surface_of_a_ball_encloses_its_voxels_again() -> None:
    volume = ball()
    segment = volume.threshold(500)
    for smoothing in (0, None):
        for source in ("bits", "intensities"):
            mesh = Surface(segment, smoothing=smoothing, source=source).mesh()
            assert hole_count(mesh.triangles) == 0
            file = read_back(mesh)
            again = segment_of_mesh(file, volume)
            np.testing.assert_array_equal(again.mask(), segment.mask())


def read_back(mesh: Mesh) -> Any:
    from palpate.volumes.mesh_read import MeshFile

    return MeshFile(mesh, "ball.stl", hole_count(mesh.triangles))


def test_a_frame_and_a_unit_that_are_not_told_are_asked_for(tmp_path: Path) -> None:
    mesh = mesh_of_ball()
    path = tmp_path / "plain.stl"
    write_mesh(mesh, path)
    content = bytearray(path.read_bytes())
    content[:80] = b" " * 80
    path.write_bytes(content)
    with pytest.raises(OptionError, match="`frame=LPS` or `frame=RAS`"):
        read_mesh(path)
    ras = read_mesh(path, frame="RAS").mesh
    lps = read_mesh(path, frame="LPS").mesh
    np.testing.assert_allclose(ras.vertices * (-1, -1, 1), lps.vertices)

    small = Mesh(mesh.vertices / 1000.0, mesh.normals, mesh.triangles)
    write_mesh(small, path)
    content = bytearray(path.read_bytes())
    content[:80] = b" " * 80
    path.write_bytes(content)
    with pytest.raises(OptionError, match="`unit=m`"):
        read_mesh(path, frame="LPS")
    metres = read_mesh(path, frame="LPS", unit="m").mesh
    # half a thousandth of a mm is what single precision resolves of half a metre
    np.testing.assert_allclose(metres.vertices.min(axis=0), lps.vertices.min(axis=0), atol=1e-3)


def test_what_contradicts_the_header_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "ball.ply"
    write_mesh(mesh_of_ball(), path)
    with pytest.raises(OptionError, match="says LPS"):
        read_mesh(path, frame="RAS")
    with pytest.raises(OptionError, match="says mm"):
        read_mesh(path, unit="m")


def test_a_leaky_mesh_is_reported_with_its_holes_and_voxelised_as_a_shell() -> None:
    mesh = mesh_of_ball()
    top, bottom = mesh.vertices[:, 2].argmax(), mesh.vertices[:, 2].argmin()
    leaky = mesh.triangles[~np.isin(mesh.triangles, [top, bottom]).any(axis=1)]
    assert hole_count(leaky) == 2
    file = read_back(Mesh(mesh.vertices, mesh.normals, leaky))
    volume = grid_around([mesh], 0.5)
    with pytest.raises(MeshFormatError, match=r"2 holes.*`as_shell=True`"):
        segment_of_mesh(file, volume)
    shell = segment_of_mesh(file, volume, as_shell=True)
    solid = segment_of_mesh(read_back(mesh), volume)
    assert 0 < shell.voxel_count < solid.voxel_count

    lidded = closed(file)
    assert (lidded.holes, lidded.notes) == (0, ("2 holes were closed",))
    # the tips of this ball are flat, so nearly nothing is cut off
    share = segment_of_mesh(lidded, volume).voxel_count / solid.voxel_count
    assert 0.95 < share <= 1.0


def test_a_mesh_turned_inside_out_is_turned_and_triangles_without_area_go(tmp_path: Path) -> None:
    mesh = mesh_of_ball()
    flat = np.array([[0, 0, 1], [5, 5, 5]], np.uint32)
    turned = Mesh(mesh.vertices, mesh.normals, np.vstack([mesh.triangles[:, ::-1], flat]))
    path = tmp_path / "ball.ply"
    write_mesh(turned, path)
    again = read_mesh(path)
    assert [note.split()[0] for note in again.notes] == ["2", "it"]
    assert again.holes == 0
    away = again.mesh.vertices - again.mesh.vertices.mean(axis=0)
    assert (np.einsum("ij,ij->i", away, again.mesh.normals) > 0.0).all()


LYING_PLY = (
    b"ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
    b"property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
    b"end_header\n0 0 0\n"
)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("empty.stl", b"", "empty"),
        ("lies.stl", b"\0" * 80 + struct.pack("<I", 10**9) + b"\0" * 100, "1000000000 triangles"),
        ("short.stl", b"\0" * 30, "allowed"),
        ("none.stl", b"\0" * 84, "no triangles|no mesh"),
        ("words.ply", b"these are words", "no mesh"),
        ("lies.ply", LYING_PLY, "allowed"),
        ("words.glb", b"glTF and words, which are no chunks", "no mesh"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", "allowed"),
        ("far.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "allowed"),
        ("nan.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "allowed"),
        ("plane.obj", b"v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "three numbers each"),
        ("flat.obj", b"v 0 0 0\nv 9 0 0\nv 9 0 0\nf 1 2 3\n", "area|no triangles"),
        ("mesh.xyz", b"0 0 0", "allowed: a file with .stl"),
    ],
)  # fmt: skip
def test_damaged_and_lying_files_give_one_clear_error(
    tmp_path: Path, name: str, content: bytes, said: str
) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(MeshFormatError, match=said):
        read_mesh(path, frame="LPS", unit="mm")


def plate(thickness: float) -> Mesh:
    """A plate of 20 x 12 mm, thin along z."""
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)], np.float64)
    sides = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = [triple for a, b, c, d in sides for triple in ((a, b, c), (a, c, d))]
    vertices = corners * [20.0, 12.0, thickness] + [3.1, -4.3, 500.7]
    return Mesh(vertices, np.zeros_like(vertices, np.float32), np.array(triangles, np.uint32))


@pytest.mark.parametrize("thickness", [0.6, 1.5, 8.0])
def test_a_mesh_gets_voxels_fine_enough_for_its_thickness(thickness: float) -> None:
    file = read_back(plate(thickness))
    spacing = suitable_spacing(file.mesh, ball())
    # at least four along the thickness, less where its edges take a share, and as the scan's
    assert thickness / 5.5 < spacing <= min(0.7, thickness / 4.0) or spacing == pytest.approx(0.7)
    segment = object_of_mesh(file, spacing)
    assert segment.has_own_grid
    # edges are right to half a voxel on each side
    assert segment.volume_ml == pytest.approx(20.0 * 12.0 * thickness / 1000.0, rel=0.15)
    # voxels begin at the mesh's corner: three of a third are just its thickness
    layers = object_of_mesh(file, thickness / 3.0).mask().any(axis=(1, 2))
    assert layers.sum() == 3
    with pytest.raises(OptionError, match="1073741824"):
        object_of_mesh(file, 0.001)


def test_parts_of_a_mesh_that_run_into_one_another_are_one_solid() -> None:
    one = mesh_of_ball()
    shift = np.array([4.0, 0.0, 0.0])
    both = Mesh(
        np.vstack([one.vertices, one.vertices + shift]),
        np.vstack([one.normals, one.normals]),
        np.vstack([one.triangles, one.triangles + len(one.vertices)]).astype(np.uint32),
    )
    grid = grid_around([both], 0.5)
    parts = [
        segment_of_mesh(read_back(Mesh(one.vertices + by, one.normals, one.triangles)), grid).mask()
        for by in (0.0 * shift, shift)
    ]
    made = segment_of_mesh(read_back(both), grid).mask()
    np.testing.assert_array_equal(made, parts[0] | parts[1])
    assert (parts[0] & parts[1]).any()


def test_a_mesh_far_from_the_scan_encloses_nothing() -> None:
    mesh = mesh_of_ball()
    far = Mesh(mesh.vertices + 1000.0, mesh.normals, mesh.triangles)
    with pytest.raises(EmptySegmentError, match="within the scan"):
        segment_of_mesh(read_back(far), ball())
    for spacing in (0.0, -1.0, float("nan"), 1e-5):
        with pytest.raises(OptionError, match="spacing"):
            grid_around([mesh], spacing)


def test_a_failed_export_leaves_no_partial_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "ball.stl"
    path.write_bytes(b"what was there")

    def full(_self: Path, _target: Path) -> Path:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(OSError, match="No space"):
        write_mesh(mesh_of_ball(), path)
    assert [one.name for one in tmp_path.iterdir()] == ["ball.stl"]
    assert path.read_bytes() == b"what was there"


def test_the_command_exports_a_surface_and_makes_voxels_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from palpate.base.simpleitk import simpleitk

    volume = ball()
    sitk = simpleitk()
    image = sitk.GetImageFromArray(volume.array)
    image.SetSpacing(volume.spacing)
    image.SetOrigin(volume.origin)
    image.SetDirection(volume.direction.ravel().tolist())
    scan, mesh, labels = (str(tmp_path / name) for name in ("ball.mha", "ball.glb", "ball.nrrd"))
    sitk.WriteImage(image, scan)
    assert run(["surface", "export", scan, mesh, "--threshold", "500"]) == 0
    assert run(["surface", "voxels", mesh, labels, "--like", scan]) == 0
    made = sitk.GetArrayFromImage(sitk.ReadImage(labels))
    np.testing.assert_array_equal(made, (volume.array > 0).astype(made.dtype))
    assert "triangles" in capsys.readouterr().out

    new = str(tmp_path / "new.glb")
    Path(labels).unlink()
    for arguments, said in (
        (["export", scan, str(tmp_path / "ball.xyz")], ".stl, .ply, .obj, .glb"),
        (["export", scan, str(tmp_path / "none" / "ball.stl")], "exists"),
        (["export", scan, new, "--threshold", "500", "--segment", "liver"], "threshold"),
        (["export", scan, new, "--threshold", "500", "--smoothing", "99"], "0 to 12"),
        (["voxels", mesh, labels], "--spacing"),
        (["voxels", mesh, labels, "--spacing", "1", "--frame", "up"], "LPS, RAS"),
    ):
        assert run(["surface", *arguments]) == 2
        assert said in capsys.readouterr().err


# --- real meshes ---------------------------------------------------------------------------


def distances_to(mesh: Mesh, points: NDArray[np.float64], reach: float) -> NDArray[np.float64]:
    """Distance of each point to the triangles within reach [mm]; infinite where there are none."""
    corners = mesh.vertices[mesh.triangles]
    low, high = corners.min(axis=1) - reach, corners.max(axis=1) + reach
    found = np.full(len(points), np.inf)
    for number, point in enumerate(points):
        near = corners[((low <= point) & (point <= high)).all(axis=1)]
        if len(near):
            found[number] = point_to_triangles(point, near)
    return found


def point_to_triangles(point: NDArray[np.float64], corners: NDArray[np.float64]) -> float:
    """Least distance to triangles, shape [n, 3, 3]."""
    best = np.inf
    for i in range(3):
        a, b = corners[:, i], corners[:, (i + 1) % 3]
        along = b - a
        squares = np.maximum(np.einsum("ij,ij->i", along, along), 1e-30)
        share = np.clip(np.einsum("ij,ij->i", point - a, along) / squares, 0.0, 1.0)
        best = min(best, float(np.linalg.norm(a + share[:, None] * along - point, axis=1).min()))
    a, b, c = corners.transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        units = normals / lengths[:, None]
        inside = np.all(
            [
                np.einsum("ij,ij->i", np.cross(to - start, point - start), units) >= 0.0
                for start, to in ((a, b), (b, c), (c, a))
            ],
            axis=0,
        )
        heights = np.abs(np.einsum("ij,ij->i", point - a, units))
    return min(best, float(heights[inside].min())) if inside.any() else best


@pytest.mark.data
@pytest.mark.parametrize(
    ("name", "unit", "spacing"),
    [
        ("myosim_bones/l_femur.stl", "m", 1.0),
        ("myosim_bones/lumbar3.stl", "m", 0.5),
        ("myosim_bones/sacrum.stl", "m", 1.0),
        ("myosim_bones/ribcage_s.stl", "m", 1.5),
        pytest.param("amos_0336/derived_pelvis_bone_170HU.stl", "mm", 1.0, marks=pytest.mark.long),
    ],
)
def test_a_bone_comes_back_from_its_voxels_within_half_a_voxel(
    data_folder: Path, name: str, unit: Any, spacing: float
) -> None:
    # the pelvis ends open where the scan does
    file = closed(read_mesh(data_folder / name, frame="LPS", unit=unit))
    volume = grid_around([file.mesh], spacing)
    segment = segment_of_mesh(file, volume)
    picked = np.random.default_rng(3)
    for smoothing in (0, None):
        again = Surface(segment, smoothing=smoothing).mesh()
        points = again.vertices[picked.integers(0, len(again.vertices), 1500)]
        far = distances_to(file.mesh, points, 1.01 * spacing)
        if smoothing == 0:
            # every vertex is a corner of a face that the mesh passes from voxel to voxel
            assert far.max() <= np.sqrt(0.75) * spacing * (1.0 + 1e-3)
        else:
            # a smoothed one keeps to its edge, yet sharp rims are rounded
            assert np.quantile(far, 0.99) <= 0.5 * spacing
            assert far.max() <= spacing


@pytest.mark.data
def test_open_bones_tell_their_holes(data_folder: Path) -> None:
    file = read_mesh(data_folder / "myosim_bones" / "l_pelvis.stl", frame="LPS", unit="m")
    assert file.holes > 0
    assert any("hole" in note for note in file.notes)
    volume = grid_around([file.mesh], 1.0)
    assert segment_of_mesh(file, volume, as_shell=True).voxel_count > 1000


@pytest.mark.parametrize("lines", ["v 0 0\n" * 3, "v 1\n" * 3, "v 0 0 0\nv 1 0\nv 0 1 0\n"])
def test_vertices_have_three_coordinates(tmp_path: Path, lines: str) -> None:
    path = tmp_path / "flat.obj"
    path.write_text(f"{lines}f 1 2 3\n", "ascii")
    with pytest.raises(MeshFormatError, match=r"flat\.obj.*allowed"):
        read_mesh(path, frame="LPS", unit="mm")
