"""Try to get Python executed by what a project has in it: by the simulator, and by the proof of lowered code.

    python -m tests.fuzz.injection                  every text in every place
    python -m tests.fuzz.injection --every 40       one of forty of them

Every text in every field of a project that reaches generated code is an attempt, in each dialect. An audit hook notes
processes, sockets, the texts' own file and their own mark. A fault is what it notes, and an exception that is not of
this package.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from itertools import product

import plcopen_sfc as sfc
from plcopen_sfc import model as m

MARK = "plcopen_sfc.injected"
FILE = "plcopen_sfc_injected"
LOWERED = 40
"""One of so many attempts is lowered too."""

_DEED = f"__import__('sys').audit('{MARK}')"
_LOOSE = f"().__class__.__base__.__subclasses__()[0].__init__.__globals__['sys'].audit('{MARK}')"
TEXTS = (
    _DEED,
    f"{_DEED}\n",
    f"x\n{_DEED}\n",
    f"x; {_DEED}",
    f"x) or {_DEED} or (",
    f"x' or {_DEED} or '",
    f'x" or {_DEED} or "',
    f"x'''\n{_DEED}\n'''",
    f'x"""\n{_DEED}\n"""',
    f"\\' + {_DEED} + \\'",
    f"'$' + {_DEED} + '$'",
    f"$'{_DEED}$'",
    f"'$N' + {_DEED}",
    f"x # {_DEED}",
    f"x\r{_DEED}",
    f"x\u2028{_DEED}",
    f"x\x0c{_DEED}",
    f"{{{_DEED}}}",
    f"{{{{ {_DEED} }}}}",
    f"f'{{{_DEED}}}'",
    f"%s{_DEED}%(x)s",
    f"lambda: {_DEED}",
    f"[{_DEED} for _ in (1,)]",
    f"x if {_DEED} else x",
    f"T#1s{_DEED}",
    f"T#5s\n{_DEED}",
    f"INT#{_DEED}",
    f"16#{_DEED}",
    f"'text'); {_DEED}; ('",
    f"1 if {_DEED} else 2",
    f"x := 1; {_DEED};",
    f"x := '{_DEED}';",
    f"x := \"' + {_DEED} + '\";",
    f"IF x THEN {_DEED}; END_IF;",
    f"(* *) {_DEED} (* *)",
    f"x; // {_DEED}\n{_DEED};",
    _LOOSE,
    f"x.{_LOOSE}",
    "__builtins__",
    "__class__",
    "globals()",
    f'eval("{_DEED}")',
    f'exec("{_DEED}")',
    f"open('{FILE}', 'w')",
    "__import__('os').system('true')",
)


def project(place: str, text: str, dialect: m.Dialect) -> sfc.Project:
    """Return a program with a chart, an action, an enumeration and variables, with `text` in one place."""

    def put(here: str, usual: str) -> str:
        return text if here == place else usual

    enumeration = m.DataTypeDeclaration(
        name=put("type", "Colour"),
        type=m.EnumType(values=[m.EnumValue(name=put("value", "RED"), value=put("number", "1"))]),
    )
    number, words = m.ElementaryType(name=m.Elementary.INT), m.StringType(length=put("length", "20"))
    variables = [
        m.Variable(name=put("variable", "x"), type=number, initial=m.SimpleValue(text=put("initial value", "1"))),
        m.Variable(name="s", type=words, initial=m.SimpleValue(text=put("string", "'abc'"))),
        m.Variable(name="c", type=m.DerivedType(name=put("type name", "Colour"))),
        m.Variable(name="lamp", type=m.ElementaryType(name=m.Elementary.BOOL), address=put("address", "%QX0.0")),
    ]
    rows = [
        m.ActionAssociation(id=10, qualifier=m.Qualifier.N, target=put("target", "Fill")),
        m.ActionAssociation(
            id=11,
            qualifier=m.Qualifier.D,
            target="lamp",
            duration=put("duration", "T#10ms"),
            indicator=put("indicator", "lamp"),
        ),
        m.ActionAssociation(id=12, qualifier=m.Qualifier.N, body=m.StBody(text=put("inline", "x := 2;"))),
    ]
    steps = [
        m.Step(id=0, name=put("step", "S0"), initial=True, actions=rows),
        m.Step(id=1, name="S1"),
    ]
    steps[0].__dict__["max_time"] = put("time", "T#20ms")  # an assignment would refuse what files may hold
    transitions = [
        m.Transition(id=2, sources=[0], targets=[1], condition=m.Expression(text=put("condition", "x >= 2"))),
        m.Transition(id=3, sources=[1], targets=[0], condition=m.Expression(text="TRUE"), name=put("transition", "T1")),
    ]
    pou = m.Pou(
        name=put("POU", "Main"),
        kind=m.PouKind.PROGRAM,
        interface=m.Interface(sections=[m.VariableSection(variables=variables)]),
        bodies=[m.SfcBody(chart=m.SfcNetwork(steps=steps, transitions=transitions))],
        actions=[m.Action(name=put("action", "Fill"), body=m.StBody(text=put("statements", "s := 'y';")))],
    )
    return sfc.Project(name="Injection", pous=[pou], data_types=[enumeration], dialect=dialect)


PLACES = (
    """
    type,value,number,length,variable,string,address,target,duration,indicator,inline,step,time,condition,transition,POU,
    action,statements,initial value,type name
""".replace("\n    ", "")
    .strip()
    .split(",")
)


def attempts(every: int = 1) -> Iterator[tuple[str, str, m.Dialect]]:
    """Yield the place, the text and the dialect of each attempt."""
    yield from [each for number, each in enumerate(product(PLACES, TEXTS, m.Dialect)) if number % every == 0]


_REACHING = {MARK, "os.system", "os.exec", "os.fork", "os.posix_spawn", "subprocess.Popen", "socket.__new__"}


class _Watch:
    """The audit hook: it cannot be taken out again, so it is switched."""

    def __init__(self) -> None:
        self.is_on, self.seen = False, list[str]()
        sys.addaudithook(self._note)

    def _note(self, event: str, arguments: tuple[object, ...]) -> None:
        if self.is_on and (event in _REACHING or (event == "open" and FILE in str(arguments[0]))):
            self.seen.append(f"{event} {arguments!r:.100}")


def run(every: int = 1) -> tuple[Counter[str], list[str]]:
    """Make the attempts; return how they ended, and what must not be."""
    watch, ended, faults = _Watch(), Counter[str](), list[str]()

    def trial(what: str, name: str, deed: Callable[[], object]) -> None:
        watch.is_on = True
        try:
            deed()
            ended[f"{what}: ran"] += 1
        except sfc.SfcError:
            ended[f"{what}: refused"] += 1
        except Exception as error:  # whatever generated code raises
            faults.append(f"{name}: {type(error).__name__}: {error}")
        finally:
            watch.is_on = False
        if watch.seen:
            faults.append(f"{name}: reached {watch.seen[0]}")
            watch.seen.clear()

    trial("control", "control", lambda: eval(_DEED))  # noqa: S307  # the hook sees the mark
    if not faults:
        raise RuntimeError("the audit hook does not see what it is there for")
    faults.clear()
    for dialect in m.Dialect:  # imports what is imported late
        usual = project("", "", dialect)
        sfc.simulate(usual, scans=5)
        sfc.lower(usual)
    for number, (place, text, dialect) in enumerate(attempts(every)):
        name = f"{dialect} {place} {text!r}"
        try:
            given = project(place, text, dialect)
        except sfc.SfcError:
            ended["refused by the model"] += 1
            continue
        trial("simulation", name, lambda given=given: sfc.simulate(given, scans=5))
        if number % LOWERED == 0:
            trial("lowering", name, lambda given=given: sfc.lower(given))
    return ended, faults


def main() -> None:
    """Run what the arguments say."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--every", type=int, default=1)
    ended, faults = run(parser.parse_args().every)
    counts = [f"{count:6} {what}" for what, count in sorted(ended.items())]
    sys.stdout.write("\n".join([*counts, *faults[:50], f"{len(faults)} faults", ""]))
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
