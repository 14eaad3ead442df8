// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Workcells and what an arm is asked and answers, from Python's arguments.
#pragma once

#include <agrisee/plan/planner.hpp>
#include <agrisee/workcell.hpp>

#include <filesystem>
#include <memory>
#include <pybind11/pybind11.h>

namespace agrisee::python {

namespace py = pybind11;

/// The scene file that a path names: itself or, in a folder, scene.yaml.
std::filesystem::path scene_file(const std::filesystem::path& path);

/// A workcell from an argument: agrisee.Workcell, a dict as of Workcell.from_dict, or the path of a scene file or its
/// folder.
/// @throws pybind11::type_error for another type, FileError for a file, ParameterError for a dict
Workcell workcell_of(const py::object& argument);

/// A Python function that threads may destroy without holding Python's lock.
using SharedFunction = std::shared_ptr<py::object>;

/// A Python function to be shared, or null for None.
/// @param name of the argument, for messages
/// @throws pybind11::type_error if it cannot be called
SharedFunction function_of(const py::object& argument, const char* name);

/// A function of Python that answers whether the arm can take a view, as a plan::Reach. It is called with a ViewRequest
/// and joints (six numbers, rad), on the thread that does the work, and has to return a ReachableView or None.
/// @param function null for none
plan::Reach reach_of(const SharedFunction& function);

}  // namespace agrisee::python
