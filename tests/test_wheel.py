"""The wheel is complete: installed into an empty environment it does what the README says, from any folder."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import venv
import zipfile
from pathlib import Path

import pytest

from tests.test_docs import ROOT, agrees, blocks, marked_command

pytestmark = pytest.mark.slow

_OFFLINE = ("No matching distribution", "Could not find a version", "connection", "Connection", "Temporary failure")


def call(*arguments: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    # the environment of the tests must not leak into the empty one
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}
    clean |= {"PYTHONIOENCODING": "utf-8", "COLUMNS": "200", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    return subprocess.run(
        [*map(str, arguments)], cwd=cwd, env=clean, capture_output=True, encoding="utf-8", check=False
    )


def install(*arguments: str | Path, cwd: Path) -> None:
    """Run pip; skip where there is no package index, unless the run has promised one (`.ci/run` does)."""
    result = call(*arguments, cwd=cwd)
    if (
        result.returncode
        and any(sign in result.stderr for sign in _OFFLINE)
        and not os.environ.get("PLCOPEN_SFC_ONLINE")
    ):
        pytest.skip(f"no package index: {result.stderr.strip().splitlines()[-1]}")
    assert result.returncode == 0, result.stderr


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    install(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder, ROOT, cwd=folder)
    (found,) = folder.glob("plcopen_sfc-*.whl")
    return found


@pytest.fixture(scope="module")
def programs(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment with nothing in it but the wheel and what it requires."""
    folder = tmp_path_factory.mktemp("empty") / "environment"
    venv.create(folder)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    into = (sys.executable, "-m", "pip", "--python", programs / "python")
    install(*into, "install", "--quiet", "--no-compile", wheel, cwd=folder.parent)
    return programs


def test_the_wheel_holds_all_that_is_needed_at_run_time(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    assert "plcopen_sfc/py.typed" in names
    folder = ROOT / "schemas"
    schemas = {f"plcopen_sfc/schemas/{path.relative_to(folder).as_posix()}" for path in folder.rglob("*.xsd")}
    assert schemas
    assert schemas <= names
    package = [path for path in (ROOT / "plcopen_sfc").rglob("*.*") if path.suffix in {".py", ".lark", ".css", ".js"}]
    assert {path.relative_to(ROOT).as_posix() for path in package} <= names
    assert not any(name.startswith(("tests/", "fixtures/", "docs/")) for name in names)


def test_the_first_command_of_the_readme_runs_elsewhere(programs: Path, tmp_path: Path) -> None:
    last = shlex.split(marked_command("first command").split("&&")[-1])
    arguments = [str(ROOT / word) if word.startswith("fixtures/") else word for word in last[1:]]
    result = call(programs / "plcopen-sfc", *arguments, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    shown = next(block.text for block in blocks(ROOT / "README.md") if block.language == "text")
    assert agrees(shown, result.stdout), result.stdout


def test_the_installed_package_validates_with_its_own_schemas(programs: Path, tmp_path: Path) -> None:
    good = sorted((ROOT / "fixtures" / "plcopen").glob("*.xml")) + sorted((ROOT / "fixtures" / "codesys").glob("*.xml"))
    result = call(programs / "plcopen-sfc", "validate", *good, cwd=tmp_path)
    assert result.returncode == 0, result.stdout + result.stderr
    bad = tmp_path / "bad.xml"
    text = good[0].read_text(encoding="utf-8-sig").replace("<contentHeader ", "<contentHeader nonsense='1' ")
    bad.write_text(text, encoding="utf-8")
    result = call(programs / "plcopen-sfc", "validate", bad, cwd=tmp_path)
    assert result.returncode == 1, result.stdout + result.stderr
    assert "XSD005" in result.stdout


def test_the_installed_package_converts(programs: Path, tmp_path: Path) -> None:
    source = ROOT / "fixtures" / "codesys" / "sorting_conveyor.xml"
    result = call(
        programs / "plcopen-sfc",
        "convert",
        source,
        "out.xml",
        "--to",
        "plcopen-2.01",
        "--partial",
        "--limit",
        "0",
        cwd=tmp_path,
    )
    assert result.returncode == 0, result.stderr
    assert (tmp_path / "out.xml").stat().st_size > 10_000


def test_it_is_typed_and_says_its_version(programs: Path, tmp_path: Path) -> None:
    code = "import plcopen_sfc, pathlib; print(plcopen_sfc.__version__, pathlib.Path(plcopen_sfc.__file__).parent)"
    result = call(programs / "python", "-c", code, cwd=tmp_path)
    version, _, place = result.stdout.strip().partition(" ")
    assert ROOT not in Path(place).parents
    assert (Path(place) / "py.typed").is_file()
    assert call(programs / "plcopen-sfc", "--version", cwd=tmp_path).stdout.split()[-1] == version
