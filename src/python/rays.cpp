// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/bvh.hpp>

#include <limits>

#include "arrays.hpp"
#include "bindings.hpp"
#include "running.hpp"

namespace agrisee::python {
namespace {

/// The rows of an argument in single precision, in which the tree answers.
std::vector<Eigen::Vector3f> floats(const py::object& argument, const char* name) {
  const py::array rows = array_of_rows(argument, name);
  return with_points(rows, [](const auto& view) {
    std::vector<Eigen::Vector3f> out(view.size);
    for (std::size_t i = 0; i < view.size; ++i) out[i] = view[i].template cast<float>();
    return out;
  });
}

std::shared_ptr<Bvh> make_bvh(const py::object& vertices, const py::object& triangles, int threads) {
  Mesh mesh;
  mesh.vertices = floats(vertices, "vertices");
  const py::array_t<std::int64_t> corners = array_of_whole_numbers(triangles, "triangles");
  const bool no_list = corners.ndim() == 1 && corners.size() == 0 && !py::isinstance<py::array>(triangles);
  check_input(no_list || (corners.ndim() == 2 && corners.shape(1) == 3), "triangles must have the shape (M, 3)");
  for (py::ssize_t i = 0; i < corners.shape(0); ++i) {
    std::array<std::uint32_t, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t vertex = corners.at(i, static_cast<py::ssize_t>(k));
      if (vertex < 0 || vertex >= static_cast<std::int64_t>(mesh.vertices.size()))
        throw InputError("triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) + " of " +
                         std::to_string(mesh.vertices.size()));
      if (!is_finite(mesh.vertices[static_cast<std::size_t>(vertex)]))
        throw InputError("triangle " + std::to_string(i) + " names vertex " + std::to_string(vertex) +
                         ", which is not finite");
      triangle[k] = static_cast<std::uint32_t>(vertex);
    }
    mesh.triangles.push_back(triangle);
  }
  const int workers = threads_of(threads);
  return interruptible([&] { return std::make_shared<Bvh>(mesh, workers); });
}

/// What each ray hits first: distances (infinite: nothing) and triangles (-1: none).
struct Hits {
  std::vector<float> t;
  std::vector<std::int64_t> triangles;

  py::tuple arrays() { return py::make_tuple(owned(std::move(t)), owned(std::move(triangles))); }
};

py::tuple cast_rays(const Bvh& bvh, const py::object& origins, const py::object& directions, int threads) {
  const std::vector<Eigen::Vector3f> from = floats(origins, "origins"), along = floats(directions, "directions");
  check_input(from.size() == along.size(), "there must be as many directions as origins");
  const int workers = threads_of(threads);
  return interruptible([&] {
           Hits hits{std::vector<float>(from.size(), std::numeric_limits<float>::infinity()),
                     std::vector<std::int64_t>(from.size(), -1)};
           parallel_for(from.size(), workers, [&](std::size_t i) {
             throw_if_cancelled();
             if (const auto hit = bvh.closest(from[i], along[i])) {
               hits.t[i] = hit->t;
               hits.triangles[i] = hit->triangle;
             }
           });
           return hits;
         })
      .arrays();
}

py::tuple nearest_points(const Bvh& bvh, const py::object& points, int threads) {
  const std::vector<Eigen::Vector3f> queries = floats(points, "points");
  const int workers = threads_of(threads);
  std::vector<Eigen::Vector3f> on(queries.size(), Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  Hits hits = interruptible([&] {
    Hits out{std::vector<float>(queries.size(), std::numeric_limits<float>::infinity()),
             std::vector<std::int64_t>(queries.size(), -1)};
    parallel_for(queries.size(), workers, [&](std::size_t i) {
      throw_if_cancelled();  // a query from the middle of a sphere takes some 30 ms, a chunk of them seconds
      if (const auto found = bvh.nearest(queries[i])) {
        out.t[i] = found->distance;
        out.triangles[i] = found->triangle;
        on[i] = found->point;
      }
    });
    return out;
  });
  return py::make_tuple(owned(std::move(hits.t)), owned(std::move(hits.triangles)), owned(std::move(on)));
}

}  // namespace

void bind_rays(py::module_& m) {
  py::class_<Bvh, std::shared_ptr<Bvh>>(m, "Bvh", "A tree over the triangles of a mesh, for rays and distances.")
      .def(py::init(&make_bvh), py::arg("vertices"), py::arg("triangles"), py::arg("threads") = 0,
           "vertices: N x 3 (m); triangles: M x 3 whole numbers, indices of vertices.")
      .def("rays", &cast_rays, py::arg("origins"), py::arg("directions"), py::arg("threads") = 0,
           "The first hit of each ray: distances in units of the direction's length (float32; infinite: no hit), and "
           "triangles (int64; -1: none). origins and directions: K x 3.")
      .def("nearest", &nearest_points, py::arg("points"), py::arg("threads") = 0,
           "The surface point nearest to each of K points: distances (m), triangles, and the surface points, K x 3.")
      .def("__len__", &Bvh::size)
      .def("__repr__", [](const Bvh& bvh) { return "<Bvh of " + std::to_string(bvh.size()) + " triangles>"; });
}

}  // namespace agrisee::python
