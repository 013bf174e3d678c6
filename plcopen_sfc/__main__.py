"""``python -m plcopen_sfc`` is ``plcopen-sfc``."""

from __future__ import annotations

import sys

from plcopen_sfc.cli import main

sys.exit(main())
