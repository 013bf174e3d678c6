"""Draw the pictures of docs/drawing.md and docs/pages.md from the fixtures.

Usage: python examples/draw_gallery.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.model import Enclosure, ForcedSituation, ForcingOrder, Macro, PartialChart, PartialChartKind

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"


def main(folder: str) -> None:
    """Write every picture into `folder`."""
    sorting = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    flip_flops = sfc.load(FIXTURES / "training-chain" / "classic_flip-flops.xml").pou("Ablauf")
    pictures = {
        "pusher": sorting.pou("FB_Pusher").chart.to_svg(),
        "pusher-dark": sorting.pou("FB_Pusher").chart.to_svg(theme="dark"),
        "sorting": sorting.pou("PLC_PRG").chart.to_svg(),
        "drill": sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml").pou("FB_Drill").chart.to_svg(),
        "grafcet": press().to_svg(),
        "timing": sfc.simulate(sorting, pou="FB_Pusher", inputs=sfc.RandomInputs(4), scans=40).to_svg(),
        "flip-flops": flip_flops.body.to_svg(),
    }
    for name, svg in pictures.items():
        Path(folder, f"{name}.svg").write_bytes(svg.encode("ascii"))


def press() -> sfc.SfcNetwork:
    """Return a GRAFCET with what only IEC 60848 has: kinds of actions, forcing, a macro-step, an enclosing step."""
    chart = sfc.SfcNetwork()
    for number, name in enumerate(("Rest", "Clamp", "Press", "Pressed", "Unload"), 1):
        chart.add_step(name, initial=number == 1).number = number
    rest, clamp, pressing, pressed, unload = chart.steps
    chart.add_transition(rest, [clamp, pressing], "start AND part").name = "t1"
    chart.add_transition(pressing, pressed, "force > 80")
    chart.add_transition([clamp, pressed], unload, "5s/X4")
    chart.add_transition(unload, rest, "NOT part")
    clamp.actions = [
        sfc.ActionAssociation(id=20, kind=sfc.ActionKind.CONTINUOUS, target="Clamp"),
        sfc.ActionAssociation(id=21, kind=sfc.ActionKind.CONDITIONAL, target="Cool", condition="hot"),
        sfc.ActionAssociation(id=22, kind=sfc.ActionKind.DELAYED, target="Horn", duration="3s"),
    ]
    pressed.actions = [
        sfc.ActionAssociation(id=23, kind=sfc.ActionKind.ON_ACTIVATION, target="Parts", value="Parts + 1"),
        sfc.ActionAssociation(
            id=24,
            kind=sfc.ActionKind.FORCING,
            forcing=ForcingOrder(chart="G20", situation=ForcedSituation.INITIAL),
        ),
    ]
    pressing.encloses = [Enclosure(chart="G3", activated_steps=["31"])]
    unload.macro = Macro(expansion="M5")
    inner, expansion = sfc.SfcNetwork(), sfc.SfcNetwork()
    for name in ("31", "32"):
        inner.add_step(name)
    inner.add_transition("31", "32", "down")
    inner.add_transition("32", "31", "up")
    for name in ("E5", "S5"):
        expansion.add_step(name)
    expansion.add_transition("E5", "S5", "gripped")
    chart.partial_charts = [
        PartialChart(name="G3", kind=PartialChartKind.ENCLOSED, chart=inner),
        PartialChart(name="M5", kind=PartialChartKind.EXPANSION, chart=expansion),
    ]
    return chart


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(sys.argv[1])
