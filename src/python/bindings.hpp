// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The parts of the module `_agrisee`. Each function adds the classes and functions of one source.
#pragma once

#include <agrisee/core/error.hpp>

#include <pybind11/pybind11.h>

namespace agrisee::python {

namespace py = pybind11;

/// A call of an object that another call uses.
struct BusyError : Error {
  using Error::Error;
};

/// The exceptions of core/error.hpp as Python's: FileError is an OSError (of a missing file: a FileNotFoundError),
/// ParameterError and InputError are ValueErrors, BusyError is a RuntimeError.
void bind_errors(py::module_& m);
/// Parameters and the groups within them.
void bind_parameters(py::module_& m);
/// Fruit, views and results.
void bind_results(py::module_& m);
/// `process`.
void bind_process(py::module_& m);
/// Workcell, and what an arm is asked and answers.
void bind_workcell(py::module_& m);
/// Pipeline.
void bind_pipeline(py::module_& m);
/// `scan`, `make_truss` and SimulatedCamera.
void bind_simulation(py::module_& m);
/// Rays and distances to meshes.
void bind_rays(py::module_& m);
/// The steps on clouds as functions, and rays.
void bind_stages(py::module_& m);

}  // namespace agrisee::python
