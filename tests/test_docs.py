"""The documentation says what is true: its examples run, its links lead somewhere, its lists are complete."""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from urllib.parse import urlsplit

import pytest

import plcopen_sfc
from plcopen_sfc.cli import main
from plcopen_sfc.errors import SfcError

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(DOCS.rglob("*.md"))]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class CodeBlock(NamedTuple):
    """A code block of a page."""

    language: str
    text: str
    line: int


def blocks(page: Path) -> list[CodeBlock]:
    text = page.read_text(encoding="utf-8")
    return [CodeBlock(m[1], m[2], text.count("\n", 0, m.start()) + 2) for m in FENCE.finditer(text)]


def picture_below(page: Path, block: CodeBlock) -> bytes | None:
    """The picture that a page shows right below a code block: it is what the block makes."""
    behind = page.read_text(encoding="utf-8").splitlines()[block.line + block.text.count("\n") :]
    shown = re.match(r"\[?!\[[^\]]*\]\(([^)]+\.svg)\)", next((line for line in behind if line), ""))
    return (page.parent / shown[1]).read_bytes() if shown else None


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def agrees(expected: str, found: str) -> bool:
    """True if the output is as shown; a line ``...`` stands for any lines."""
    parts = re.split(r"^\.\.\.\n", expected, flags=re.MULTILINE)
    pattern = "(?:.*\n)*?".join(re.escape(part) for part in parts)
    return re.fullmatch(pattern, found) is not None


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the example files and scripts in it, as the current one."""
    for name in ("fixtures", "examples"):
        shutil.copytree(ROOT / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def command(arguments: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "200", "PYTHONIOENCODING": "utf-8"}
    return subprocess.run(
        [sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False
    )


RUN_PAGES = [page for page in PAGES if any(block.language in ("python", "console") for block in blocks(page))]


@pytest.mark.slow
@pytest.mark.parametrize("page", RUN_PAGES, ids=name_of)
def test_examples_of_a_page_run(
    page: Path, workplace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    names: dict[str, object] = {"__name__": "example"}
    found = blocks(page)
    for block, after in zip(found, [*found[1:], CodeBlock("", "", 0)], strict=True):
        if block.language == "python":
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                code = compile("\n" * (block.line - 1) + block.text, str(page), "exec")
                exec(code, names)  # noqa: S102
            if after.language in ("text", "diff"):
                assert agrees(after.text, printed.getvalue()), f"line {after.line} prints:\n{printed.getvalue()}"
            else:
                assert printed.getvalue() == ""
            if picture := picture_below(page, block):
                assert str(names["svg"]).encode("ascii") == picture
        elif block.language == "console":
            for call in re.split(r"^\$ ", block.text, flags=re.MULTILINE)[1:]:
                line, _, expected = call.partition("\n")
                program, *arguments = shlex.split(line)
                assert program == "plcopen-sfc"
                capsys.readouterr()
                main(arguments)
                result = capsys.readouterr()
                assert agrees(expected, result.out), f"{line} prints:\n{result.out}{result.err}"
            if picture := picture_below(page, block):
                (made,) = [each for each in arguments if each.endswith(".svg")]
                assert Path(made).read_bytes() == picture


# -- README and .ci/run -----------------------------------------------------------------------------------------------

README = ROOT / "README.md"


def marked_command(mark: str) -> str:
    match = re.search(rf"<!-- {mark} -->\n```sh\n(.*?)\n```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert match is not None
    return match[1]


@pytest.mark.slow
def test_the_first_command_shows_what_the_readme_shows(workplace: Path) -> None:
    last = shlex.split(marked_command("first command").split("&&")[-1])
    assert last[0] == ".venv/bin/plcopen-sfc"
    shown = next(block.text for block in blocks(README) if block.language == "text")
    result = command(["-m", "plcopen_sfc", *last[1:]], workplace)
    assert result.returncode == 0
    assert agrees(shown, result.stdout), result.stdout


@pytest.mark.slow
def test_commands_of_the_readme_are_single_lines_and_exist(workplace: Path) -> None:
    for block in blocks(README):
        if block.language != "sh":
            continue
        for part in block.text.strip().split("&&"):
            words = shlex.split(part)
            if words[0] == ".venv/bin/plcopen-sfc":
                result = command(["-m", "plcopen_sfc", *words[1:]], workplace)
                assert result.returncode == 0, result.stderr
            else:
                assert words[0] in ("python3", ".venv/bin/pip", ".venv/bin/python")
        assert block.text.count("\n") == 1


@pytest.mark.parametrize("mark", ["first command", "test command"])
def test_the_windows_commands_are_the_same(mark: str) -> None:
    windows = marked_command(mark).replace("python3 -m venv", "py -m venv").replace(".venv/bin/", ".venv\\Scripts\\")
    windows = " ".join(word.replace("/", "\\") if word.startswith("fixtures") else word for word in windows.split(" "))
    assert windows in README.read_text(encoding="utf-8")


@pytest.mark.skipif(shutil.which("bash") is None or shutil.which("awk") is None, reason="needs bash and awk")
def test_ci_runs_the_test_command_of_the_readme() -> None:
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert 'bash -c "set -o pipefail; $tests"' in script
    assert 'tests=$(readme_command "test command")' in script
    function = re.search(r"^readme_command\(\).*?^}", script, re.MULTILINE | re.DOTALL)
    assert function is not None
    result = subprocess.run(
        ["bash", "-c", f'{function[0]}\nreadme_command "test command"'],
        cwd=ROOT,
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    assert result.stdout.strip() == marked_command("test command")
    assert "pytest" in result.stdout


# -- lists that must be complete --------------------------------------------------------------------------------------


def codes_in_use() -> set[str]:
    sources = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "plcopen_sfc").rglob("*.py"))
    kinds = "SFC|XML|CDS|XSD|JSN|IEC|IMP|SCL|EXP|CEX|GRF|LST|TWC|LNG|DIR|LOW|SDF"
    return set(re.findall(rf"[\"'`]((?:{kinds})\d{{3}})[\"'`]", sources))


def documented_codes() -> set[str]:
    text = (DOCS / "diagnostics.md").read_text(encoding="utf-8")
    return set(re.findall(r"^\| (?:<a[^>]*></a>)?`?([A-Z]{3}\d{3})`? \|", text, re.MULTILINE))


def test_every_code_is_documented() -> None:
    assert codes_in_use() - documented_codes() == set()


def test_no_code_is_documented_that_nothing_uses() -> None:
    # XSD codes between 002 and 019 are named in a range where the table of reasons makes them
    assert documented_codes() - codes_in_use() == set()


def all_errors(base: type[SfcError] = SfcError) -> Iterator[type[SfcError]]:
    for kind in base.__subclasses__():
        yield kind
        yield from all_errors(kind)


def test_every_error_is_documented() -> None:
    text = (DOCS / "errors.md").read_text(encoding="utf-8")
    public = {kind.__name__ for kind in all_errors() if kind.__module__ == "plcopen_sfc.errors"}
    assert {name for name in public if f"`{name}`" not in text} == set()


def test_every_format_has_a_page() -> None:
    from plcopen_sfc.formats.registry import FORMATS  # noqa: PLC0415

    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for kind in FORMATS:
        assert (DOCS / "formats" / f"{kind.name}.md").is_file()
        assert f"| `{kind.name}` |" in text


def test_public_names_are_in_the_reference() -> None:
    text = (DOCS / "api.md").read_text(encoding="utf-8")
    assert {name for name in plcopen_sfc.__all__ if name not in text} == set()


LINK = re.compile(r"\]\(([^)#\s]*)(#[^)]*)?\)")
HEADING = re.compile(r"^#+ (.*?)(?: \{#([\w-]+)\})?$", re.MULTILINE)


def anchors(page: Path) -> set[str]:
    """The anchors that the site gives the headings of a page."""
    headings = HEADING.findall(FENCE.sub("", page.read_text(encoding="utf-8")))
    words = ((own, re.sub(r"[^\w\s-]", "", re.sub(r"\]\([^)]*\)", "", text)).strip().lower()) for text, own in headings)
    return {own or re.sub(r"[-\s]+", "-", plain) for own, plain in words}


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_lead_somewhere(page: Path) -> None:
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    for target, anchor in LINK.findall(text):
        if not target.startswith(("http:", "https:", "mailto:")):
            path = page.parent / target if target else page
            assert path.exists(), target
            assert not anchor or path.suffix != ".md" or anchor[1:] in anchors(path), target + anchor
        elif not target.startswith("mailto:"):
            place = urlsplit(target)  # no test asks the network
            assert place.scheme == "https", target
            assert re.fullmatch(r"[a-z0-9-]+(\.[a-z0-9-]+)+", place.netloc), target


def test_every_page_is_in_the_navigation() -> None:
    navigation = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    pages = {p.relative_to(DOCS).as_posix() for p in DOCS.rglob("*.md")}
    assert {page for page in pages if page not in navigation} == set()


# -- examples ---------------------------------------------------------------------------------------------------------


def example(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return command([str(ROOT / "examples" / arguments[0]), *arguments[1:]], folder)


@pytest.mark.slow
def test_list_charts(workplace: Path) -> None:
    result = example(workplace, "list_charts.py", "fixtures/codesys")
    assert result.returncode == 0, result.stderr
    assert "PLC_PRG.ACT_Home" in result.stdout
    assert "FB_Pusher" in result.stdout
    broken = example(workplace, "list_charts.py", "fixtures/broken")
    assert broken.returncode == 1
    assert "truncated.xml" in broken.stderr


@pytest.mark.slow
def test_build_chart_writes_the_same_chart_for_several_tools(workplace: Path) -> None:
    printed = example(workplace, "build_chart.py", ".").stdout.splitlines()
    assert [line.split()[1:] for line in printed] == [["0", "losses"]] * 3
    charts = [plcopen_sfc.load(workplace / line.split()[0]).pou("Main").chart for line in printed]
    assert {tuple(sorted(chart.labels().values())) for chart in charts} == {
        ("Drain -> Wait", "Fill -> Drain", "Fill -> Heat+Mix", "Heat+Mix -> Drain", "Wait -> Fill")
    }


@pytest.mark.slow
def test_rename_steps_shows_a_diff_and_then_does_it(workplace: Path) -> None:
    path = workplace / "fixtures" / "codesys" / "sorting_conveyor.xml"
    before = path.read_bytes()
    (workplace / "names.csv").write_text("Idle;Ready\nMeasure;Identify\n", encoding="utf-8")
    dry = example(workplace, "rename_steps.py", "names.csv", "fixtures/codesys", "--dry-run")
    assert dry.returncode == 0, dry.stderr
    assert path.read_bytes() == before
    removed = [line for line in dry.stdout.splitlines() if line.startswith("-") and not line.startswith("---")]
    assert removed
    assert all("Idle" in line or "Measure" in line for line in removed)
    assert any("Measure.t" in line for line in removed)  # program text follows
    done = example(workplace, "rename_steps.py", "names.csv", "fixtures/codesys")
    assert done.returncode == 0, done.stderr
    after = path.read_bytes()
    assert len(before.splitlines()) == len(after.splitlines())
    changed = [new for old, new in zip(before.splitlines(), after.splitlines(), strict=True) if old != new]
    assert len(changed) == len(removed)
    assert plcopen_sfc.load(path).pou("PLC_PRG").sfc.step("Ready").name == "Ready"


@pytest.mark.slow
def test_convert_folder(workplace: Path) -> None:
    result = example(workplace, "convert_folder.py", "fixtures/codesys", "out", "--to", "plcopen-2.01", "--partial")
    assert result.returncode == 0, result.stderr
    for source in (workplace / "fixtures" / "codesys").glob("*.xml"):
        assert plcopen_sfc.load(workplace / "out" / source.name).source.format == "plcopen"
        assert (workplace / "out" / f"{source.stem}.report.json").is_file()
    assert "translated" in result.stdout


@pytest.mark.slow
@pytest.mark.parametrize("file", ["plan.xml", "plan.st"])
@pytest.mark.parametrize("name", ["four_steps", "two_cylinders", "initialised_chain", "selection", "press"])
def test_a_grafcet_in_a_tool_that_calls_it_until_it_is_stable(workplace: Path, name: str, file: str) -> None:
    result = example(workplace, "until_stable.py", f"fixtures/grafcet/{name}.gct", file)
    assert result.stdout.startswith("equal (proof: "), result
    program = plcopen_sfc.load(workplace / file).pous[-1]
    given = plcopen_sfc.load(workplace / "fixtures" / "grafcet" / f"{name}.gct").pous[0].variables()
    assert {v.name.lstrip("_") for v in program.variables()} > {v.name for v in given}


@pytest.mark.slow
def test_the_pictures_of_the_documentation_are_those_of_today(tmp_path: Path) -> None:
    run = example(tmp_path, "draw_gallery.py", str(tmp_path))
    assert run.returncode == 0, run.stderr
    drawn = sorted(tmp_path.iterdir())
    pages = "".join(
        (DOCS / name).read_text(encoding="utf-8")
        for name in ("drawing.md", "pages.md", "gallery.md", "one-chart.md", "lowering.md")
    )
    for picture in drawn:
        assert picture.read_bytes() == (DOCS / "images" / picture.name).read_bytes(), "run examples/draw_gallery.py"
    assert {path.name for path in drawn} >= set(re.findall(r"\(images/([\w-]+\.svg)\)", pages))
