"""Arguments of wrong types, for each parameter of each public function: none leaves as an error of Python."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

import plcopen_sfc as sfc
from plcopen_sfc.documents.storage import OptionsBesideFormat, SaveOptions
from plcopen_sfc.lowering.lowering_options import LoweringOptions

TEXT = b"""
FUNCTION_BLOCK Fill
VAR_INPUT a : BOOL; END_VAR
VAR_OUTPUT q : BOOL; END_VAR
INITIAL_STEP Wait: END_STEP
STEP Run: q(N); END_STEP
TRANSITION FROM Wait TO Run := a; END_TRANSITION
TRANSITION FROM Run TO Wait := NOT a; END_TRANSITION
END_FUNCTION_BLOCK
"""
WRONG = {
    "huge": 10**5000,  # Python writes no such number
    "nothing": None,
    "bytes": b"x",
    "list": [5],
    "numbers": {5: 5},
    "object": object(),
    "nul": "\0",
    "surrogate": "\ud800",
}
EXTENSIVE = {"scans", "seed", "runs", "most_runs"}
"""Parameters that may be as great as a user likes: a huge number of them is a long run, and no error."""


def project() -> sfc.Project:
    return sfc.loads(TEXT, format="iec-text")


def right_arguments(folder: str) -> dict[str, tuple[list[Any], dict[str, Any]]]:
    """Arguments with which each function does something, those by place and those by name."""
    pou = project().pou("Fill")
    return {
        "check": ([project()], {}),
        "check_import": ([project(), "codesys"], {}),
        "check_syntax": ([project()], {}),
        "conversion_page": ([project(), sfc.convert(project(), "json").report], {}),
        "convert": ([project(), "json"], {}),
        "diff": ([project(), project()], {}),
        "diff_page": ([project(), project(), sfc.diff(project(), project())], {}),
        "draw": ([project(), f"{folder}/picture.svg"], {}),
        "dumps": ([project()], {}),
        "equivalent": ([pou, pou], {"runs": 1, "scans": 3}),
        "jump": (["Wait"], {}),
        "load": ([f"{folder}/none.xml"], {}),
        "loads": ([TEXT], {}),
        "lower": ([project()], {"verify": False}),
        "lower_to_file": ([project(), f"{folder}/lowered.st"], {"verify": False}),
        "merge_list": ([project(), project()], {}),
        "page": ([project()], {}),
        "save": ([project(), f"{folder}/saved.st"], {}),
        "selection": ([], {}),
        "simulate": ([project()], {"scans": 3}),
        "simultaneous": ([], {}),
        "step": (["S"], {}),
        "transition": (["a"], {}),
    }


OPTIONS: dict[str, type] = {
    "convert": OptionsBesideFormat,
    "dumps": SaveOptions,
    "lower": LoweringOptions,
    "lower_to_file": LoweringOptions,
    "save": SaveOptions,
}
FUNCTIONS = [name for name in sfc.__all__ if inspect.isfunction(getattr(sfc, name))]


def with_one_wrong(
    function: Callable[..., Any], right: tuple[list[Any], dict[str, Any]], more: Mapping[str, Any], wrong: object
) -> Iterator[tuple[str, list[Any], dict[str, Any]]]:
    """Yield the arguments with `wrong` for one of them, for each parameter and each of the options in `more`."""
    places, names = right
    for number, parameter in enumerate(inspect.signature(function).parameters.values()):
        if parameter.kind is parameter.VAR_POSITIONAL:
            yield parameter.name, [*places, wrong], names
        elif parameter.kind is not parameter.VAR_KEYWORD and number < len(places):
            yield parameter.name, [*places[:number], wrong, *places[number + 1 :]], names
        elif parameter.kind is not parameter.VAR_KEYWORD:
            yield parameter.name, places, {**names, parameter.name: wrong}
    for option in more:
        yield option, places, {**names, option: wrong}


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_wrong_argument_is_accepted_or_an_error_of_this_package(name: str, wrong: str, tmp_path: Any) -> None:
    function = getattr(sfc, name)
    more = OPTIONS[name].__annotations__ if name in OPTIONS else {}
    right = right_arguments(str(tmp_path))[name]
    tried = 0
    messages = []
    for parameter, places, names in with_one_wrong(function, right, more, WRONG[wrong]):
        tried += 1
        if wrong == "huge" and parameter in EXTENSIVE:
            continue
        try:
            function(*places, **names)
        except sfc.SfcError as error:
            messages.append(str(error))
        except Exception as error:  # what the test is for
            pytest.fail(f"{name}({parameter}={wrong}) raised {type(error).__name__}: {str(error)[:80]}")
    assert tried
    assert all(messages)


METHODS: dict[str, Callable[[sfc.Project, Any], object]] = {
    "Project.pou": lambda each, wrong: each.pou(wrong),
    "Project.find kind": lambda each, wrong: each.find("*", wrong),
    "Project.add_program": lambda each, wrong: each.add_program("Main", wrong),
    "Project.steps": lambda each, wrong: each.steps(max_time=wrong),
    "Project.steps reachable": lambda each, wrong: each.steps(reachable_from=wrong),
    "Pou.add_variable": lambda each, wrong: each.pous[0].add_variable("x", kind=wrong),
    "Pou.add_action": lambda each, wrong: each.pous[0].add_action("Act", wrong),
    "Pou.find_action": lambda each, wrong: each.pous[0].find_action(wrong),
    "Interface.section_like": lambda each, wrong: each.pous[0].interfaces()[0].section_like(wrong),
    "SfcNetwork.step": lambda each, wrong: each.pous[0].chart.step(wrong),
    "SfcNetwork.label": lambda each, wrong: each.pous[0].chart.label(wrong),
    "SfcNetwork.add_step": lambda each, wrong: each.pous[0].chart.add_step("New", actions=wrong),
    "SfcNetwork.add_sequence": lambda each, wrong: each.pous[0].chart.add_sequence(wrong),
    "Step.max_time": lambda each, wrong: setattr(each.pous[0].chart.steps[0], "max_time", wrong),
    "Step.comment": lambda each, wrong: setattr(each.pous[0].chart.steps[0], "comment", wrong),
    "Editor.extract_action": lambda each, wrong: each.edit().extract_action("Fill.Run", "Act", wrong),
    "Editor.set": lambda each, wrong: each.edit().set("Fill.Run", comment=wrong),
}


@pytest.mark.parametrize("wrong", ["huge", "numbers", "object"])
@pytest.mark.parametrize("name", METHODS)
def test_methods_refuse_what_they_do_not_take(name: str, wrong: str) -> None:
    with pytest.raises(sfc.SfcError):
        METHODS[name](project(), WRONG[wrong])
