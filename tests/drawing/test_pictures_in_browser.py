"""Pictures in a real browser: texts are as wide as estimated, and nothing of a file is executed."""

from __future__ import annotations

import html
import re
import shutil
import string
import subprocess
from pathlib import Path

import pytest

import plcopen_sfc as sfc
from tests.drawing.test_pictures import TestSafety, fixture_charts

_CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
_SWITCHES = (
    "--headless --no-sandbox --disable-gpu --disable-background-networking --disable-component-update --disable-sync "
    "--disable-quic --no-first-run --virtual-time-budget=20000 --dump-dom"
).split()
_MEASURE = """
const wide = [];
for (const group of document.querySelectorAll("g[data-area]")) {
  const [left, , width] = group.dataset.area.split(" ").map(Number);
  for (const text of group.querySelectorAll(":scope > text, :scope > a > text")) {
    const box = text.getBBox();
    if (box.x < left - 2 || box.x + box.width > left + width + 2) wide.push(text.textContent);
  }
  const boxes = [...group.querySelectorAll(":scope > text")].map((text) => [text.getBBox(), text.textContent]);
  for (const [one, told] of boxes) for (const [other, name] of boxes) {
    const apart = one.x + one.width <= other.x || other.x + other.width <= one.x;
    if (one !== other && !apart && Math.abs(one.y - other.y) < 9) wide.push(`${told} on ${name}`);
  }
}
document.body.innerHTML = "<p id=result>" + document.querySelectorAll("text").length + "</p><p id=wide></p>";
document.getElementById("wide").textContent = wide.join("|");
"""


def look(tmp_path: Path, body: str) -> str:
    """Open a page and return its document after its scripts have run."""
    if _CHROMIUM is None:
        pytest.skip("no Chromium (apt-get install chromium)")
    page = tmp_path / "page.html"
    page.write_text(f"<!DOCTYPE html><meta charset=utf-8><body>{body}", encoding="utf-8")
    arguments = [_CHROMIUM, *_SWITCHES, f"--user-data-dir={tmp_path / 'profile'}", page.as_uri()]
    return subprocess.run(arguments, capture_output=True, check=True, timeout=120, text=True).stdout


@pytest.mark.slow
def test_texts_fit_into_their_elements(tmp_path: Path) -> None:
    marked = sfc.SfcNetwork()
    step = marked.add_step("Initialisation of all", initial=True)
    step.entry_action, step.exit_action = "In", "Out"
    pictures = "".join(marked.to_svg(style=style) for style in ("iec", "grafcet", "s7graph"))
    pictures += "".join(chart.chart.to_svg() for _, chart in fixture_charts())
    dom = look(tmp_path, f"{pictures}<script>{_MEASURE}</script>")
    assert re.search(r'<p id="wide">(.*?)</p>', dom, re.DOTALL)[1] == ""


@pytest.mark.slow
def test_lines_of_one_letter_fit_too(tmp_path: Path) -> None:
    """Browsers round the width of each letter: a line of asterisks crossed its frame."""
    chart = sfc.SfcNetwork()
    for number, letter in enumerate(
        [*string.ascii_letters, *string.digits, *string.punctuation, *"\u00e4\u00c4\u00c6\u2192\u0449"]
    ):
        step = chart.add_step(f"{letter * 14}{number}", comment=letter * 90)
        step.actions = [sfc.ActionAssociation(id=1000 + number, body=sfc.StBody(text=letter * 90))]
        chart.add_transition(step, step, letter * 90).name = letter * 14
    dom = look(tmp_path, f"{chart.to_svg()}<script>{_MEASURE}</script>")
    assert html.unescape(re.search(r'<p id="wide">(.*?)</p>', dom, re.DOTALL)[1]) == ""


@pytest.mark.slow
def test_nothing_of_a_file_is_executed(tmp_path: Path) -> None:
    chart = sfc.SfcNetwork()
    step = chart.add_step(TestSafety.NASTY, initial=True)
    step.comment = "<img src=x onerror=alert(1)>"
    chart.add_transition(step, step, "</title><script>document.title = 'executed'</script>")
    script = "<script>document.title += [...document.querySelectorAll('svg script, svg img')].length</script>"
    dom = look(tmp_path, f"<title>page</title>{chart.to_svg()}{script}")
    assert "<title>page0</title>" in dom
