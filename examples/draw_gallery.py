"""Draw the pictures of the documentation from the fixtures.

Usage: python examples/draw_gallery.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

import plcopen_sfc as sfc
from plcopen_sfc.model import Enclosure, ForcedSituation, ForcingOrder, Macro, PartialChart, PartialChartKind

TANK = """
FUNCTION_BLOCK Tank
VAR_INPUT Start, Full, Empty : BOOL; END_VAR
VAR_OUTPUT Valve, Mixer, Drain : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
TRANSITION FROM Wait TO Fill := Start AND Empty; END_TRANSITION
STEP Fill: Valve(N); Mixer(D, T#2s); END_STEP
TRANSITION FROM Fill TO Clear := Full; END_TRANSITION
STEP Clear: Drain(N); END_STEP
TRANSITION FROM Clear TO Wait := Empty AND Clear.T >= T#5s; END_TRANSITION
END_FUNCTION_BLOCK
"""
FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"


def main(folder: str) -> None:
    """Write every picture into `folder`."""
    sorting = sfc.load(FIXTURES / "codesys" / "sorting_conveyor.xml")
    flip_flops = sfc.load(FIXTURES / "training-chain" / "classic_flip-flops.xml").pou("Ablauf")
    tank = sfc.loads(TANK.encode()).pous[0].chart
    cylinders = (FIXTURES / "grafcet" / "two_cylinders.gct").read_bytes()
    renamed = cylinders.replace(b"1B", b"B1").replace(b"2B", b"B2").replace(b"1M1", b"M1").replace(b"2M1", b"M2")
    station = sfc.load(FIXTURES / "plcopen" / "filling_station_2.01.xml")
    converted = sfc.loads(sfc.convert(sfc.loads(renamed), "codesys").data)
    pictures = {
        "pusher": sorting.pou("FB_Pusher").chart.to_svg(),
        "pusher-dark": sorting.pou("FB_Pusher").chart.to_svg(theme="dark"),
        "sorting": sorting.pou("PLC_PRG").chart.to_svg(),
        "drill": sfc.load(FIXTURES / "simaticml" / "FB_Drill.xml").pou("FB_Drill").chart.to_svg(),
        "grafcet": press().to_svg(),
        "timing": sfc.simulate(sorting, pou="FB_Pusher", inputs=sfc.RandomInputs(4), scans=40).to_svg(),
        "flip-flops": flip_flops.body.to_svg(),
        "cap-station": station.pou("CapStation").chart.to_svg(),
        "cap-station-fbd": networks(station, "FBD"),
        "cap-station-ld": networks(station, "LD"),
        "tank": in_format("codesys"),
        "tank-plcopen": in_format("plcopen-2.01"),
        "tank-s7graph": in_format("simaticml"),
        "tank-grafcet": tank.to_svg(style="grafcet"),
        "cylinders": sfc.load(FIXTURES / "grafcet" / "two_cylinders.gct").pous[0].chart.to_svg(),
        "converted": converted.pous[0].chart.to_svg(),
        "belt": sfc.load(FIXTURES / "codesys23" / "distribution_belt.EXP").pous[0].chart.to_svg(),
    }
    for name, svg in pictures.items():
        Path(folder, f"{name}.svg").write_bytes(svg.encode("ascii"))


def in_format(form: str) -> str:
    """Return the picture of the tank as its tool reads it from a file of this format."""
    data = sfc.convert(sfc.loads(TANK.encode()), form).data
    return sfc.loads(data, as_tool=True).pous[0].chart.to_svg()


def networks(station: sfc.Project, language: str) -> str:
    """Return the picture of a chart as flip-flops."""
    return sfc.lower(station, "flipflop", pou="CapStation", language=language, verify=False).pou.body.to_svg()


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
