#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The manifests for colcon, vcpkg and Conan are well formed and name the same version, licence and libraries.

manifests_agree.py REPO VERSION. Conan itself is not needed: its recipe is run as far as it only states things.
"""
import fnmatch
import json
import pathlib
import re
import sys
import types
import xml.etree.ElementTree as xml

root, version = pathlib.Path(sys.argv[1]), sys.argv[2]
# One line a library: what each manager calls it.
LIBRARIES = [  # vcpkg, Conan, rosdep
    ("eigen3", "eigen", "eigen"),
    ("nanoflann", "nanoflann", "libnanoflann-dev"),
    ("yaml-cpp", "yaml-cpp", "yaml-cpp"),
    ("nlohmann-json", "nlohmann_json", "nlohmann-json-dev"),
    ("stb", "stb", "libstb-dev"),
    ("zlib", "zlib", "zlib"),
    ("cli11", None, "cli11"),
    ("sqlite3", None, None),
    ("catch2", None, "catch2"),
]


def agree(what, found, expected):
    if found != expected:
        sys.exit(f"{what}: {found!r}, expected {expected!r}")


def names(column):
    return {row[column] for row in LIBRARIES if row[column]}


changelog = (root / "CHANGELOG.md").read_text()
agree("CHANGELOG.md, newest version", re.search(r"^## ([0-9.]+)", changelog, re.M).group(1), version)

package = xml.parse(root / "package.xml").getroot()
agree("package.xml, version", package.findtext("version"), version)
agree("package.xml, license", package.findtext("license"), "BSD-3-Clause")
agree("package.xml, build_type", package.findtext("export/build_type"), "cmake")
depends = {e.text for e in package if e.tag in ("depend", "build_depend", "test_depend")}
agree("package.xml, libraries", depends, names(2))
for folder in ("examples/ros1", "examples/ros2"):
    agree(f"{folder}/package.xml, version", xml.parse(root / folder / "package.xml").findtext("version"), version)
    agree(f"{folder}/CMakeLists.txt, version of agrisee",
          re.search(r"find_package\(agrisee ([0-9.]+) ", (root / folder / "CMakeLists.txt").read_text()).group(1),
          version.rsplit(".", 1)[0])

vcpkg = json.loads((root / "vcpkg.json").read_text())
agree("vcpkg.json, version", vcpkg["version"], version)
agree("vcpkg.json, license", vcpkg["license"], "BSD-3-Clause")
depends = set(vcpkg["dependencies"]).union(*(f["dependencies"] for f in vcpkg["features"].values()))
agree("vcpkg.json, libraries", depends, names(0))
agree("vcpkg.json, default features that exist", set(vcpkg["default-features"]) <= set(vcpkg["features"]), True)

for name, members in {
    "conan": ["ConanFile"],
    "conan.tools": [],
    "conan.tools.cmake": ["CMake", "CMakeDeps", "CMakeToolchain", "cmake_layout"],
    "conan.tools.files": ["copy"],
}.items():
    sys.modules[name] = types.ModuleType(name)
    for member in members:
        setattr(sys.modules[name], member, type(member, (), {}))
sys.modules["conan.tools.files"].load = lambda _, path: pathlib.Path(path).read_text()
recipe_code = {}
exec(compile((root / "conanfile.py").read_text(), "conanfile.py", "exec"), recipe_code)
recipe = recipe_code["AgriseeConan"]()
recipe.recipe_folder = str(root)
recipe.set_version()
agree("conanfile.py, version", recipe.version, version)
agree("conanfile.py, license", recipe.license, "BSD-3-Clause")
# Conan builds and installs from a copy of what the recipe exports.
rules = (root / "cmake/AgriseeInstall.cmake").read_text()
installed = {path for paths in re.findall(r"install\((?:FILES|DIRECTORY)\s+(.+?)\s+DESTINATION", rules, re.S)
             for path in paths.split() if not path.startswith("$")}
agree("AgriseeInstall.cmake, installed files that the check finds", {"LICENSE", "package.xml"} <= installed, True)
files = [f for path in installed for f in [root / path, *(root / path).rglob("*")] if f.is_file()]
installed = {str(f.relative_to(root)) for f in files}
exported = {f for f in installed if any(fnmatch.fnmatch(f, p) for p in recipe.exports_sources if not p.startswith("!"))}
agree("conanfile.py, files that are installed but not exported", sorted(installed - exported), [])
required = []
recipe.options = types.SimpleNamespace(io=True)
recipe.requires = lambda reference, **_: required.append(reference.split("/")[0])
recipe.requirements()
agree("conanfile.py, libraries", set(required), names(1))
# Conan refuses a requirement that no component names.
recipe.settings = types.SimpleNamespace(os="Linux")


class Component(types.SimpleNamespace):
    def set_property(self, name, value):
        setattr(self, name, value)


class Components(dict):
    def __missing__(self, name):
        return self.setdefault(name, Component(requires=[], libs=[]))


recipe.cpp_info = Component(components=Components())
recipe.package_info()
parts = recipe.cpp_info.components
agree("conanfile.py, components", [p.cmake_target_name for p in parts.values()],
      ["agrisee::headers", "agrisee::agrisee", "agrisee::study", "agrisee::io"])
agree("conanfile.py, libraries of the components",
      {r.split("::")[0] for p in parts.values() for r in p.requires if "::" in r}, names(1))
print(f"CHANGELOG.md, three package.xml, vcpkg.json and conanfile.py agree on {version}")
