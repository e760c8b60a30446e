"""Participating media in closed form, for NumPy and for Mitsuba 3."""

from ._plugins import register as _register

_register()
