"""The checks of the arrows between layers find what they are for."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from check_arrows import FLOORS, FOLDERS, wrong_arrows, wrong_folder_arrows

ROOT = Path(__file__).parent.parent
TOOLS = Path(sys.executable).parent


def crates(*arrows: tuple[str, str], kind: str | None = None) -> dict[str, Any]:
    """Returns what cargo would say of the project's crates with these dependencies only."""
    names = [*FLOORS, "palpate-benches"]
    return {
        "packages": [
            {
                "name": name,
                "dependencies": [
                    {"name": target, "kind": kind} for source, target in arrows if source == name
                ],
            }
            for name in names
        ]
    }


@pytest.mark.parametrize(
    "arrow",
    [
        ("palpate-volume", "palpate-haptics"),
        ("palpate-haptics", "palpate-device"),
        ("palpate-device", "palpate-haptics"),
        ("palpate-haptics", "palpate-engine"),
        ("palpate-engine", "palpate-bench"),
        ("palpate-bench", "palpate-py"),
        ("palpate-benches", "palpate-engine"),
        ("palpate-engine", "palpate-benches"),
    ],
)
@pytest.mark.parametrize("kind", [None, "dev", "build"])
def test_an_arrow_up_or_to_a_sibling_is_found(arrow: tuple[str, str], kind: str | None) -> None:
    found = wrong_arrows(crates(arrow, kind=kind))
    assert any(arrow[0] in sentence and arrow[1] in sentence for sentence in found)


def test_arrows_down_are_allowed() -> None:
    down = [
        ("palpate-haptics", "palpate-volume"),
        ("palpate-engine", "palpate-device"),
        ("palpate-py", "palpate-engine"),
        ("palpate-py", "palpate-bench"),
        ("palpate-bench", "palpate-engine"),
        ("palpate-benches", "palpate-haptics"),
    ]
    assert wrong_arrows(crates(*down)) == []


def test_a_crate_without_a_floor_is_found() -> None:
    metadata = {"packages": [{"name": "palpate-new", "dependencies": []}]}
    assert any("palpate-new" in sentence for sentence in wrong_arrows(metadata))


@pytest.mark.parametrize("crate", FOLDERS)
def test_folders_of_a_crate_point_down(crate: str) -> None:
    assert wrong_folder_arrows(ROOT / "crates" / crate / "src", FOLDERS[crate]) == []


@pytest.mark.parametrize(
    ("file", "line"),
    [
        ("touch/feel.rs", "use crate::servo::Servo;"),
        ("touch/feel.rs", "use crate::{notice::Notice, servo::{self, Servo}};"),
        ("touch/feel.rs", "pub fn it() -> crate::servo::Servo {}"),
        ("touch/feel.rs", "use super::super::servo::Servo;"),
        ("touch/feel.rs", "mod tests {\n    use super::super::super::servo::Servo;\n}"),
        ("touch/mod.rs", "use super::servo::Servo;"),
        ("touch/parts/brick.rs", "use crate::servo::Servo;"),
        ("scene/mod.rs", "use crate::servo::Servo;"),
        ("notice.rs", "use crate::servo::Servo;"),
    ],
)
def test_an_arrow_between_folders_that_points_up_or_to_a_sibling_is_found(
    tmp_path: Path, file: str, line: str
) -> None:
    floors = [["notice"], ["touch"], ["scene", "servo"]]
    for name in ["notice.rs", "touch/mod.rs", "scene/mod.rs", "servo/mod.rs", file]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / "servo" / "tick.rs").write_text(
        "use super::Servo;\nuse crate::touch::Feel; // not crate::scene\n"
        "mod tests {\n    use super::super::Servo;\n}\n"
    )
    assert wrong_folder_arrows(tmp_path, floors) == []
    (tmp_path / file).write_text(f"{line}\n")
    [sentence] = wrong_folder_arrows(tmp_path, floors)
    assert file in sentence
    assert "uses crate::servo" in sentence


def test_an_arrow_planted_in_the_engine_is_found(tmp_path: Path) -> None:
    source = shutil.copytree(ROOT / "crates" / "engine" / "src", tmp_path / "src")
    with (source / "touch" / "settings.rs").open("a") as module:
        module.write("\nuse crate::session::Session;\n")
    [sentence] = wrong_folder_arrows(source, FOLDERS["engine"])
    assert "settings.rs (touch) uses crate::session" in sentence


def test_a_folder_without_a_floor_and_a_path_through_the_facade_are_found(tmp_path: Path) -> None:
    (tmp_path / "new").mkdir()
    (tmp_path / "new" / "mod.rs").write_text("use crate::Session;\n")
    (tmp_path / "lib.rs").write_text("pub use crate::new::Session;\n")
    found = wrong_folder_arrows(tmp_path, [["old"]])
    assert len(found) == 3
    for part, sentence in zip(
        ["folder new", "no folder old", "crate::Session"], found, strict=True
    ):
        assert part in sentence


def python_arrows(folder: Path, module: str, line: str) -> str:
    """Returns what the linter says of a copy of the package where a module has another import."""
    package = shutil.copytree(
        ROOT / "python" / "palpate",
        folder / "palpate",
        ignore=shutil.ignore_patterns("*.so", "viewer", "__pycache__"),
    )
    shutil.copy(ROOT / "pyproject.toml", folder)
    with (package / module).open("a") as planted:
        planted.write(f"\n{line}\n")
    checked = subprocess.run(
        [TOOLS / "lint-imports", "--no-cache"],
        check=False,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
    )
    assert checked.returncode == 1, checked.stdout + checked.stderr
    return checked.stdout


@pytest.mark.parametrize(
    ("module", "line", "arrow"),
    [
        (
            "volumes/volume.py",
            "from palpate.cli import main",
            "palpate.volumes.volume -> palpate.cli",
        ),
        (
            "segmentation/request.py",
            "from palpate.cli.scenes import scene_of",
            "palpate.segmentation.request -> palpate.cli.scenes",
        ),
        (
            "recipes/run.py",
            "from palpate.cli.surface import surface",
            "palpate.recipes.run -> palpate.cli.surface",
        ),
        (
            "segmentation/operations.py",
            "from palpate.protocol import ShapeKind",
            "palpate.segmentation.operations -> palpate.protocol",
        ),
        (
            "protocol/segments.py",
            "from palpate.session.session import Session",
            "palpate.protocol.segments -> palpate.session.session",
        ),
        (
            "cli/export.py",
            "from palpate.server.messages.segment_list import SegmentList",
            "palpate.cli.export -> palpate.server.messages.segment_list",
        ),
        (
            "io/reading.py",
            "def late() -> None:\n    from palpate.registration import register",
            "palpate.io.reading -> palpate.registration",
        ),
    ],
)
def test_a_python_module_that_imports_a_higher_layer_is_found(
    tmp_path: Path, module: str, line: str, arrow: str
) -> None:
    assert arrow in python_arrows(tmp_path, module, line)


def test_a_circle_within_a_python_package_is_found(tmp_path: Path) -> None:
    line = "from palpate.volumes.scene import Scene"
    found = python_arrows(tmp_path, "volumes/volume.py", line)
    assert "No circles within packages BROKEN" in found


def test_a_python_package_without_a_layer_is_found(tmp_path: Path) -> None:
    found = python_arrows(tmp_path, "unplaced.py", '"""A module that has no place."""')
    assert "unplaced" in found


def test_a_module_that_imports_the_binding_itself_is_found() -> None:
    checked = subprocess.run(
        [TOOLS / "ruff", "check", "--stdin-filename", "python/palpate/server/app.py", "-"],
        check=False,
        cwd=ROOT,
        input='"""A module."""\n\nfrom palpate import _core\n\n__all__ = ["_core"]\n',
        capture_output=True,
        text=True,
    )
    assert checked.returncode == 1
    assert "`palpate._core` is banned" in checked.stdout


def eslint(file: str, line: str) -> subprocess.CompletedProcess[str]:
    """Lints one line as if it stood in a file of the viewer's sources."""
    node = shutil.which("node")
    assert node is not None
    program = "node_modules/eslint/bin/eslint.js"
    text = f'<script lang="ts">\n{line}\n</script>\n' if file.endswith(".svelte") else f"{line}\n"
    return subprocess.run(
        [node, program, "--stdin", "--stdin-filename", f"src/{file}"],
        check=False,
        cwd=ROOT / "viewer",
        input=text,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize(
    ("file", "target"),
    [
        pytest.param("core/view/new.ts", "../../gl/picture/picture", id="core to gl"),
        pytest.param("core/geometry/new.ts", "../view/clip", id="core to a room above"),
        pytest.param("gl/march/new.ts", "../surfaces/surfaces", id="gl to a room above"),
        pytest.param("gl/picture/new.ts", "../../ui/state/session.svelte", id="gl to ui"),
        pytest.param("live/new.ts", "../gl/picture/picture", id="live to gl"),
        pytest.param("ui/state/new.ts", "../widgets/revert_input", id="state to widget"),
        pytest.param("ui/theme/new.ts", "../widgets/revert_input", id="theme to widget"),
        pytest.param(
            "ui/widgets/New.svelte", "../features/marks/mark_control.svelte", id="widget to feature"
        ),
        pytest.param("ui/widgets/New.svelte", "../app/actions", id="widget to app"),
        pytest.param(
            "ui/features/marks/new.ts", "../slices/slice_control.svelte", id="feature to feature"
        ),
        pytest.param(
            "ui/features/marks/New.svelte",
            "../slices/slice_control.svelte",
            id="feature to feature in svelte",
        ),
        pytest.param("ui/features/marks/new.ts", "../../app/stage", id="feature to app"),
        pytest.param("ui/new/new.ts", "../state/remembered", id="a folder that is no room"),
    ],
)
def test_a_viewer_module_that_imports_upward_is_found(file: str, target: str) -> None:
    checked = eslint(file, f'import {{ it }} from "{target}"; export const that = it;')
    assert checked.returncode == 1, checked.stdout + checked.stderr
    assert "palpate/arrows" in checked.stdout


@pytest.mark.parametrize(
    ("file", "target"),
    [
        ("ui/features/marks/new.ts", "../../state/session.svelte"),
        ("ui/app/new.ts", "../features/marks/mark_control.svelte"),
    ],
)
def test_a_viewer_module_may_import_downward(file: str, target: str) -> None:
    checked = eslint(file, f'import {{ it }} from "{target}"; export const that = it;')
    assert checked.returncode == 0, checked.stdout + checked.stderr


def test_the_viewers_core_imports_no_library_of_graphics() -> None:
    checked = eslint("core/view/new.ts", 'import * as three from "three"; export const it = three;')
    assert checked.returncode == 1, checked.stdout + checked.stderr
    assert "no-restricted-imports" in checked.stdout
