"""Words and their bits at addresses: memory that some tools order otherwise, or keep apart."""

from __future__ import annotations

import pytest

import plcopen_sfc as sfc

CHART = """{plcopen_sfc format := 1}
{plcopen_sfc project.dialect := 'codesys'}
VAR_GLOBAL
  alarms AT %MW2 : WORD;
  hot AT %M_ : BOOL;
  go AT %IX0.0 : BOOL;
END_VAR
PROGRAM Main
VAR q : BOOL; END_VAR
INITIAL_STEP Init: END_STEP
TRANSITION FROM Init TO Fill := _CONDITION; END_TRANSITION
STEP Fill: q(N); END_STEP
TRANSITION FROM Fill TO Init := go; END_TRANSITION
END_PROGRAM
"""


def addresses_told(address: str, target: str, condition: str = "alarms = 1") -> list[str]:
    """Return what the report on a conversion to the target says of addresses."""
    text = CHART.replace("%M_", address).replace("_CONDITION", condition)
    name, _, flavour = target.partition(" for ")
    result = sfc.convert(sfc.loads(text.encode(), format="iec-text"), name, flavour=flavour, partial=True)
    return [
        item.why
        for item in result.report.losses
        if item.what == "address" and ("apart" in item.why or "another part" in item.why)
    ]


@pytest.mark.parametrize(
    ("target", "said"),
    [
        ("simaticml", "TIA Portal has the high byte of a word first, the source the low one"),
        (
            "iec-text for matiec",
            "matiec keeps `%MW2` apart from `%MX4.1`",
        ),
        ("plcopen-2.01 for beremiz", "beremiz keeps `%MW2` apart from"),
    ],
)
def test_a_bit_of_a_word_is_another_one(target: str, said: str) -> None:
    (told,) = addresses_told("%MX4.1", target)
    assert said in told
    assert not addresses_told("%MX6.1", target)  # of the next word
    (told,) = addresses_told("%MX9.1", target, "alarms = 1 AND %MW4 = 2")  # in a text
    assert "%MW4" in told


@pytest.mark.parametrize("target", ["codesys", "codesys-export"])
def test_tools_with_one_order_of_bytes_have_the_same_bit(target: str) -> None:
    assert not addresses_told("%MX4.1", target)
