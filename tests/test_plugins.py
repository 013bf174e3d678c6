"""Plugins: the example package is installed, and its format, rule and refactoring are used."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PLUGIN = ROOT / "examples" / "plugin"


@pytest.fixture(scope="module")
def packages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the example as an installer leaves it: its modules and its metadata. No network is needed."""
    folder = tmp_path_factory.mktemp("packages")
    shutil.copytree(PLUGIN / "src", folder, dirs_exist_ok=True)
    project = tomllib.loads((PLUGIN / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    info = folder / f"{project['name'].replace('-', '_')}-{project['version']}.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Name: {project['name']}\nVersion: {project['version']}\n", encoding="utf-8")
    groups = (
        "\n".join([f"[{group}]", *(f"{name} = {place}" for name, place in entries.items())])
        for group, entries in project["entry-points"].items()
    )
    (info / "entry_points.txt").write_text("\n".join(groups) + "\n", encoding="utf-8")
    return folder


def run(packages: Path, *arguments: object) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(packages), str(ROOT)]), "COLUMNS": "200"}
    command = [sys.executable, "-m", "plcopen_sfc", *map(str, arguments)]
    return subprocess.run(command, env=environment, capture_output=True, encoding="utf-8", check=False)


@pytest.mark.slow
def test_a_format_is_used_by_its_name_and_recognised(packages: Path, tmp_path: Path) -> None:
    outline = tmp_path / "mixer.outline"
    mixer = ROOT / "fixtures" / "steplist" / "mixer.csv"
    done = run(packages, "convert", mixer, outline, "--to", "outline")
    assert done.returncode == 1, "nothing executes an outline, as nothing does a step list"
    assert "POU Mixer: not compared, as nothing executes a" in done.stdout
    done = run(packages, "convert", mixer, outline, "--to", "outline", "--json", "--accept-untested")
    assert done.returncode == 0, done.stderr
    assert outline.read_text(encoding="utf-8").splitlines()[:3] == [
        "OUTLINE OF Mixer",
        "Idle -> Fill",
        "Fill -> Heat, Stir, Idle",
    ]
    assert "dropped" in {item["outcome"] for item in json.loads(done.stdout)["items"]}
    assert "OUTLINE OF" not in run(packages, "info", outline).stderr
    assert "outline" in run(packages, "formats").stdout


@pytest.mark.slow
def test_a_rule_finds_and_a_refactoring_mends(packages: Path, tmp_path: Path) -> None:
    file = tmp_path / "mixer.csv"
    shutil.copy(ROOT / "fixtures" / "steplist" / "mixer.csv", file)
    found = run(packages, "check", file, "--select", "PLT")
    assert found.stdout.count("warning PLT01") == 5, found.stderr
    done = run(packages, "apply", "plant-names", file, "--write")
    assert done.returncode == 0, done.stderr
    assert "nothing found" in run(packages, "check", file, "--select", "PLT").stdout
    assert ";S_Heat;20;" in file.read_text(encoding="utf-8-sig")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("import nothing_like_that", "cannot be imported: ModuleNotFoundError"),
        ("FORMAT = 5", "is no Format, which plcopen_sfc.formats are"),
    ],
)
def test_a_wrong_format_is_an_error_of_every_command_that_reads(packages: Path, tmp_path: Path, text, told) -> None:
    """It was raised while modules were imported, before anything catches errors."""
    broken = tmp_path / "packages"
    shutil.copytree(packages, broken)
    (broken / "plant_rules" / "outline.py").write_text(text + "\n", encoding="utf-8")
    for command in ("info", "check"):
        done = run(broken, command, ROOT / "fixtures" / "steplist" / "mixer.csv")
        assert done.returncode == 2
        assert "Traceback" not in done.stderr
        assert done.stderr.startswith("error: the plugin outline of the package plant-rules")
        assert told in done.stderr


@pytest.mark.slow
def test_a_plugin_that_cannot_be_imported_is_named(packages: Path, tmp_path: Path) -> None:
    broken = tmp_path / "packages"
    shutil.copytree(packages, broken)
    (broken / "plant_rules" / "checks.py").write_text("import nothing_like_that\n", encoding="utf-8")
    done = run(broken, "rules")
    assert done.returncode == 2
    assert "the plugin PLT01 of the package plant-rules cannot be imported" in done.stderr
    (broken / "plant_rules" / "checks.py").write_text("PLT01 = 'a rule'\n", encoding="utf-8")
    assert "is no Rule" in run(broken, "rules").stderr
