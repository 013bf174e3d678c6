"""Measures `plcopen_sfc` against lxml, libxml2, xsdata and blark, and prints ratios.

    python -m benchmarks.run                    everything, about five minutes
    python -m benchmarks.run --quick            growth up to 10 MB only
    python -m benchmarks.run --json             the same as data

For the comparisons with xsdata and blark: ``pip install plcopen "xsdata[lxml]" blark``.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

from lxml import etree

import plcopen_sfc as sfc
from benchmarks import jobs, structured_text
from benchmarks.exports import generate_export
from benchmarks.generate import generate
from benchmarks.measure import Times, process_times, race

LARGEST = "PLCOpenXML_Scenario_24.xml"
SIZES = (1.0, 3.0, 10.0, 30.0, 100.0)
DOCUMENTS = {
    "Export__plcBlock_GRAPH_FB_R134a_GRAPH.xml": "GRAPH block",
    "Export__plcBlock_LAD_FB_R134a_BU_Valves.xml": "LAD block",
    "Export__plcBlock_DB_DB_R134a_1_StepData.xml": "data block",
    "FB_BMS.TcPOU": "POU of TwinCAT",
}
BLOCKS = (250, 500, 1000, 2000)
ST_SIZES = (1.0, 2.0, 4.0, 8.0)
SAMPLE = 30_000
"""How many bytes blark is given of a source: it takes minutes for a megabyte."""
LINEAR = 1.1
_CHARTS = "load, read all charts"
_EVERYTHING = "load, read all charts and drawings"


@dataclass
class Row:
    """One comparison. `limit` is what the ratio should stay within, or reach where `faster`; None: for information.

    Where `growth`, `ratio` is the exponent of the growth with size, `ours` is for the largest file, `theirs` for the
    smallest.
    """

    file: str
    what: str
    against: str
    ours: float
    theirs: float
    unit: str
    ratio: float
    wall: float | None = None
    limit: float | None = None
    faster: bool = False
    growth: bool = False

    @property
    def reached(self) -> bool | None:
        """Whether the goal is reached."""
        if self.limit is None:
            return None
        return self.ratio >= self.limit if self.faster else self.ratio <= self.limit

    @property
    def goal(self) -> str:
        """The goal in words."""
        if self.limit is None:
            return ""
        return f">= {self.limit:g}" if self.faster else f"<= {self.limit:g}"


def compare(
    file: str, what: str, against: str, times: tuple[Times, Times], limit: float | None = None, *, faster: bool = False
) -> Row:
    """A row of two contestants, ours first. With `faster` the ratio says how many times faster ours is."""
    ours, theirs = times
    up, down = (theirs, ours) if faster else (ours, theirs)
    ratio, wall = up.best / down.best, up.best_wall / down.best_wall
    return Row(file, what, against, ours.best, theirs.best, "s", ratio, wall, limit, faster)


class Bench:
    """One run: collects rows and remarks, and says on stderr what it is doing."""

    def __init__(self, folder: Path, *, quiet: bool) -> None:
        self.folder = folder
        self.quiet = quiet
        self.rows: list[Row] = []
        self.notes: list[str] = []
        self.growth: list[dict[str, Any]] = []

    def tell(self, text: str) -> None:
        """Say what is going on."""
        if not self.quiet:
            print(text, file=sys.stderr, flush=True)

    def warm(self, *, codesys: bool) -> Path:
        """A small file of the same dialect, to have everything imported and compiled before a measurement."""
        path = self.folder / f"warm-{'codesys' if codesys else 'plcopen'}.xml"
        if not path.exists():
            generate(path, megabytes=0, codesys=codesys, steps=16)
        return path

    def file(self, label: str, path: Path, *, codesys: bool) -> None:
        """Everything that is measured on one file."""
        self.tell(f"{label}: {path.stat().st_size / 1e6:.1f} MB")
        for part in (self.reading, self.saving, self.validating):
            try:
                part(label, path, self.warm(codesys=codesys))
            except Exception as error:  # one failure must not cost the other measurements
                self.notes.append(f"{label}: FAILED: {type(error).__name__}: {error}")

    def reading(self, label: str, path: Path, warm: Path) -> None:
        """`load`, and `load` with every chart, and with every drawing, against lxml and xsdata: time and memory."""
        contestants = ["lxml", "load", "load_charts", "load_all"]
        expected, found = jobs.steps_in_tree(jobs.parse_lxml(path)), jobs.steps_of(jobs.load(path))
        steps = f"{label}: {expected} steps in the XML, {found} in our model"
        if jobs.has_xsdata():
            try:
                typed, untyped = jobs.steps_of_xsdata(jobs.parse_xsdata(jobs.for_xsdata(path)))
            except Exception as error:  # whatever xsdata raises on a file that it does not take
                self.notes.append(f"{label}: xsdata cannot read it: {type(error).__name__}: {str(error)[:80]}")
            else:
                contestants.append("xsdata")
                steps += f", {typed} in the objects of xsdata"
                if untyped:
                    steps += f", where {untyped} more are plain elements without a class: less work"
        else:
            self.notes.append('xsdata is not measured: pip install plcopen "xsdata[lxml]"')
        self.notes.append(steps)
        times = race(contestants, path, warm)
        lxml, ours, charts, everything = (times[name] for name in contestants[:4])
        self.rows += [
            compare(label, "load", "lxml.etree.parse", (ours, lxml), 5),
            compare(label, _CHARTS, "lxml.etree.parse", (charts, lxml), 4),
            compare(label, _EVERYTHING, "lxml.etree.parse", (everything, lxml)),
        ]
        if xsdata := times.get("xsdata"):
            self.rows += [
                compare(label, "load", "xsdata + plcopen", (ours, xsdata), 7, faster=True),
                compare(label, _EVERYTHING, "xsdata + plcopen", (everything, xsdata), 7, faster=True),
            ]
        tree = lxml.megabytes
        for mine, what in ((ours, "load"), (everything, _EVERYTHING)):
            memory = mine.megabytes
            self.rows.append(
                Row(label, f"peak memory, {what}", "lxml tree", memory, tree, "MB", memory / tree, None, 3)
            )

    def saving(self, label: str, path: Path, warm: Path) -> None:
        """Unedited and edited projects against writing the tree of lxml."""
        unedited = {"save": "save, unedited", "save_all": "save, unedited, all charts read"}
        edited = {
            "comment": "comment a step, save",
            "rename": "rename a step, save",
            "rename_all": "rename a step, save, all charts read",
        }
        times = race(["tostring", *unedited], path, warm) | race(list(edited), path, warm, rounds=3)
        for name, what in (unedited | edited).items():
            limit = 3 if name in unedited else 6
            self.rows.append(compare(label, what, "lxml.etree.tostring", (times[name], times["tostring"]), limit))

    def validating(self, label: str, path: Path, warm: Path) -> None:
        """Our validation against libxml2's validator, both with parsing and with compiled schemas."""
        against = "libxml2, official schema" if jobs.official_schema(path) else "libxml2, our schema"
        if found := jobs.validate(path):
            self.notes.append(f"{label}: our validation has {len(found)} findings, so it also explains")
        if not jobs.validate_libxml2(jobs.compile_schema(path)):
            self.notes.append(f"{label}: libxml2 says that it is not valid")
        times = race(["validate", "libxml2"], path, warm)
        self.rows.append(compare(label, "validate", against, (times["validate"], times["libxml2"]), 1.5))

    def growing(self, sizes: Sequence[float]) -> None:
        """Time and memory per megabyte from small to large files."""
        contestants = {
            "lxml": ("growth of lxml.etree.parse", None),
            "load": ("growth of load", LINEAR),
            "load_all": (f"growth of {_EVERYTHING}", LINEAR),
        }
        for size in sizes:
            path = self.folder / f"grow-{size:g}.xml"
            generate(path, megabytes=size)
            megabytes = path.stat().st_size / 1e6
            self.tell(f"growth: {megabytes:.1f} MB")
            times = race(list(contestants), path, self.warm(codesys=False), rounds=3 if size < 30 else 1)
            path.unlink()
            for job, each in times.items():
                self.growth.append({"job": job, "megabytes": megabytes, "cpu": each.best, "memory": each.megabytes})
        for job, (what, limit) in contestants.items():
            points = [(each["megabytes"], each["cpu"]) for each in self.growth if each["job"] == job]
            (small, first), (large, last) = points[0], points[-1]
            per_megabyte, of_smallest = last / large, first / small
            row = Row(
                f"{small:.0f} to {large:.0f} MB", what, "smallest", per_megabyte, of_smallest, "s/MB", exponent(points)
            )
            row.limit, row.growth = limit, True
            self.rows.append(row)

    def documents(self) -> None:
        """The largest real documents of TIA Portal, in GRAPH, in LAD and a data block, and of TwinCAT."""
        corpus = corpus_folder()
        for name, what in DOCUMENTS.items():
            path = next(iter(sorted(corpus.rglob(name))), None)
            if path is None:
                self.notes.append(f"no {what} measured: {name} is not there")
                continue
            # the first object of each class takes long, and no small file has all classes; its texts must be others
            warm = self.folder / f"warm-{name}"
            warm.write_bytes(path.read_bytes().replace(b"\n", b"\n "))
            label = f"{what}, {path.stat().st_size / 1e6:.2f} MB"
            self.tell(label)
            times = race(["lxml", "load", "load_charts", "load_all", "save", "tostring"], path, warm)
            charts = times["load_charts"], times["lxml"]
            self.rows += [
                compare(label, "load", "lxml.etree.parse", (times["load"], times["lxml"]), 6),
                compare(label, _CHARTS, "lxml.etree.parse", charts, 5 if "TwinCAT" in what else None),
                compare(label, "load, read all", "lxml.etree.parse", (times["load_all"], times["lxml"])),
                compare(label, "save, unedited", "lxml.etree.tostring", (times["save"], times["tostring"]), 3),
            ]

    def exports(self, sizes: Sequence[int]) -> None:
        """Folders of ever more documents of TIA Portal: time and memory for each."""
        contestants = {
            "lxml_folder": ("lxml.etree.parse, one by one", None),
            "load": ("load", LINEAR),
            "load_all": ("load, read all", LINEAR),
            "save_home": ("save, unedited", LINEAR),
            "rename_home": ("rename a step, save", LINEAR),
        }
        points: dict[str, list[tuple[float, float]]] = {name: [] for name in contestants}
        warm = self.folder / "warm-export"
        generate_export(warm, 8)
        for size in sizes:
            path = self.folder / f"export-{size}"
            megabytes = generate_export(path, size) / 1e6
            label = f"folder of {size} blocks, {megabytes:.1f} MB"
            self.tell(label)
            times = race(list(contestants), path, warm, rounds=2)
            for name, each in times.items():
                points[name].append((size, each.best))
            if size == sizes[-1]:
                lxml = times["lxml_folder"]
                for name, (what, _) in list(contestants.items())[1:]:
                    self.rows.append(compare(label, what, "lxml.etree.parse", (times[name], lxml)))
                for name in ("load", "load_all"):
                    memory = times[name].megabytes
                    what = f"peak memory, {contestants[name][0]}"
                    ratio = memory / megabytes
                    self.rows.append(Row(label, what, "bytes of the files", memory, megabytes, "MB", ratio))
        for name, (what, limit) in contestants.items():
            (small, first), (large, last) = points[name][0], points[name][-1]
            file = f"folders of {small:.0f} to {large:.0f} blocks"
            row = Row(file, f"growth of {what}", "smallest", last / large, first / small, "s", exponent(points[name]))
            row.limit, row.growth = limit, True
            self.rows.append(row)

    def starting(self) -> None:
        """How long the command line takes to start."""
        self.tell("start of the command line")
        python = sys.executable
        ours = [python, "-c", "import sys; from plcopen_sfc.cli import main; sys.exit(main(sys.argv[1:]))"]
        times = process_times(
            {
                "imports": [python, "-c", "import lxml.etree, pydantic, typer"],
                "version": [*ours, "--version"],
                "formats": [*ours, "formats"],
            }
        )
        against = "import lxml.etree, pydantic, typer"
        self.rows += [
            compare("start", "plcopen-sfc --version", against, (times["version"], times["imports"]), 2),
            compare("start", "plcopen-sfc formats", against, (times["formats"], times["imports"])),
        ]

    def programs(self) -> None:
        """Our parser of structured text on all of the corpus and on generated sources, against blark on samples."""
        sources = structured_text.corpus()
        big = [("statements", "codesys", structured_text.generated(5))]
        start = [("statements", "codesys", structured_text.generated(SAMPLE / 1e6))]
        warm = structured_text.write(self.folder / "st-warm.json", [("statements", "codesys", "a := b + 1;")])
        if sources:
            self.texts("ST of the corpus", sources, warm)
        else:
            self.notes.append("no structured text of real files measured: that takes the corpus, and pytest")
        if structured_text.has_blark():
            if sources:
                sample, refused = structured_text.sample_for_blark(sources, SAMPLE)
                self.against_blark("sample of these bodies", sample, warm)
                self.notes.append(
                    f"{len(sample)} bodies in the sample; {refused} more were left out that blark refuses"
                )
            self.against_blark("start of the generated ST", start, warm)
        else:
            self.notes.append("blark is not measured: pip install blark")
        self.speed("generated ST", big, warm)
        points: list[tuple[float, float]] = []
        for size in ST_SIZES:
            text = structured_text.generated(size)
            path = structured_text.write(self.folder / "st-grow.json", [("statements", "codesys", text)])
            points.append((len(text) / 1e6, race(["st"], path, warm, rounds=3)["st"].best))
        (small, first), (large, last) = points[0], points[-1]
        row = Row(
            "1 to 8 MB", "growth of parsing ST", "smallest", last / large, first / small, "s/MB", exponent(points)
        )
        row.limit, row.growth = LINEAR, True
        self.rows.append(row)

    def texts(self, label: str, sources: list[structured_text.Source], warm: Path) -> None:
        """Texts that repeat: each of them once, and all as they come, with equal ones parsed once or each time."""
        self.speed(f"{label}, each text once", list(dict.fromkeys(sources)), warm)
        path = structured_text.write(self.folder / "st-all.json", sources)
        size = structured_text.megabytes(sources)
        times = race(["st", "st_anew"], path, warm, rounds=3)
        file = f"{label}, {size:.2g} MB"
        pair = (times["st"], times["st_anew"])
        self.rows.append(compare(file, "parse all, equal ones once", "each anew", pair, faster=True))

    def speed(self, label: str, sources: list[structured_text.Source], warm: Path) -> None:
        """A note of how many megabytes a second our parser reads."""
        self.tell(label)
        path = structured_text.write(self.folder / "st.json", sources)
        size = structured_text.megabytes(sources)
        best = race(["st"], path, warm, rounds=3)["st"].best
        self.notes.append(f"{label}: {len(sources)} texts, {size:.3g} MB, parsed with {size / best:.2f} MB/s")

    def against_blark(self, label: str, sources: list[structured_text.Source], warm: Path) -> None:
        """The same texts parsed by us and by blark."""
        self.tell(f"blark: {label}")
        path = structured_text.write(self.folder / "st-sample.json", sources)
        size = structured_text.megabytes(sources)
        times = race(["st", "st_blark"], path, warm, rounds=3)
        row = compare(
            f"{label}, {size * 1000:.0f} kB", "parse ST", "blark", (times["st"], times["st_blark"]), 100, faster=True
        )
        self.rows.append(row)
        ours, theirs = size / times["st"].best, size / times["st_blark"].best
        self.notes.append(f"{label}: {ours:.2f} MB/s, blark {theirs:.4f} MB/s")


def exponent(points: Sequence[tuple[float, float]]) -> float:
    """The exponent k of time = c * size^k, fitted to all points."""
    logs = [(math.log(size), math.log(time)) for size, time in points]
    x, y = (sum(each[axis] for each in logs) / len(logs) for axis in (0, 1))
    return sum((a - x) * (b - y) for a, b in logs) / sum((a - x) ** 2 for a, _ in logs)


def environment() -> dict[str, str]:
    """The machine and the versions."""
    processor = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if "model name" in line]
        processor = names[0] if names else processor
    found = {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "machine": f"{processor}, {os.cpu_count()} cores, {platform.system()}",
        "python": platform.python_version(),
        "plcopen_sfc": sfc.__version__,
        "libxml2": ".".join(map(str, etree.LIBXML_VERSION)),
    }
    for package in ("lxml", "pydantic", "lark", "xsdata", "plcopen", "blark"):
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            found[package] = "not installed"
    return found


def corpus_folder() -> Path:
    """Where the real files are, if they are."""
    return Path(os.environ.get("PLCOPEN_SFC_CORPUS") or jobs.SHARED / "corpus")


def largest_corpus_file() -> Path | None:
    """The largest real file, where there is a corpus."""
    return next(iter(sorted(corpus_folder().rglob(LARGEST))), None)


def table(rows: Sequence[Sequence[str]]) -> Iterator[str]:
    """A table in Markdown, aligned."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for index, row in enumerate(rows):
        yield "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |"
        if index == 0:
            yield "|" + "|".join("-" * (width + 2) for width in widths) + "|"


def _number(value: float, unit: str) -> str:
    if unit == "MB":
        return f"{value:.0f} MB"
    return f"{value * 1000:.3g} m{unit}" if value < 1 else f"{value:.2f} {unit}"


def print_report(bench: Bench, about: dict[str, str]) -> None:
    """Everything as Markdown."""
    print(", ".join(f"{name} {value}" if name not in {"date", "machine"} else value for name, value in about.items()))
    print()
    lines = [("file", "what", "against", "ours", "theirs", "ratio", "by wall", "goal", "reached")]
    for row in bench.rows:
        lines.append(
            (
                row.file,
                row.what,
                row.against,
                _number(row.ours, row.unit),
                _number(row.theirs, row.unit),
                f"size^{row.ratio:.2f}" if row.growth else f"{row.ratio:.2f}" + (" faster" if row.faster else ""),
                "" if row.wall is None else f"{row.wall:.2f}",
                row.goal,
                {True: "yes", False: "NO", None: ""}[row.reached],
            )
        )
    print("\n".join(table(lines)))
    if bench.growth:
        print()
        jobs_of = {"lxml": "lxml.etree.parse", "load": "load", "load_all": _EVERYTHING}
        cells = [("MB", *(f"{name}, {unit}" for name in jobs_of.values() for unit in ("ms/MB", "MB/MB")))]
        for size in dict.fromkeys(each["megabytes"] for each in bench.growth):
            of_size = {each["job"]: each for each in bench.growth if each["megabytes"] == size}
            cells.append(
                (
                    f"{size:.1f}",
                    *(
                        f"{of_size[job][key] / size * scale:.1f}"
                        for job in jobs_of
                        for key, scale in (("cpu", 1000), ("memory", 1))
                    ),
                )
            )
        print("\n".join(table(cells)))
    print()
    for note in bench.notes:
        print(f"- {note}")


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Measure plcopen_sfc against lxml, libxml2, xsdata and blark.")
    parser.add_argument("--size", type=float, default=10, metavar="MB", help="size of the generated files (default 10)")
    parser.add_argument("--corpus", type=Path, metavar="FILE", help=f"a real file (default: {LARGEST} of the corpus)")
    parser.add_argument("--only", choices=("files", "growth", "start", "st", "tia"), help="only this part")
    parser.add_argument("--quick", action="store_true", help="growth up to 10 MB only")
    parser.add_argument("--json", action="store_true", help="data instead of tables")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bench = Bench(folder, quiet=options.json)
        if options.only in (None, "files"):
            for dialect in ("TC6", "CODESYS"):
                path = folder / f"{dialect}.xml"
                generate(path, megabytes=options.size, codesys=dialect == "CODESYS")
                bench.file(f"{dialect}, {options.size:g} MB", path, codesys=dialect == "CODESYS")
            corpus = options.corpus or largest_corpus_file()
            if corpus is not None and corpus.is_file():
                label = f"real, {corpus.stat().st_size / 1e6:.1f} MB"
                bench.file(label, corpus, codesys=b"3s-software" in corpus.read_bytes())
            else:
                bench.notes.append(f"no real file measured: {corpus or LARGEST} is not there (--corpus FILE)")
        if options.only in (None, "growth"):
            bench.growing([size for size in SIZES if size <= 10 or not options.quick])
        if options.only in (None, "start"):
            bench.starting()
        if options.only in (None, "tia"):
            bench.documents()
            bench.exports([blocks for blocks in BLOCKS if blocks <= 1000 or not options.quick])
        if options.only in (None, "st"):
            bench.programs()
    about = environment()
    if options.json:
        rows = [asdict(row) | {"reached": row.reached} for row in bench.rows]
        print(json.dumps({"environment": about, "rows": rows, "growth": bench.growth, "notes": bench.notes}, indent=2))
    else:
        print_report(bench, about)


if __name__ == "__main__":
    main()
