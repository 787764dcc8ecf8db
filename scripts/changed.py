"""Prints which unit tests belong to what was changed: names of crates, or files of Python tests.

Changed is what differs from where the branch left ``main``; on ``main`` itself, what is not
committed, or else the last commit. The page's own tests are found by vitest (`make check`).
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from repository_files import ROOT

PACKAGE = "python/palpate/"
TESTS = ("python/tests", "tests")


def git(*arguments: str) -> str:
    """Returns what git prints, or nothing where it fails."""
    return subprocess.run(
        ["git", *arguments], cwd=ROOT, check=False, capture_output=True, text=True
    ).stdout.strip()


def compared_with() -> str:
    """Returns the commit that the working tree is compared with."""
    head = git("rev-parse", "HEAD")
    for main in ("origin/main", "main"):
        base = git("merge-base", "HEAD", main)
        if base and base != head:
            return base
    return "HEAD" if git("status", "--porcelain") else "HEAD~1"


def changed_files() -> list[str]:
    """Returns the paths of the repository that changed and still exist."""
    names = [
        *git("diff", "--name-only", "-z", compared_with()).split("\0"),
        *git("ls-files", "--others", "--exclude-standard", "-z").split("\0"),
    ]
    return sorted({name for name in names if name and (ROOT / name).is_file()})


def crates(changed: Iterable[str]) -> list[str]:
    """Returns the packages of the crates in which a file changed."""
    found = {name.split("/")[1] for name in changed if name.startswith("crates/")}
    return [f"palpate-{crate}" for crate in sorted(found)]


def python_tests(changed: Iterable[str], tests: Iterable[Path]) -> list[str]:
    """Returns the files of tests that changed, or that import a module that did."""
    names = set(changed)
    modules = {
        name.removeprefix("python/").removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        for name in names
        if name.startswith(PACKAGE) and name.endswith(".py")
    }
    wanted = []
    for file in tests:
        path = file.relative_to(ROOT).as_posix()
        if path in names or modules & set(imported(file)):
            wanted.append(path)
    return wanted


def all_tests() -> list[Path]:
    """Returns the files of Python tests."""
    return sorted(file for folder in TESTS for file in (ROOT / folder).rglob("test_*.py"))


def imported(file: Path) -> Iterable[str]:
    """Yields the names of modules that a file imports, and what it may import from them."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module
            yield from (f"{node.module}.{each.name}" for each in node.names)


def main() -> int:
    """Prints what the first argument asks for, on one line."""
    [asked] = sys.argv[1:]
    changed = changed_files()
    answers = {
        "commit": lambda: [compared_with()],
        "crates": lambda: crates(changed),
        "python": lambda: python_tests(changed, all_tests()),
    }
    print(*answers[asked]())
    return 0


if __name__ == "__main__":
    sys.exit(main())
