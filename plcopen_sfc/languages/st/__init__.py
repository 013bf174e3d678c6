"""Structured text: parsing, printing and editing."""

from plcopen_sfc.languages.st.parsing import Parsed, parse_expression, parse_statements

__all__ = ["Parsed", "parse_expression", "parse_statements"]
