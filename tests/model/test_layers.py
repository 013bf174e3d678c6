"""The model needs nothing above it, and its methods that need more find it."""

from __future__ import annotations

import ast
import graphlib
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
BELOW = {"collector", "diagnostics", "errors", "grouping", "model", "operations"}


def named_modules(tree: ast.AST) -> Iterator[str]:
    """Modules of the package that code names: in imports of any kind, or in strings; not those for type checkers."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.If) and isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING":
            continue
        if isinstance(node, ast.ImportFrom):
            yield node.module or ""
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and " " not in node.value:
            yield node.value
        yield from named_modules(node)


def test_no_module_of_the_model_names_a_higher_layer():
    modules = sorted((ROOT / "plcopen_sfc" / "model").glob("*.py"))
    assert len(modules) > 10
    for path in [*modules, ROOT / "plcopen_sfc" / "operations.py"]:
        for name in named_modules(ast.parse(path.read_text(encoding="utf-8"))):
            if name.startswith("plcopen_sfc."):
                assert name.split(".")[1] in BELOW, f"{path.name} names {name}"


DEFINED = re.compile(r"^ *(?:def|class) (\w+)|^(\w+)(?:: .*)? =|^    (\w+):(?: |$)|^    ([A-Z]\w*) =", re.MULTILINE)
CLASS = re.compile(r"^class ([A-Z]\w*)", re.MULTILINE)
IMPORT = re.compile(r"^ *(?:from (plcopen_sfc[\w.]*) import (\([^)]*\)|.*)|import (plcopen_sfc[\w.]*))", re.MULTILINE)


def test_no_modules_import_each_other_in_a_circle():
    """Late imports and those for annotations count: of such a circle no module can be understood or moved alone."""
    paths = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in (ROOT / "plcopen_sfc").rglob("*.py")
    }
    imports = {}
    for module, path in paths.items():
        found = set()
        for package, names, alone in IMPORT.findall(path.read_text(encoding="utf-8")):
            parts = {f"{package}.{name}" for name in re.findall(r"\w+", names)} & paths.keys()
            found |= parts or {package or alone}
        imports[module] = found & paths.keys() - {module}
    assert sum(map(len, imports.values())) > 3000
    graphlib.TopologicalSorter(imports).prepare()  # a `CycleError` names the modules


def test_a_name_of_a_module_or_a_public_class_means_one_thing():
    """Packages of one subject in several layers, such as `grafcet`, share its name; modules do not."""
    paths = [path for path in (ROOT / "plcopen_sfc").rglob("*.py") if path.stem not in {"__init__", "__main__"}]
    classes = [name for path in paths for name in CLASS.findall(path.read_text(encoding="utf-8"))]
    assert len(paths) > 300
    assert len(classes) > 500
    for names in ([path.stem for path in paths], classes):
        assert {name for name, count in Counter(names).items() if count > 1} == set()


def test_each_package_maps_its_modules_and_contributing_names_files_that_there_are():
    """A stranger finds a module by the docstring of its package; that of the whole one is in CONTRIBUTING."""
    unmapped = []
    for init in (ROOT / "plcopen_sfc").rglob("*/__init__.py"):
        told = ast.get_docstring(ast.parse(init.read_text(encoding="utf-8"))) or ""
        modules = {path.stem for path in init.parent.glob("*.py")} | {
            path.parent.name for path in init.parent.glob("*/__init__.py")
        }
        named = {word for _, code in re.findall(r"(`+)(.+?)\1", told) for word in re.findall(r"\w+", code)}
        unmapped += [str(init.parent / name) for name in sorted(modules - named - {"__init__"})]
    assert unmapped == []
    contributing = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`(?:[\w/]+/)?(\w+\.py)`", contributing))
    known = {path.name for folder in ("plcopen_sfc", "tests") for path in (ROOT / folder).rglob("*.py")}
    assert len(named) > 40
    assert named - known == set()
    stations = set(re.findall(r"`([A-Za-z_]\w+)`", contributing[contributing.index("## Where things are") :]))
    assert len(stations) > 40
    assert stations - {"iec2c", "mypy", "corpus", "lib", "MATIEC_LIB", "diff"} - set(_defined()) == set()


def _defined() -> Iterator[str]:
    """Yield the names of functions, classes, fields and constants of the package."""
    for path in (ROOT / "plcopen_sfc").rglob("*.py"):
        yield from (name for names in DEFINED.findall(path.read_text(encoding="utf-8")) for name in names if name)


@pytest.mark.slow
def test_methods_of_higher_layers_work_where_only_the_model_was_imported():
    script = """
import sys
from plcopen_sfc.model import SfcNetwork
chart = SfcNetwork()
chart.add_step("S1", initial=True)
print("plcopen_sfc.refactor.rename" in sys.modules)
chart.rename_step("S1", "Init")
print(chart.steps[0].name)
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True, text=True, cwd=ROOT)
    assert done.stdout.split() == ["False", "Init"]
