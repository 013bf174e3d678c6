"""Try mutants of all formats for as long as is wanted, and keep those that break something.

    python -m tests.fuzz --first 0 --count 100000 --keep /tmp/fuzz

`--formats scl,json` tries those only. Kept are the first three mutants of each kind of fault, with what came of them.
"""

from __future__ import annotations

import argparse
import faulthandler
import time
from collections import Counter
from pathlib import Path

from tests.fuzz.mutation import FORMATS, mutant
from tests.fuzz.trial import faults

_KEPT = 3


def main() -> None:
    """Run what the arguments say."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=1000, help="mutants, all formats together")
    parser.add_argument("--formats", default=",".join(FORMATS))
    parser.add_argument("--keep", type=Path, default=Path("fuzz-found"))
    arguments = parser.parse_args()
    formats = arguments.formats.split(",")
    arguments.keep.mkdir(parents=True, exist_ok=True)
    faulthandler.enable()
    kinds: Counter[str] = Counter()
    started = time.monotonic()
    for number in range(arguments.count):
        kind, seed = formats[number % len(formats)], arguments.first + number // len(formats)
        one = mutant(kind, seed)
        faulthandler.dump_traceback_later(300, exit=True)
        for fault in faults(one, seed):
            kinds[fault.kind] += 1
            if kinds[fault.kind] <= _KEPT:
                name = f"{kind}-{seed}"
                (arguments.keep / f"{name}.mutant").write_bytes(one.data)
                with (arguments.keep / f"{name}.txt").open("a") as log:
                    log.write(f"{fault.kind}\n{one.source}\n{fault.text}\n\n")
                print(f"{kind} {seed} ({one.source}): {fault.kind}", flush=True)
        if number % 1000 == 999:
            print(
                f"-- {number + 1} mutants, {time.monotonic() - started:.0f} s, {sum(kinds.values())} faults", flush=True
            )
    faulthandler.cancel_dump_traceback_later()
    print(f"{arguments.count} mutants, {time.monotonic() - started:.0f} s")
    for fault, count in kinds.most_common():
        print(f"{count:6} {fault}")


if __name__ == "__main__":
    main()
