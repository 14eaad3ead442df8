// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/process.hpp>

#include <pybind11/stl.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "parameters.hpp"
#include "results.hpp"
#include "running.hpp"

namespace agrisee::python {
namespace {

/// What process_arrays is given, converted.
struct Input {
  py::array points;
  std::optional<py::array> normals;
  std::vector<int> views;  // empty, or one a point
  Parameters parameters;
  CloudOrigin origin;
  int threads = 1;
};

/// For each point the number of the view that saw it. @throws pybind11::type_error, InputError
std::vector<int> views_of(const py::object& argument, const py::array& points, std::size_t sensors) {
  if (argument.is_none()) return {};
  const py::array_t<std::int64_t> numbers = array_of_whole_numbers(argument, "views");
  check_input(numbers.ndim() == 1 && numbers.shape(0) == points.shape(0), "views must be one number a point");
  std::vector<int> out;
  for (py::ssize_t i = 0; i < numbers.size(); ++i) {
    const std::int64_t view = numbers.at(i);
    if (view < -1 || view >= static_cast<std::int64_t>(sensors))
      throw InputError("views must be rows of sensors, of which there are " + std::to_string(sensors) +
                       " (the first is 0), or -1 where unknown, got " + std::to_string(view));
    out.push_back(static_cast<int>(view));
  }
  return out;
}

/// The points with their views as a cloud of the library.
template <typename S>
Cloud cloud_with_views(const ArrayPoints<S>& rows, const Input& input) {
  const auto single = [](const std::vector<Vector3<S>>& vectors) {
    std::vector<Eigen::Vector3f> out(vectors.size());
    for (std::size_t i = 0; i < vectors.size(); ++i) out[i] = vectors[i].template cast<float>();
    return out;
  };
  Cloud cloud;
  cloud.points = single(copied(rows));
  if (input.normals) cloud.normals = single(copied(view_of<S>(*input.normals)));
  cloud.views = input.views;
  return cloud;
}

/// Runs without Python's lock, so it may look at arrays but not at their types, which Python counts.
template <typename S>
ScanResult run(const Input& in, const ArrayPoints<S>& rows) {
  if (!in.views.empty()) return process(cloud_with_views(rows, in), in.parameters, in.origin, {}, in.threads);
  if (!in.normals) return process(rows, in.parameters, in.origin, {}, in.threads);
  return process(ArrayCloud<S>{rows, view_of<S>(*in.normals)}, in.parameters, in.origin, {}, in.threads);
}

/// Calls f; where it doubts the viewpoint, the message says which arguments help.
template <typename F>
ScanResult with_advice(const Input& in, F&& f) {
  try {
    return f();
  } catch (const InputError& e) {
    const std::string what = e.what();
    if (what.find("as seen from the viewpoint") == std::string::npos) throw;
    throw InputError(
        what + ". If several views saw the points, leave viewpoint out, or give views and sensors; " +
        (in.normals && !in.origin.check_normals ? "if your normals face away from it, add check_normals=True; " : "") +
        "if viewpoint is right, add trust_viewpoint=True");
  }
}

SharedResult process_arrays(const py::object& points, const py::object& normals, const py::object& viewpoint,
                            const py::object& radius, const py::object& parameters, int threads, bool check_normals,
                            bool trust_viewpoint, const py::object& views, const py::object& sensors) {
  Input in;
  in.points = array_of_rows(points, "points");
  if (!normals.is_none()) in.normals = normals_of(normals, in.points);
  in.parameters = parameters_of(parameters);
  if (const auto radii = vector_of<2>(radius, "radius")) in.parameters.expect_radii((*radii)[0], (*radii)[1]);
  in.origin.viewpoint = vector_of<3>(viewpoint, "viewpoint");
  in.origin.check_normals = check_normals;
  in.origin.trust_viewpoint = trust_viewpoint;
  if (views.is_none() != sensors.is_none()) throw InputError("views and sensors belong together: give both or neither");
  if (in.origin.viewpoint && !views.is_none())
    throw InputError("viewpoint is for a cloud of a single view: leave it out where views and sensors are given");
  if (!sensors.is_none())
    with_points(array_of_rows(sensors, "sensors"), [&](const auto& rows) {
      for (std::size_t i = 0; i < rows.size; ++i) in.origin.sensors.push_back(rows[i].template cast<double>());
    });
  in.views = views_of(views, in.points, in.origin.sensors.size());
  in.threads = threads_of(threads);
  return with_points(in.points, [&](const auto& rows) {
    ScanResult result = interruptible([&] { return with_advice(in, [&] { return run(in, rows); }); });
    if (result.raw.empty() && rows.size > 0)
      result.warnings.push_back("all " + std::to_string(rows.size) + " points were dropped: they are not finite");
    return shared(std::move(result));
  });
}

}  // namespace

void bind_process(py::module_& m) {
  m.def("process", &process_arrays, py::arg("points"), py::arg("normals") = py::none(),
        py::arg("viewpoint") = py::none(), py::arg("radius") = py::none(), py::arg("parameters") = py::none(),
        py::arg("threads") = 0, py::kw_only(), py::arg("check_normals") = false, py::arg("trust_viewpoint") = false,
        py::arg("views") = py::none(), py::arg("sensors") = py::none(),
        R"(Find the fruit in a cloud: clean, segment and locate.

points: N x 3 array of float32 or float64 (m, any frame), with any strides, read in place. Rows that are not finite are
  dropped. Other threads must not change it during the call.
normals: N x 3 normals of any length towards the side that was seen, zero or NaN where unknown; missing ones are
  estimated.
viewpoint: x, y, z of the sensor (m) if a single view saw all points.
radius: (smallest, largest) expected radius of a fruit (m).
parameters: Parameters, or a dict of them.
threads: 0 for all processor cores; the result does not depend on it.
check_normals: turn given normals that face away from the viewpoint.
trust_viewpoint: use the viewpoint even if the points contradict it.
views, sensors: for a cloud of several views: the view that saw each point (N whole numbers, -1: unknown), and the
  sensor's position of each view (K x 3, m).

Returns a ScanResult. Raises ParameterError, InputError (a cloud that cannot be in metres, or was not seen from the
viewpoint), and KeyboardInterrupt within 50 ms of Ctrl-C. Other Python threads run meanwhile.)");
}

}  // namespace agrisee::python
