"""Textual IEC 61131-3, with sequential function charts."""
