# SPDX-License-Identifier: BSD-3-Clause
"""Makes the functions and methods of the extension module functions of Python.

They have signatures, can be pickled by their names, and say which argument is wrong. Those of the extension module list
all signatures instead, and print all arguments.
"""
import difflib
import functools
import inspect
import os
import reprlib
from typing import Any, Callable, Dict, Tuple

from . import _agrisee


def _is_number(value: Any) -> bool:
    try:
        return not isinstance(value, (str, bytes)) and float(value) is not None
    except (TypeError, ValueError, OverflowError):
        return False


# For each type in the signatures: what an argument must be, and whether a value is.
_TYPES: Dict[str, Tuple[str, Callable[[Any], bool]]] = {
    "int": ("a whole number", lambda value: hasattr(value, "__index__")),
    "float": ("a number", _is_number),
    "bool": ("True or False", lambda value: type(value).__name__ in ("bool", "bool_")),
    "str": ("a text", lambda value: isinstance(value, str)),
    "os.pathlike": ("a path", lambda value: isinstance(value, (str, bytes, os.PathLike))),
}


def _type(annotation: str) -> str:
    """The key in _TYPES of a type as pybind11 writes it: "int", or in later versions "typing.SupportsInt | ..."."""
    first = annotation.replace("Union[", "").split(",")[0].split(" |")[0]
    return first.replace("typing.Supports", "").lower()


def _signature(line: str) -> inspect.Signature:
    """The signature that begins a docstring of the extension module: "name(a: int, b: float = 1.0) -> c"."""
    names: Dict[str, Any] = {}
    exec("from __future__ import annotations\ndef function(" + line.partition("(")[2] + ": ...", names)
    return inspect.signature(names["function"])


def _shown(value: Any) -> str:
    """A value in a message: numbers and texts as they are, of others the type."""
    plain = value is None or isinstance(value, (bool, int, float, str))
    return reprlib.repr(value) if plain else type(value).__name__


def _complaint(name: str, signature: inspect.Signature, values: Tuple[Any, ...], keywords: Dict[str, Any]) -> str:
    """What is wrong with the arguments of a call that the extension module refused."""
    try:
        given = signature.bind(*values, **keywords).arguments
    except TypeError as error:
        unknown = [key for key in keywords if key not in signature.parameters]
        near = difflib.get_close_matches(unknown[0], signature.parameters, 1) if unknown else []
        return f"{name}(): {error}" + (f"; did you mean '{near[0]}'?" if near else "")
    types = {key: _type(str(each.annotation)) for key, each in signature.parameters.items()}
    for key, value in given.items():
        wanted, fits = _TYPES.get(types[key], ("", lambda value: True))
        if not fits(value):
            return f"{name}(): {key} must be {wanted}, got {_shown(value)}"
    for key, value in given.items():
        if types[key] == "int" and not 0 <= value < 2**31:
            return f"{name}(): {key} is out of range, got {value}"
    return f"{name}(): an argument has a wrong type, see help(agrisee.{name})"


def _python(function: Callable[..., Any], name: str) -> Callable[..., Any]:
    """A function of the extension module as a function of Python. name: that of its class, if any, and its own."""
    line, _, text = (function.__doc__ or "").partition("\n")
    signature = _signature(line)
    refusal = f"{function.__name__}(): incompatible "

    @functools.wraps(function)
    def call(*values: Any, **keywords: Any) -> Any:
        try:
            return function(*values, **keywords)
        except TypeError as error:
            if not str(error).startswith(refusal):
                raise
        raise TypeError(_complaint(name.replace(".__init__", ""), signature, values, keywords))

    bare = [each.replace(annotation=inspect.Parameter.empty) for each in signature.parameters.values()]
    call.__signature__ = inspect.Signature(bare)  # type: ignore[attr-defined]
    call.__doc__ = text.strip("\n")
    call.__qualname__ = name
    call.__module__ = _agrisee.__name__
    del call.__wrapped__  # type: ignore[attr-defined]
    return call


def _replace(owner: Any, name: str, prefix: str = "") -> None:
    """Replace an attribute of the extension module or of one of its classes, if it is a function with a signature."""
    function = getattr(owner, name)
    if (name.startswith("_") and name != "__init__") or not str(function.__doc__).startswith(name + "("):
        return
    static = isinstance(vars(owner)[name], staticmethod)
    try:
        replaced = _python(function, prefix + name)
    except SyntaxError:  # a default value that another version of pybind11 writes in another way: keep the function
        return
    setattr(owner, name, staticmethod(replaced) if static else replaced)


for _name, _value in list(vars(_agrisee).items()):
    _replace(_agrisee, _name)
    if isinstance(_value, type) and not issubclass(_value, Exception):
        for _member in list(vars(_value)):
            _replace(_value, _member, _name + ".")
