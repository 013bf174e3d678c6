"""Compile textual IEC 61131-3 with matiec, run the C code that it makes scan by scan, and read the variables.

matiec is an IEC 61131-3 compiler by other authors, which Beremiz and OpenPLC Editor use. It is no part of this project
and no dependency of it: tests that use this module skip where ``iec2c`` is not on the PATH. Its library of standard
blocks is looked for in ``$MATIEC_LIB``, then in a folder ``lib`` beside the program. A C compiler is needed too.

    machine = require_matiec().build(text, tmp_path)          # raises MatiecError where the compiler refuses the text
    trace = machine.run([{"start": True}, {}, {}], watch=["lamp", "S1.X", "counter"])

`build` appends a configuration with one task where the text has none. Names are those of the text, without regard to
case: ``variable`` of the program, ``block.member``, ``Step.X``, ``Step.T``, ``Action.Q``, and global variables. BOOL is
a `bool`; integers, enumerations and bit strings are an `int`, times an `int` of nanoseconds, as in simulations.
"""

from __future__ import annotations

import atexit
import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

Value = bool | int | float | str

_TIMES = ("TIME", "DATE", "TOD", "DT")
_REALS = ("REAL", "LREAL")
_POINTERS = ("EXT", "IN", "OUT", "MEM")
_PROGRAM = re.compile(r"^\s*PROGRAM\s+(\w+)", re.IGNORECASE | re.MULTILINE)
_LOCATED = re.compile(r"__LOCATED_VAR\(\s*(\w+)\s*,\s*(\w+)")
_SECONDS = 20
"""The compiler does not end for some wrong texts."""


class MatiecError(Exception):
    """A text that matiec or the C compiler does not take; `stage` is the name of the one that refuses it."""

    def __init__(self, stage: str, output: str) -> None:
        super().__init__(f"{stage}: {output.strip()[:2000]}")
        self.stage = stage


@dataclass(frozen=True)
class CompiledVariable:
    """A variable of the compiled program: its type, and the C expression of its value."""

    type: str
    code: str


@dataclass(frozen=True)
class CompiledProgram:
    """A compiled program. `period` is the time of a scan in nanoseconds."""

    executable: Path
    variables: Mapping[str, CompiledVariable]
    program: str
    period: int

    def names(self) -> list[str]:
        """The variables that can be watched, in capitals: those of the program, then global ones by their paths."""
        return list(self.variables)

    def run(
        self, scans: Sequence[Mapping[str, Value]], watch: Sequence[str], *, period: int | None = None
    ) -> list[dict[str, Value]]:
        """Run as many scans as `scans` has items, and return what is watched after each.

        An item has the variables that are set before its scan; the others keep what they have. The clock is at 0
        in the first scan. `period` is the time of a scan in nanoseconds where it shall not be that of the task.
        """
        index = {name: number for number, name in enumerate(self.variables)}
        lines = [f"{period or self.period} {len(watch)}"]
        lines += [str(index[self._found(name)]) for name in watch]
        for values in scans:
            lines += [f"{index[self._found(name)]} {_number(value)}" for name, value in values.items()]
            lines.append("-1")
        done = subprocess.run(
            [str(self.executable)],
            input="\n".join(lines) + "\n",
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            check=False,
        )
        if done.returncode:
            raise MatiecError("program", f"it ended with {done.returncode}")
        types = [self.variables[self._found(name)].type for name in watch]
        return [
            {name: _value(word, kind) for name, word, kind in zip(watch, line.split("\t"), types, strict=True)}
            for line in done.stdout.splitlines()
        ]

    def _found(self, name: str) -> str:
        if name.upper() not in self.variables:
            raise KeyError(f"the program {self.program} has no variable {name}; it has {', '.join(self.variables)}")
        return name.upper()


@dataclass(frozen=True)
class Matiec:
    """An installed matiec: the compiler, its library, and a C compiler."""

    compiler: Path
    library: Path
    cc: Path

    def translate(self, text: str, folder: Path) -> None:
        """Compile `text` to C in `folder`. Raises `MatiecError`."""
        folder.mkdir(parents=True, exist_ok=True)
        source = folder / "program.st"
        source.write_text(text, encoding="utf-8")
        _call("iec2c", [self.compiler, "-I", self.library, "-T", folder, source])

    def build(self, text: str, folder: Path, *, program: str = "", period_ms: int = 10) -> CompiledProgram:
        """Compile `text` in `folder`, and get the instance of `program` (the first one) ready to run.

        `period_ms` is the interval of the task where the text has no configuration. Raises `MatiecError`.
        """
        if not re.search(r"^\s*CONFIGURATION\b", text, re.IGNORECASE | re.MULTILINE):
            found = program or _PROGRAM.findall(text)[-1]
            text += (
                f"\nCONFIGURATION Config0\n  RESOURCE Res0 ON PLC\n    TASK Task0(INTERVAL := T#{period_ms}ms, "
                f"PRIORITY := 0);\n    PROGRAM Inst0 WITH Task0 : {found};\n  END_RESOURCE\nEND_CONFIGURATION\n"
            )
        self.translate(text, folder)
        table = (folder / "VARIABLES.csv").read_text(encoding="utf-8")
        instance, kind = _instance(table, program)
        variables = _variables(table, instance)
        period = int(table.split("// Ticktime")[1].split()[0])
        (folder / "main.c").write_text(_main(folder, instance, kind, variables), encoding="utf-8")
        skipped = ("POUS.c",)
        sources = sorted(path for path in folder.glob("*.c") if path.name not in skipped)
        executable = folder / "program"
        include = ["-I", _compiled_header(self), "-I", self.library / "C", "-I", folder]
        _call("cc", [self.cc, "-w", "-O0", *include, "-o", executable, *sources, "-lm"])
        return CompiledProgram(executable, variables, kind, period)


@cache
def _compiled_header(matiec: Matiec) -> Path:
    """A folder with the header of matiec's library, compiled once: that is half of the time of building a program."""
    folder = Path(tempfile.mkdtemp(prefix="matiec-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    header = Path(shutil.copy(matiec.library / "C" / "iec_std_lib.h", folder))
    make = ["-w", "-O0", "-I", matiec.library / "C", "-x", "c-header", header, "-o", folder / f"{header.name}.gch"]
    _call("cc", [matiec.cc, *make])
    return folder


@cache
def find_matiec() -> Matiec | None:
    """The matiec on the PATH; None where it, its library or a C compiler is missing."""
    compiler, cc = shutil.which("iec2c"), shutil.which("gcc") or shutil.which("cc")
    if compiler is None or cc is None:
        return None
    path = Path(compiler).resolve()
    library = Path(os.environ.get("MATIEC_LIB") or path.parent / "lib")
    return Matiec(path, library, Path(cc)) if (library / "C").is_dir() else None


def require_matiec() -> Matiec:
    """The matiec on the PATH; skips the test where there is none."""
    found = find_matiec()
    if found is None:
        pytest.skip("no iec2c on the PATH with its lib beside it or in $MATIEC_LIB, or no C compiler")
    return found


def _call(stage: str, command: Sequence[str | Path]) -> None:
    try:
        done = subprocess.run(
            [str(word) for word in command],
            capture_output=True,
            text=True,
            timeout=_SECONDS,
            errors="replace",
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise MatiecError(stage, f"it does not end within {_SECONDS} s") from None
    if done.returncode:
        raise MatiecError(stage, done.stdout + done.stderr)


def _instance(table: str, program: str) -> tuple[str, str]:
    """The path of the instance of a program, and the program's name, both in capitals."""
    rows = [line.split(";") for line in table.split("// Variables", maxsplit=1)[0].splitlines() if line[:1].isdigit()]
    for _, path, kind, *_ in rows:
        if not program or kind == program.upper():
            return path, kind
    raise MatiecError("iec2c", f"no instance of a program {program}")


def _variables(table: str, instance: str) -> dict[str, CompiledVariable]:
    """The variables of an instance by their paths in it, then the global ones by theirs."""
    _, resource, name = instance.split(".")
    own: dict[str, CompiledVariable] = {}
    others: dict[str, CompiledVariable] = {}
    for row in table.split("// Variables")[1].split("// Ticktime", maxsplit=1)[0].splitlines():
        _, *fields = row.split(";")
        if len(fields) < 5 or fields[0] == "FB":
            continue
        use, path, code, _, kind = fields[:5]
        if "->" in path:
            continue
        if path.startswith(f"{instance}."):
            code = f"{resource}__{name}.{code.removeprefix(f'{instance}.')}.value"
            own[path.removeprefix(f"{instance}.")] = CompiledVariable(kind, f"(*{code})" if use in _POINTERS else code)
            if "__step_list[" in code:
                short = path.removeprefix(f"{instance}.")[: -len("X")]
                own[f"{short}T"] = CompiledVariable("TIME", code.replace("].X.", "].T."))
        elif path.count(".") == 1:
            code = f"{code.replace('.', '__')}.value"
            others[path.split(".")[1]] = CompiledVariable(kind, f"(*{code})" if use in _POINTERS else code)
    return {**others, **own}


def _main(folder: Path, instance: str, kind: str, variables: Mapping[str, CompiledVariable]) -> str:
    """The C code that sets variables, runs scans and prints variables, as `CompiledProgram.run` tells it."""
    _, resource, name = instance.split(".")
    located = _LOCATED.findall((folder / "LOCATED_VARIABLES.h").read_text(encoding="utf-8"))
    places = "\n".join(f"{kind} of_{place}; {kind} *{place} = &of_{place};" for kind, place in dict.fromkeys(located))
    outside = dict.fromkeys(
        (re.sub(r"[(*)]|\.value", "", v.code), v.type, v.code)
        for v in variables.values()
        if f"{resource}__{name}." not in v.code
    )
    declared = "\n".join(f"extern __IEC_{t}_{'p' if c.startswith('(*') else 't'} {n};" for n, t, c in outside)
    sets = "\n".join(f"    case {i}: {_set(v)} break;" for i, v in enumerate(variables.values()))
    shows = "\n".join(f"    case {i}: {_show(v)} break;" for i, v in enumerate(variables.values()))
    return f"""#include "iec_std_lib.h"
#include <stdio.h>
#include <stdlib.h>
#include "accessor.h"
#include "POUS.h"
TIME __CURRENT_TIME;
BOOL __DEBUG = 0;
{places}
extern {kind} {resource}__{name};
{declared}
void config_init__(void);
void config_run__(unsigned long tick);

static void set(int index, const char *word) {{
  switch (index) {{
{sets}
  }}
}}

static void show(int index) {{
  switch (index) {{
{shows}
  }}
}}

int main(void) {{
  long long period, now = 0;
  int count, index, i;
  unsigned long tick = 0;
  char word[200];
  if (scanf("%lld %d", &period, &count) != 2) return 2;
  int watched[count + 1];
  for (i = 0; i < count; i++) if (scanf("%d", watched + i) != 1) return 2;
  config_init__();
  while (scanf("%d", &index) == 1) {{
    if (index >= 0) {{
      if (scanf("%199s", word) != 1) return 2;
      set(index, word);
      continue;
    }}
    __CURRENT_TIME.tv_sec = now / 1000000000LL;
    __CURRENT_TIME.tv_nsec = now % 1000000000LL;
    config_run__(tick++);
    now += period;
    for (i = 0; i < count; i++) {{
      if (i) putchar('\\t');
      show(watched[i]);
    }}
    putchar('\\n');
  }}
  return 0;
}}
"""


def _set(variable: CompiledVariable) -> str:
    if variable.type in _TIMES:
        code = variable.code
        return f"{code}.tv_sec = atoll(word) / 1000000000LL; {code}.tv_nsec = atoll(word) % 1000000000LL;"
    if variable.type in _REALS:
        return f"{variable.code} = atof(word);"
    return "" if "STRING" in variable.type else f"{variable.code} = atoll(word);"


def _show(variable: CompiledVariable) -> str:
    code = variable.code
    if variable.type in _TIMES:
        return f'printf("%lld", (long long){code}.tv_sec * 1000000000LL + {code}.tv_nsec);'
    if variable.type in _REALS:
        return f'printf("%.17g", (double){code});'
    if "STRING" in variable.type:
        return f'printf("%.*s", (int){code}.len, (char *){code}.body);'
    return f'printf("%lld", (long long){code});'


def _number(value: Value) -> str:
    return str(int(value)) if isinstance(value, bool) else str(value)


def _value(word: str, kind: str) -> Value:
    if kind == "BOOL":
        return word != "0"
    if kind in _REALS:
        return float(word)
    return word if "STRING" in kind else int(word)
