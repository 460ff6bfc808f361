"""From Python's objects to C's and back: structs are dataclasses whose fields have the names of C's."""

from __future__ import annotations

import dataclasses
import functools
import typing
from collections.abc import Callable
from typing import Annotated, Any, TypeVar

import numpy as np
import numpy.typing as npt

from ._native import ffi
from .enums import Status
from .errors import Error

Floats = npt.NDArray[np.float64]
Floats32 = npt.NDArray[np.float32]
Vector3 = Annotated[Floats, (3,)]
Matrix3 = Annotated[Floats, (3, 3)]

T = TypeVar("T")


def check(status: int) -> None:
    """Raises Error for every status but OK."""
    if status != Status.OK:
        raise Error(Status(status))


def pointer(kind: str, array: npt.NDArray[Any] | None) -> Any:
    """The address of an array's first byte; the caller keeps the array until C has returned."""
    return ffi.NULL if array is None else ffi.cast(kind, array.__array_interface__["data"][0])


def workspace(size: int) -> npt.NDArray[np.uint8]:
    """Memory for one call; a size of zero says that C refuses the arguments, which the call itself will explain."""
    return np.empty(max(size, 8), np.uint8)


def fill(struct: Any, values: Any) -> None:
    """Sets a struct's fields to those of a dataclass."""
    for field in dataclasses.fields(values):
        value = getattr(values, field.name)
        if dataclasses.is_dataclass(value):
            fill(getattr(struct, field.name), value)
            continue
        try:
            setattr(struct, field.name, value)
        except (OverflowError, TypeError) as error:
            raise ValueError(f"{field.name} = {value!r}: {error}") from None


def params(kind: str, set_defaults: Callable[[Any], int], values: Any) -> Any:
    """C's parameters: its defaults, and over them the fields of a dataclass."""
    struct = ffi.new(f"{kind} *")
    check(set_defaults(struct))
    fill(struct[0], values)
    return struct


@functools.cache
def _readers(kind: Any) -> dict[str, Callable[[Any], Any]]:
    """For each field that C has, what makes Python's value of it."""
    hints = typing.get_type_hints(kind, include_extras=True)
    named = {field.name: hints[field.name] for field in dataclasses.fields(kind)}
    return {name: _reader(hint) for name, hint in named.items() if name not in getattr(kind, "_not_in_c", ())}


def _reader(hint: Any) -> Callable[[Any], Any]:
    if typing.get_origin(hint) is Annotated:  # an array, and its shape
        kind, shape = typing.get_args(hint)
        dtype = typing.get_args(typing.get_args(kind)[1])[0]
        return lambda value: np.frombuffer(ffi.buffer(value), dtype).reshape(shape).copy()
    if typing.get_origin(hint) is tuple:  # an array of structs
        of = typing.get_args(hint)[0]
        return lambda value: tuple(read(of, item) for item in value)
    assert isinstance(hint, type), hint
    if dataclasses.is_dataclass(hint):
        return functools.partial(read, hint)
    return hint  # int, float, bool or an enum


def read(kind: type[T], struct: Any, /, **others: object) -> T:
    """A dataclass of what C wrote, and of fields that C does not have."""
    values = {name: reader(getattr(struct, name)) for name, reader in _readers(typing.cast("Any", kind)).items()}
    return kind(**values, **others)
