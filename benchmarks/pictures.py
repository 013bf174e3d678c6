"""How pictures of charts and networks turn out, and how long they take.

    python -m benchmarks.pictures              the fixtures, the corpus where there is one, and growth to 10,000 steps
    python -m benchmarks.pictures --quick      the fixtures, and growth to 2,500 steps

`overlaps` are pairs of elements that are on each other, `crossings` pairs of wires that cross, `area` the thousands of
square pixels of a picture for each step or element; steps are those of all charts in a picture. Times are processor
times without reading the file, of the best of two runs, after everything is imported; `worst` is that for 100 of
pictures with at least 50 steps or elements, `longest` that of one picture, `slow` the number of pictures that take more
than 50 ms for each 100 steps or elements that they begin. The exponent is that of the last three sizes.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import statistics
import time
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import plcopen_sfc as sfc
from benchmarks.lowering import blocks, ring
from plcopen_sfc.drawing.pictures import charts_in
from plcopen_sfc.drawing.pictures.network_layout import crossings
from plcopen_sfc.model.body import FbdBody, LdBody
from plcopen_sfc.model.sfc import SfcBody

ROOT = Path(__file__).resolve().parents[1]
CORPUS = Path(os.environ.get("PLCOPEN_SFC_CORPUS") or ROOT.parent / "shared" / "corpus")
SIZES = (1250, 2500, 5000, 10_000)
LARGEST = 10_000_000
ENOUGH = 50
SLOW = 0.05

_AREA = re.compile(r'data-area="(-?\d+) (-?\d+) (\d+) (\d+)"')
_WIRE = re.compile(r'<path class="wire" d="M([^"]*)"')
_SIZE = re.compile(r' width="(\d+)" height="(\d+)"')


class MeasuredPicture(NamedTuple):
    """Measures of a picture."""

    elements: int
    overlaps: int
    crossings: int
    area: int
    seconds: float


def overlaps(svg: str) -> int:
    """Count pairs of elements that are on each other.

    Actions are inside of their steps; the frames of inner charts have elements in them.
    """
    areas = []
    depth = 0
    for group in re.finditer(r"<g [^>]*>|</g>", svg):
        depth += -1 if group[0] == "</g>" else 1
        area = _AREA.search(group[0])
        if depth == 1 and area is not None and 'class="part"' not in group[0]:
            areas.append(tuple(map(int, area.groups())))
    areas.sort()
    count = 0
    for number, (left, top, width, height) in enumerate(areas):
        for x, y, _, other in areas[number + 1 :]:
            if x >= left + width:
                break
            count += y < top + height and top < y + other
    return count


def crossed(svg: str) -> int:
    """Count pairs of wires that cross, each inside of the other."""
    ways = ([tuple(map(int, point.split())) for point in path.split("L")] for path in _WIRE.findall(svg))
    return crossings(line for way in ways for line in pairwise(way))


def measure(draw: Callable[[], str], elements: int) -> MeasuredPicture:
    """Draw a picture twice and look at it."""
    seconds = []
    for _ in range(2):
        start = time.process_time()
        svg = draw()
        seconds.append(time.process_time() - start)
    size = _SIZE.search(svg)
    area = int(size[1]) * int(size[2]) if size is not None else 0
    return MeasuredPicture(max(elements, 1), overlaps(svg), crossed(svg), area, min(seconds))


def pictures(files: list[Path]) -> tuple[list[MeasuredPicture], list[MeasuredPicture]]:
    """Draw all charts and all networks of files; what cannot be loaded is left out."""
    charts, networks = [], []
    for file in files:
        try:
            project = sfc.load(file)
            project.read_all()
        except sfc.SfcError:
            continue
        for _, _, body in project.bodies():
            if isinstance(body, SfcBody):
                steps = sum(len(part.chart.steps) for part in charts_in(body.chart))
                charts.append(measure(body.chart.to_svg, steps))
            elif isinstance(body, FbdBody | LdBody):
                networks.append(measure(body.to_svg, sum(len(network.nodes) for network in body.networks)))
    return charts, networks


def rows(name: str, files: list[Path]) -> Iterator[str]:
    """Yield the rows of the table for some files."""
    for what, found in zip(("charts", "networks"), pictures(files), strict=True):
        if found:
            elements = sum(each.elements for each in found)
            times = [100_000 * each.seconds / each.elements for each in found if each.elements >= ENOUGH]
            whole = 100_000 * sum(each.seconds for each in found) / elements
            told = (
                f"{name}, {what}",
                len(found),
                elements,
                sum(each.overlaps for each in found),
                sum(each.crossings for each in found),
                f"{statistics.median(each.area / each.elements for each in found) / 1000:.0f}",
                f"{whole:.0f} ms",
                f"{max(times):.0f} ms" if times else "",
                f"{1000 * max(each.seconds for each in found):.0f} ms",
                sum(each.seconds > SLOW * math.ceil(each.elements / 100) for each in found),
            )
            yield f"| {' | '.join(map(str, told))} |"


def growth(sizes: tuple[int, ...]) -> Iterator[str]:
    """Yield the rows of the growth with the number of steps."""
    for name, make in (("steps in a circle", ring), ("nested branches", blocks)):
        times = [measure(next(make(size).charts()).chart.to_svg, size).seconds for size in sizes]
        last = min(3, len(sizes))
        exponent = math.log(times[-1] / times[-last]) / math.log(sizes[-1] / sizes[-last])
        cells = (name, *(f"{seconds:.2f} s" for seconds in times), f"size^{exponent:.2f}")
        yield f"| {' | '.join(cells)} |"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    measure(next(blocks(100).charts()).chart.to_svg, 100)
    print("| pictures of | number | elements | overlaps | crossings | area | time for 100 | worst | longest | slow |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    folders = {"fixtures": ROOT / "fixtures"} | ({} if quick or not CORPUS.is_dir() else {"corpus": CORPUS})
    for name, folder in folders.items():
        files = sorted(path for path in folder.rglob("*") if path.is_file() and path.stat().st_size < LARGEST)
        for row in rows(name, files):
            print(row, flush=True)
    sizes = SIZES[:2] if quick else SIZES
    print(f"\n| chart | {' | '.join(f'{size:,} steps' for size in sizes)} | growth |")
    print("|---|" + "---|" * (len(sizes) + 1))
    for row in growth(sizes):
        print(row, flush=True)


if __name__ == "__main__":
    main()
