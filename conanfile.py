# SPDX-License-Identifier: BSD-3-Clause
"""Conan 2 recipe: conan create . [-o "&:io=False"]"""
import os
import re

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load


class AgriseeConan(ConanFile):
    name = "agrisee"
    description = "Active perception for harvesting robots: look, clean, split, locate"
    license = "BSD-3-Clause"
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"shared": [True, False], "fPIC": [True, False], "io": [True, False]}
    default_options = {"shared": False, "fPIC": True, "io": True}
    exports = "include/agrisee/version.hpp"
    exports_sources = "CMakeLists.txt", "LICENSE", "package.xml", "cmake/*", "include/*", "src/*", "!*/node_modules/*"

    def set_version(self):
        header = load(self, os.path.join(self.recipe_folder, "include/agrisee/version.hpp"))
        self.version = re.search(r'AGRISEE_VERSION "([^"]+)"', header).group(1)

    def requirements(self):
        self.requires("eigen/3.4.0", transitive_headers=True)
        self.requires("nanoflann/1.5.2", transitive_headers=True)
        if self.options.io:
            self.requires("yaml-cpp/0.8.0")
            self.requires("nlohmann_json/3.11.3")
            self.requires("stb/cci.20230920")
            self.requires("zlib/1.3.1")

    def layout(self):
        cmake_layout(self)

    def generate(self):
        CMakeDeps(self).generate()
        toolchain = CMakeToolchain(self)
        toolchain.cache_variables["AGRISEE_BUILD_IO"] = bool(self.options.io)
        for part in ("CLI", "TESTS", "EXAMPLES"):
            toolchain.cache_variables["AGRISEE_BUILD_" + part] = False
        toolchain.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", self.source_folder, os.path.join(self.package_folder, "licenses"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "agrisee")
        # The same targets as the CMake package has: each part needs the one before it.
        needs = ["eigen::eigen", "nanoflann::nanoflann"]
        for part, libs in (("headers", []), ("agrisee", ["agrisee"]), ("study", ["agrisee_study"]), ("io", ["agrisee_io"])):
            if part == "io" and not self.options.io:
                continue
            component = self.cpp_info.components[part]
            component.set_property("cmake_target_name", "agrisee::" + part)
            component.set_property("pkg_config_name", "agrisee" if part == "agrisee" else "agrisee-" + part)
            component.libs = libs
            component.requires = list(needs)
            needs = [part]
        if self.settings.os in ("Linux", "FreeBSD"):
            self.cpp_info.components["headers"].system_libs = ["pthread"]
        if self.options.io:
            self.cpp_info.components["io"].requires += ["yaml-cpp::yaml-cpp", "nlohmann_json::nlohmann_json", "stb::stb",
                                                           "zlib::zlib"]
