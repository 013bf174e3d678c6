"""Functions of a library that programs call and no file has, for `--functions` of `simulate` and `lower`."""


def Weight(raw: int) -> int:  # noqa: N802  # the name that programs call
    """Return the weight in grams that a scale shows as a raw value."""
    return raw * 5 // 64
