"""A rename reads the charts that mention the name, and no others."""

from __future__ import annotations

from pathlib import Path

import plcopen_sfc as sfc
from benchmarks.generate import generate
from plcopen_sfc.model import SfcBody


def test_charts_that_do_not_mention_a_name_stay_unread(tmp_path: Path) -> None:
    generate(tmp_path / "many.xml", megabytes=0.6, steps=8)
    project = sfc.load(tmp_path / "many.xml")
    assert len(project.pous) > 2
    chart = project.pous[1].chart
    assert chart is not None
    chart.rename_step(chart.steps[3].name, "OnlyHere")
    sfc.save(project, tmp_path / "many.xml")
    project = sfc.load(tmp_path / "many.xml")
    project.rename(f"{project.pous[1].name}.OnlyHere", "Again")
    sfc.save(project, tmp_path / "many.xml")
    assert [not body.chart.is_unread for pou in project.pous for body in pou.bodies if isinstance(body, SfcBody)] == [
        at == 1 for at in range(len(project.pous))
    ]
    content = (tmp_path / "many.xml").read_bytes()
    assert b"OnlyHere" not in content
    assert (
        sum(step.name == "Again" for each in sfc.load(tmp_path / "many.xml").charts() for step in each.chart.steps) == 1
    )
