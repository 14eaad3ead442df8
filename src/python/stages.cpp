// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/dbscan.hpp>
#include <agrisee/cloud/fit.hpp>
#include <agrisee/cloud/icp.hpp>
#include <agrisee/cloud/normals.hpp>
#include <agrisee/cloud/orient_normals.hpp>
#include <agrisee/cloud/region_growing.hpp>
#include <agrisee/cloud/sor.hpp>
#include <agrisee/neighbors/count_neighbors.hpp>

#include <pybind11/stl.h>

#include "archive.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "parameters.hpp"
#include "results.hpp"
#include "running.hpp"

namespace agrisee::python {
namespace {

/// Calls f with the points of an argument as a cloud, as interruptible work, and returns its vector as an array.
template <typename F>
py::array stage(const py::object& points, F&& f) {
  const py::array rows = array_of_rows(points, "points");
  return with_points(rows, [&](const auto& cloud) { return owned(interruptible([&] { return f(cloud); })); });
}

py::array remove_outliers(const py::object& points, int threads, const py::kwargs& parameters) {
  const auto values = stage_parameters<SorParameters>(parameters);
  const int workers = threads_of(threads);
  return stage(points, [&](const auto& cloud) { return remove_statistical_outliers(cloud, values, workers); });
}

py::array clusters(const py::object& points, int threads, const py::kwargs& parameters) {
  const auto values = stage_parameters<DbscanParameters>(parameters);
  const int workers = threads_of(threads);
  return stage(points, [&](const auto& cloud) { return dbscan(cloud, values, workers); });
}

py::array neighbor_counts(const py::object& points, double radius, int threads) {
  const int workers = threads_of(threads);
  return stage(points, [&](const auto& cloud) {
    return count_neighbors(cloud, static_cast<scalar_t<std::decay_t<decltype(cloud)>>>(radius), workers);
  });
}

py::object normals(const py::object& points, const py::object& viewpoint, bool curvatures, int threads,
                   const py::kwargs& parameters) {
  const auto values = stage_parameters<NormalParameters>(parameters);
  const auto seen_from = vector_of<3>(viewpoint, "viewpoint");
  const int workers = threads_of(threads);
  const py::array rows = array_of_rows(points, "points");
  return with_points(rows, [&](const auto& cloud) -> py::object {
    using S = scalar_t<std::decay_t<decltype(cloud)>>;
    std::vector<S> curved;
    std::vector<Vector3<S>> found = interruptible([&] {
      auto out = estimate_normals(cloud, values, workers, &curved);
      if (!seen_from) return orient_normals_consistently(std::move(out), cloud, OrientationParameters(), workers);
      for (std::size_t i = 0; i < out.size(); ++i)
        out[i] = orient_towards(out[i], *seen_from - cloud[i].template cast<double>());
      return out;
    });
    py::array array = owned(std::move(found));
    if (!curvatures) return std::move(array);
    return py::make_tuple(array, owned(std::move(curved)));
  });
}

/// One number a point, copied to the type of the points. @throws pybind11::type_error, InputError
template <typename S>
std::vector<S> curvatures_of(const py::object& argument, std::size_t size) {
  if (argument.is_none()) return {};
  const std::vector<double> values = numbers_of(argument, size, "curvatures");
  return {values.begin(), values.end()};
}

py::array regions(const py::object& points, const py::object& normals, const py::object& curvatures, int threads,
                  const py::kwargs& parameters) {
  const auto values = stage_parameters<RegionGrowingParameters>(parameters);
  const int workers = threads_of(threads);
  const py::array rows = array_of_rows(points, "points"), given = normals_of(normals, rows);
  return with_points(rows, [&](const auto& cloud) {
    using S = scalar_t<std::decay_t<decltype(cloud)>>;
    const std::vector<S> curved = curvatures_of<S>(curvatures, cloud.size);
    return owned(
        interruptible([&] { return grow_regions(cloud, copied(view_of<S>(given)), values, curved, workers); }));
  });
}

IcpResult icp(const py::object& source, const py::object& target, const py::object& source_normals,
              const py::object& target_normals, const py::object& initial, int threads, const py::kwargs& parameters) {
  const auto values = stage_parameters<IcpParameters>(parameters);
  const Pose start = initial.is_none() ? Pose(Pose::Identity()) : pose_of(initial, "initial");
  const int workers = threads_of(threads);
  const py::array to = array_of_rows(target, "target"), from = of_type(array_of_rows(source, "source"), to);
  const auto given = [](const py::object& argument, const py::array& rows, const char* name) {
    return argument.is_none() ? std::nullopt : std::optional(normals_of(argument, rows, name));
  };
  const auto from_normals = given(source_normals, from, "source_normals");
  const auto to_normals = given(target_normals, to, "target_normals");
  return with_points(to, [&](const auto& cloud) {
    using S = scalar_t<std::decay_t<decltype(cloud)>>;
    const auto vectors = [](const std::optional<py::array>& a) {
      return a ? copied(view_of<S>(*a)) : std::vector<Vector3<S>>();
    };
    return interruptible([&] {
      return register_cloud(view_of<S>(from), vectors(from_normals), cloud, vectors(to_normals), values, start,
                            workers);
    });
  });
}

std::optional<EllipsoidFit> fit(const py::object& points, const py::object& normals, const py::kwargs& parameters) {
  const auto values = stage_parameters<FitParameters>(parameters);
  const py::array rows = array_of_rows(points, "points"), given = normals_of(normals, rows);
  return with_points(rows, [&](const auto& view) {
    using S = scalar_t<std::decay_t<decltype(view)>>;
    return interruptible([&]() -> std::optional<EllipsoidFit> {
      PointCloud<S> cloud;
      cloud.points = copied(view);
      cloud.normals = copied(view_of<S>(given));
      const Indices finite = finite_indices(cloud);
      const auto sphere = sphere_from_normals(cloud, finite);
      if (!sphere || !(sphere->radius > 0.0)) return std::nullopt;
      return fit_ellipsoid(cloud, finite, Ellipsoid(*sphere), values);
    });
  });
}

void bind_stage_results(py::module_& m) {
  py::class_<IcpResult> result(m, "IcpResult", "The result of icp.");
  result
      .def_property_readonly(
          "target_T_source", [](const IcpResult& r) { return matrix_of(r.target_T_source); },
          "4 x 4: the corrected pose, or the initial one if no correction is accepted")
      .def_readonly("accepted", &IcpResult::accepted, "whether the correction lowers the residual within its limits")
      .def_readonly("rms_before", &IcpResult::rms_before, "residual (m) at the initial pose")
      .def_readonly("rms_after", &IcpResult::rms_after, "final residual (m), over the same points")
      .def_readonly(
          "worse", &IcpResult::worse,
          "share of the matched points in regions where the residuals grew clearly; see IcpParameters.max_worse")
      .def_readonly("matches", &IcpResult::matches, "final number of matched points")
      .def_readonly("iterations", &IcpResult::iterations, "number of iterations")
      .def_readonly("constrained", &IcpResult::constrained,
                    "number of the six degrees of freedom that the surface determines")
      .def_readonly("translation", &IcpResult::translation, "how far the source's centroid moved (m)")
      .def_readonly("rotation", &IcpResult::rotation, "how far the source turned (rad)")
      .def("__repr__", [](const IcpResult& r) {
        return std::string("<IcpResult: ") + (r.accepted ? "accepted" : "not accepted") + ", moved by " +
               number_text(1e3 * r.translation, 3) + " mm, residual " + number_text(1e3 * r.rms_before, 3) + " to " +
               number_text(1e3 * r.rms_after, 3) + " mm>";
      });
  bind_pickle(result);
  py::class_<EllipsoidFit> fit(m, "EllipsoidFit", "The result of fit_ellipsoid.");
  fit.def_property_readonly(
         "center", [](const EllipsoidFit& f) { return f.body.center; }, "center (m)")
      .def_property_readonly(
          "radii", [](const EllipsoidFit& f) { return semi_axes(f.body).first; }, "semi-axes (m), largest first")
      .def_property_readonly(
          "axes", [](const EllipsoidFit& f) { return semi_axes(f.body).second; },
          "3 x 3, columns: directions of the semi-axes")
      .def_property_readonly(
          "center_covariance", [](const EllipsoidFit& f) { return f.center_covariance; }, "3 x 3 (m2)")
      .def_readonly("rms", &EllipsoidFit::rms, "root mean square distance of the inliers (m)")
      .def_readonly("inliers", &EllipsoidFit::inliers, "number of points that are near and whose normals agree")
      .def("__repr__", [](const EllipsoidFit& f) {
        const Eigen::Vector3d radii = 1e3 * semi_axes(f.body).first;
        return "<EllipsoidFit with radii " + number_text(radii[0], 4) + ", " + number_text(radii[1], 4) + ", " +
               number_text(radii[2], 4) + " mm, " + std::to_string(f.inliers) + " inliers>";
      });
  bind_pickle(fit);
}

void bind_stage_functions(py::module_& m) {
  using py::arg;
  const py::none none;
  m.def("remove_statistical_outliers", &remove_outliers, arg("points"), arg("threads") = 0,
        "Indices (int32, ascending) of the points that are not outliers.\n\nFurther keywords: mean_k, std_ratio, "
        "sample_deviation, as the parameters `sor` (here std_ratio is 2 by default).");
  m.def("estimate_normals", &normals, arg("points"), arg("viewpoint") = none, arg("curvatures") = false,
        arg("threads") = 0,
        "Unit normals, N x 3, zero where there is none: turned to the viewpoint (x, y, z; m) or, without one, so that "
        "neighbors agree. With curvatures=True also the surface variation of each point (0 to 1/3).\n\nFurther "
        "keywords: radius (m), max_neighbors, as the parameters `normals`.");
  m.def("grow_regions", &regions, arg("points"), arg("normals"), arg("curvatures") = none, arg("threads") = 0,
        "Labels (int32) of smooth regions, from 1; 0 for no region. normals: of any length.\n\nFurther keywords: "
        "radius (m), smoothness "
        "(rad), min_size and more, as the parameters `split.growing`. Some of them need curvatures.");
  m.def("dbscan", &clusters, arg("points"), arg("threads") = 0,
        "Labels (int32) of clusters, from 1; 0 for noise.\n\nFurther keywords: eps (m), min_points, as the parameters "
        "`split.clustering`.");
  m.def("icp", &icp, arg("source"), arg("target"), arg("source_normals") = none, arg("target_normals") = none,
        arg("initial") = none, arg("threads") = 0,
        "The small rigid motion that aligns a source cloud with a target, as an IcpResult. Point to plane, so the "
        "target needs normals (of any length), unless point_to_point=True.\n\ninitial: 4 x 4 target_T_source. Further "
        "keywords: "
        "max_distance (m), kernel and more, as the parameters `icp`.");
  m.def(
      "fit_ellipsoid", &fit, arg("points"), arg("normals"),
      "The ellipsoid that fits points with outward normals (of any length) as an EllipsoidFit, or None if there are "
      "too few points or "
      "no ellipsoid fits.\n\nFurther keywords: noise (m), shape_prior and more, as the parameters `split.bodies.fit`.");
  m.def("count_neighbors", &neighbor_counts, arg("points"), arg("radius"), arg("threads") = 0,
        "The density: how many points (int32) are at most radius (m) away from each point, itself included.");
}

}  // namespace

void bind_stages(py::module_& m) {
  bind_stage_results(m);
  bind_stage_functions(m);
  bind_rays(m);
}

}  // namespace agrisee::python
