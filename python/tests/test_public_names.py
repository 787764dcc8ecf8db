"""What other programs import: names at the top level, of packages, and paths of version 0.1."""

from __future__ import annotations

import subprocess
import sys
from importlib import import_module

import palpate
import pytest
from palpate._aliases import ALIASES

OF_PACKAGES = {
    "palpate.cohort": [
        "Case",
        "CaseResult",
        "Limits",
        "cases_of_bids",
        "cases_of_table",
        "cases_over",
        "run_case",
    ],
    "palpate.io": ["list_series", "read"],
    "palpate.labels": ["Label", "Labels", "read_labels"],
    "palpate.reconstruction": ["Scanner", "reconstruct"],
    "palpate.registration": ["Registration", "RegistrationError", "SearchOptions", "register"],
    "palpate.export": ["export_scene"],
    "palpate.segmentation": ["changed_shape", "grown", "grown_from_seeds", "otsu"],
    "palpate.session": ["Session", "SessionOptions"],
}


@pytest.mark.parametrize("name", palpate.__all__)
def test_each_public_name_is_there(name: str) -> None:
    assert getattr(palpate, name).__name__ == name


@pytest.mark.parametrize(
    ("package", "name"), [(package, name) for package, them in OF_PACKAGES.items() for name in them]
)
def test_a_package_offers_what_its_module_of_version_0_1_did(package: str, name: str) -> None:
    module = import_module(package)
    assert name in module.__all__
    assert getattr(module, name).__name__ == name


@pytest.mark.parametrize("package", OF_PACKAGES)
def test_a_package_offers_nothing_else(package: str) -> None:
    with pytest.raises(AttributeError, match=f"'{package}' has no attribute 'nothing'"):
        getattr(import_module(package), "nothing")  # noqa: B009  # mypy knows that it is not there


@pytest.mark.parametrize(("old", "new"), ALIASES.items())
def test_a_path_of_version_0_1_leads_to_the_same_module(old: str, new: str) -> None:
    module = import_module(old)
    assert module is import_module(new)
    assert module.__name__ == new
    assert module.__spec__ is not None
    assert module.__spec__.name == new


@pytest.mark.parametrize(
    "line",
    [
        "from palpate.mesh_io import object_of_mesh, read_mesh",
        "from palpate import mesh_write; mesh_write.write_mesh",
        "import palpate.surface; palpate.surface.Mesh",
        "import palpate.material as it; assert it.Material is __import__('palpate').Material",
        "import palpate.session as it; it.Session",
    ],
)
def test_old_imports_work_in_a_program_of_their_own(line: str) -> None:
    subprocess.run([sys.executable, "-W", "error", "-c", line], check=True)


def test_a_module_that_never_was_is_not_found() -> None:
    with pytest.raises(ModuleNotFoundError, match=r"palpate\.nothing"):
        import_module("palpate.nothing")


def test_nothing_heavy_is_imported_for_the_names() -> None:
    line = "import sys, palpate; print({'numpy', 'palpate._core'} & set(sys.modules))"
    told = subprocess.run([sys.executable, "-c", line], check=True, capture_output=True, text=True)
    assert told.stdout == "set()\n"
