// SPDX-License-Identifier: BSD-3-Clause
// The extension module behind the package `agrisee`.
#include <agrisee/io/missing_file.hpp>
#include <agrisee/version.hpp>

#include <cerrno>

#include "bindings.hpp"

namespace agrisee::python {

namespace {

/// A path, or a message that names one, whatever its bytes are.
py::str text_of_path(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeFSDefault(bytes.c_str()));
}

/// MissingFileError: a FileError and a FileNotFoundError, with its errno and filename.
void bind_missing_file(py::module_& m, const py::handle& file_error) {
  static py::handle type;  // never freed, as the translator may run until Python ends
  const auto bases = py::make_tuple(file_error, py::handle(PyExc_FileNotFoundError));
  type = py::exception<io::MissingFile>(m, "MissingFileError", bases).release();
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const io::MissingFile& e) {
      const py::object error = type(text_of_path(e.what()));
      error.attr("errno") = ENOENT;
      error.attr("filename") = text_of_path(e.path.string());
      PyErr_SetObject(type.ptr(), error.ptr());
    }
  });
}

}  // namespace

void bind_errors(py::module_& m) {
  // Those registered last are tried first, so the base comes first.
  const auto& error = py::register_exception<Error>(m, "Error");
  const auto kind_of = [&](PyObject* builtin) { return py::make_tuple(error, py::handle(builtin)); };
  auto& file_error = py::register_exception<FileError>(m, "FileError", kind_of(PyExc_OSError));
  file_error.attr("__str__") = py::handle(PyExc_BaseException).attr("__str__");  // OSError's begins with errno
  bind_missing_file(m, file_error);
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
