"""The C library through cffi. maturin makes this package when the wheel is built; C has no types that Python would know."""

from typing import Any

ffi: Any
lib: Any
