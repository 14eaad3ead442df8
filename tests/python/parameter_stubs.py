# SPDX-License-Identifier: BSD-3-Clause
"""Writes the classes of parameters into agrisee/_agrisee.pyi, after a change of a parameter:

  PYTHONPATH=build/release/python python3 tests/python/parameter_stubs.py [--check]

--check: only say whether they are up to date.
"""
import os
import sys

from agrisee import Parameters

MARK = "# Parameters.\n"
METHODS = """\
    def __init__(self, preset: str = ..., **values: Any) -> None: ...
    @staticmethod
    def from_dict(values: Mapping[str, Any]) -> Parameters: ...
    @staticmethod
    def from_yaml(source: _Path) -> Parameters: ...
    def to_yaml(self) -> str: ...
    def expect_radii(self, smallest: float, largest: float) -> None: ...
    def check(self) -> None: ...
    def copy(self) -> Parameters: ...
    def __copy__(self) -> Parameters: ...
    def __deepcopy__(self, memo: Dict[int, Any]) -> Parameters: ...
    def __getstate__(self) -> Dict[str, Any]: ...
    def __setstate__(self, state: Dict[str, Any]) -> None: ...
"""
GROUP_METHODS = """\
    def __getstate__(self) -> Tuple[str, Dict[str, Any]]: ...
    def __setstate__(self, state: Tuple[str, Dict[str, Any]]) -> None: ...
"""


def stubs(group, done):
    """The lines of a group's class, after those of the groups within it."""
    before, fields = "", ""
    for name, value in group.to_dict().items():
        if isinstance(value, dict):
            inner = getattr(group, name)
            type_name = type(inner).__name__
            if type_name not in done:
                done.add(type_name)
                before += stubs(inner, done)
        else:
            type_name = type(value).__name__
        fields += f"    {name}: {type_name}\n"
    fields += "    __hash__: ClassVar[None]  # type: ignore[assignment]\n"
    fields += "    def to_dict(self) -> Dict[str, Any]: ...\n    def update(self, values: Mapping[str, Any]) -> None: ...\n"
    fields += "    def __eq__(self, other: object) -> bool: ...\n"
    fields += "    def __getattr__(self, name: str) -> Any: ...\n"
    fields += "    def __setattr__(self, name: str, value: Any) -> None: ...\n"
    own = METHODS if isinstance(group, Parameters) else GROUP_METHODS
    return f"{before}class {type(group).__name__}:\n{fields}{own}\n"


here = os.path.dirname(os.path.abspath(__file__))
path = os.path.join(here, "..", "..", "src", "python", "agrisee", "_agrisee.pyi")
with open(path, encoding="utf-8") as file:
    text = file.read()
wanted = text[: text.index(MARK) + len(MARK)] + stubs(Parameters(), set()).rstrip("\n") + "\n"
if "--check" in sys.argv:
    sys.exit(0 if text == wanted else f"{path}: is out of date; run tests/python/parameter_stubs.py")
with open(path, "w", encoding="utf-8") as file:
    file.write(wanted)
