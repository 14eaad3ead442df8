// SPDX-License-Identifier: BSD-3-Clause
// The extension module behind the package `agrisee`.
#include <agrisee/version.hpp>

#include "bindings.hpp"

namespace agrisee::python {

void bind_errors(py::module_& m) {
  // Those registered last are tried first, so the base comes first.
  const auto& error = py::register_exception<Error>(m, "Error");
  const auto kind_of = [&](PyObject* builtin) { return py::make_tuple(error, py::handle(builtin)); };
  py::register_exception<FileError>(m, "FileError", kind_of(PyExc_OSError));
  py::register_exception<BusyError>(m, "BusyError", kind_of(PyExc_RuntimeError));
  py::register_exception<ParameterError>(m, "ParameterError", kind_of(PyExc_ValueError));
  py::register_exception<InputError>(m, "InputError", kind_of(PyExc_ValueError));
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const Cancelled& e) {
      PyErr_SetString(PyExc_KeyboardInterrupt, e.what());
    }
  });
}

}  // namespace agrisee::python

PYBIND11_MODULE(_agrisee, m) {
  using namespace agrisee::python;
  m.doc() = "The compiled part of the package agrisee.";
  m.attr("__version__") = AGRISEE_VERSION;
  bind_errors(m);
  bind_parameters(m);
  bind_results(m);
  bind_process(m);
  bind_workcell(m);
  bind_pipeline(m);
  bind_simulation(m);
  bind_stages(m);
}
