"""Real files as texts for matiec: they compile, and what is compiled does what the charts do."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.errors import SimulationError
from plcopen_sfc.report import Outcome
from tests.corpus import corpus_files, require_corpus
from tests.judges.comparing import Compiled, differences, is_known
from tests.judges.matiec import MatiecError, require_matiec
from tests.samples import label
from tests.sweeps import WHOLE

LARGEST = 300_000
SAMPLE = (
    "SFC_TEST.xml",
    "first_steps/plc.xml",
    "Example_1_rpoject.xml",
    "SFC_Evolution_5.xml",
    "xml/src/test/resources/test.xml",
)
_CHART = re.compile(rb"<(?:\w+:)?SFC\b|\bINITIAL_STEP\b")


def _files() -> list[Path]:
    found = [path for kind in ("plcopen", "iectext", "codesys") for path in corpus_files(kind)]
    found = [path for path in found if path.stat().st_size < LARGEST and _CHART.search(path.read_bytes())]
    return [path for path in found if WHOLE or path.as_posix().endswith(SAMPLE)]


def compare_file(path: Path, folder: Path) -> list[str]:
    """Outcomes of a file and of each chart in it: ``refused ..``, ``differs ..``, ``equal ..``."""
    try:
        project = sfc.load(path)
        data, report = sfc.convert(project, "iec-text", flavour="matiec", partial=True)
    except sfc.SfcError as error:
        return [f"refused in reading: {str(error).splitlines()[0]}"]
    compiled = Compiled.of(data, report)
    lost = report.with_outcome(Outcome.NOT_EXECUTED)
    try:
        require_matiec().translate(compiled.text, folder)
    except MatiecError as error:
        return [f"refused by iec2c: {lost[0].what} {lost[0].why}" if lost else f"does not compile: {error}"]
    found = ["compiles"]
    for number, pou in enumerate(pou for pou in project.pous if pou.sfc is not None and pou.sfc.steps):
        try:
            wrong = list(differences(project, pou, compiled, report, folder / str(number)))
        except MatiecError as error:
            found.append(f"not compared: {pou.name}" if lost else f"does not compile: {pou.name} {error}")
        except SimulationError as error:
            found.append(f"not simulated: {pou.name} {error}")
        else:
            how = "equal" if not wrong else "differs as reported" if is_known(report, pou) else "differs"
            found.append(f"{how}: {pou.name} {wrong[:3]}")
    return found


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("path", _files(), ids=label)
def test_charts_of_real_files_do_the_same(path: Path, tmp_path: Path) -> None:
    require_corpus()
    require_matiec()
    found = compare_file(path, tmp_path)
    assert not [line for line in found if line.startswith(("does not compile", "differs:"))]


@pytest.mark.corpus
@pytest.mark.slow
@pytest.mark.parametrize("path", _files(), ids=label)
def test_code_of_real_charts_compiles(path: Path, tmp_path: Path) -> None:
    """Each chart alone, with what it needs: the rest of its file may be what matiec does not take."""
    require_corpus()
    matiec = require_matiec()
    project = sfc.load(path)
    for number, pou in enumerate(pou for pou in project.pous if pou.sfc is not None and pou.sfc.steps):
        target = tmp_path / f"{number}.st"
        try:
            made = sfc.lower_to_file(project, str(target), pou=pou.name, flavour="matiec", verify=False)
        except sfc.SfcError:
            continue
        if made.path is not None:
            matiec.translate(target.read_text(encoding="utf-8"), tmp_path / str(number))
