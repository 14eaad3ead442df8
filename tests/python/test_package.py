# SPDX-License-Identifier: BSD-3-Clause
"""What is installed can be imported, and pyproject.toml says what CMake does."""
import os
import re
import shutil
import subprocess
import sys

import agrisee
import pytest

SOURCE, BUILD = os.environ["AGRISEE_SOURCE"], os.path.dirname(os.environ["PYTHONPATH"].split(os.pathsep)[0])


def test_installed_package(tmp_path):
    cmake = shutil.which("cmake") or pytest.skip("no cmake")
    subprocess.run([cmake, "--install", BUILD, "--component", "python", "--prefix", tmp_path], check=True,
                   stdout=subprocess.DEVNULL)
    folder = tmp_path / "lib" / "python3" / "dist-packages"
    names = {name.split(".")[0] + "." + name.split(".")[-1] for name in os.listdir(folder / "agrisee")}
    assert {"__init__.py", "_agrisee.so", "_agrisee.pyi", "py.typed"} <= names
    program = "import agrisee; print(agrisee.__file__, agrisee.__version__)"
    done = subprocess.run([sys.executable, "-B", "-c", program], env={**os.environ, "PYTHONPATH": str(folder)},
                          cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout.split() == [str(folder / "agrisee" / "__init__.py"), agrisee.__version__]


def test_pyproject():
    tomllib = pytest.importorskip("tomllib")
    with open(os.path.join(SOURCE, "pyproject.toml"), "rb") as file:
        project = tomllib.load(file)
    build = project["tool"]["scikit-build"]
    version = build["metadata"]["version"]
    with open(os.path.join(SOURCE, version["input"]), encoding="utf-8") as file:
        assert re.search(version["regex"], file.read())["value"] == agrisee.__version__
    with open(os.path.join(SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
        options = file.read()
    assert all(f"option({name} " in options for name in build["cmake"]["define"])
    with open(os.path.join(SOURCE, "src", "python", "CMakeLists.txt"), encoding="utf-8") as file:
        commands = file.read()
    assert all(f"COMPONENT {name}" in commands for name in build["install"]["components"])
    assert all(f"pybind11_add_module({name} " in commands for name in build["cmake"]["targets"])


def test_everything_has_a_docstring():
    for name in agrisee.__all__:
        thing = getattr(agrisee, name)
        if name != "__version__" and not (isinstance(thing, type) and issubclass(thing, Exception)):
            assert thing.__doc__, name
            for member, value in vars(thing).items() if isinstance(thing, type) else ():
                if not member.startswith("_"):
                    assert value.__doc__, f"{name}.{member}"
