// SPDX-License-Identifier: BSD-3-Clause
#include "results.hpp"

#include <agrisee/geometry/aabb.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scan_page.hpp>
#include <agrisee/version.hpp>

#include <algorithm>
#include <cstdio>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "archive.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "running.hpp"
#include "workcell.hpp"

namespace agrisee::python {
namespace {

/// The fruit as list of dicts, with the keys of fruits.json.
py::list dicts_of(const std::vector<Fruit>& fruits) {
  return py::module_::import("json").attr("loads")(io::fruits_to_json(fruits));
}

/// What is appended to the key of a list in a table: the suffixes of fruits.csv.
std::vector<std::string> suffixes_of(const std::string& key) {
  if (key.find("orientation") != std::string::npos) return {"_x", "_y", "_z", "_w"};
  if (key == "radii") return {"_a", "_b", "_c"};
  return {"_x", "_y", "_z"};
}

/// A dict of a fruit without lists: the columns of fruits.csv.
py::dict flat(const py::dict& fruit) {
  py::dict row;
  for (const auto& [name, value] : fruit) {
    const auto key = name.cast<std::string>();
    if (!py::isinstance<py::list>(value)) {
      row[name] = value;
      continue;
    }
    const auto list = py::reinterpret_borrow<py::list>(value);
    if (key == "picking_after") {
      row[name] = py::str(" ").attr("join")(py::module_::import("builtins").attr("map")(py::type::of(py::str()), list));
    } else if (key == "pre_grasp_joints") {
      for (std::size_t i = 0; i < list.size(); ++i) row[py::str("pre_grasp_q" + std::to_string(i + 1))] = list[i];
    } else if (key == "center_covariance_world") {
      const char* const axes[] = {"x", "y", "z"};
      for (std::size_t r = 0; r < 3; ++r)
        for (std::size_t c = r; c < 3; ++c) row[py::str(key + "_" + axes[r] + axes[c])] = py::list(list[r])[c];
    } else {
      const std::vector<std::string> suffixes = suffixes_of(key);
      for (std::size_t i = 0; i < list.size(); ++i) row[py::str(key + suffixes.at(i))] = list[i];
    }
  }
  return row;
}

template <typename... T>
std::string formatted(const char* format, T... values) {
  char text[200];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

std::string repr(const Fruit& f) {
  const Eigen::Vector3d& p = f.position();
  std::string out = formatted("<Fruit %d at (%.4f, %.4f, %.4f) m", f.id, p.x(), p.y(), p.z());
  if (f.body) out += formatted(", radius %.1f mm, confidence %.2f", 1e3 * f.body->radii.mean(), f.body->confidence);
  return out + ", " + std::to_string(f.points) + " points>";
}

std::string repr(const Body& b) {
  return formatted("<Body with radii %.1f, %.1f, %.1f mm, volume %.1f ml, completeness %.0f %%>", 1e3 * b.radii[0],
                   1e3 * b.radii[1], 1e3 * b.radii[2], 1e6 * b.volume, 100 * b.completeness);
}

std::string repr(const View& v) {
  const Eigen::Vector3d p = v.world_T_optical.translation();
  return formatted("<View from (%.3f, %.3f, %.3f) m, %zu points in the scan volume, %zu new%s>", p.x(), p.y(), p.z(),
                   v.points_in, v.points_new, v.discarded ? ", discarded" : "");
}

std::string repr(const ScanResult& r) {
  std::string out =
      "<ScanResult: " + std::to_string(r.fruits.size()) + " fruit, " + std::to_string(r.cloud.size()) + " points";
  if (!r.views.empty()) out += ", " + views_text(r.views) + ", ended by " + to_string(r.stop_reason);
  if (const auto warnings = warnings_of(r.warnings, r.views); !warnings.empty())
    out += ", " + std::to_string(warnings.size()) + (warnings.size() == 1 ? " warning" : " warnings");
  return out + formatted(", %.2f s>", r.seconds.total);
}

template <typename T>
py::dict dict_of_fields(const T& value) {
  py::dict out;
  T::fields(value, [&](const char* name, const auto& field) { out[name] = field; });
  return out;
}

void bind_body(py::module_& m) {
  py::class_<Body> body(m, "Body", "The body of a fruit as an ellipsoid, in world (m).");
  body.def_property_readonly(
          "center", [](const Body& b) { return b.center; }, "center (m)")
      .def_property_readonly(
          "radii", [](const Body& b) { return b.radii; }, "semi-axes (m), largest first")
      .def_property_readonly(
          "axes", [](const Body& b) { return b.axes; }, "3 x 3, columns: directions of the semi-axes")
      .def_property_readonly(
          "center_covariance", [](const Body& b) { return b.center_covariance; }, "3 x 3 (m2)")
      .def_readonly("rms", &Body::rms, "root mean square distance of its points from its surface (m)")
      .def_readonly("completeness", &Body::completeness, "share of its surface that was observed, 0 to 1")
      .def_readonly("confidence", &Body::confidence, "probability that it is a fruit, 0 to 1")
      .def_readonly("volume", &Body::volume, "m3")
      .def_readonly("volume_error", &Body::volume_error, "standard error of the volume (m3); 0: unknown")
      .def_readonly("mass", &Body::mass, "mass (kg), with the density of the parameter mass.density")
      .def_readonly("mass_error", &Body::mass_error, "standard error of the mass (kg); 0: unknown")
      .def("__repr__", [](const Body& b) { return repr(b); });
  bind_pickle(body);
}

void bind_picking(py::module_& m) {
  py::class_<Picking> picking(m, "Picking", "How to approach and when to pick a fruit.");
  picking.def_readonly("order", &Picking::order, "place in the picking order of all fruit, from 1")
      .def_readonly("reachable", &Picking::reachable, "whether it can be picked")
      .def_property_readonly(
          "reason", [](const Picking& p) { return to_string(p.reason); },
          "'reachable', or why it cannot be picked, as in fruits.json")
      .def_property_readonly(
          "direction", [](const Picking& p) { return p.direction; },
          "unit vector from the pre-grasp pose to the fruit's center; zero without a body")
      .def_property_readonly(
          "pre_grasp", [](const Picking& p) { return matrix_of(p.world_T_pre_grasp); },
          "4 x 4 pose of the tool in world, z along the direction")
      .def_readonly("joints", &Picking::joints, "joints at the pre-grasp pose (rad), or None")
      .def_readonly("after", &Picking::after, "ids of the fruit that must be picked first")
      .def_readonly("crossed", &Picking::crossed,
                    "measured surface of what is no fruit in the space that the gripper sweeps (m2)")
      .def("__repr__", [](const Picking& p) { return formatted("<Picking %d: %s>", p.order, to_string(p.reason)); });
  bind_pickle(picking);
}

void bind_fruit(py::module_& m) {
  py::class_<Fruit> fruit(m, "Fruit", "A located fruit, in world (m).");
  fruit.def_readonly("id", &Fruit::id, "number, from 1; the label of its points")
      .def_readonly("truss", &Fruit::truss, "number of the truss that it hangs on, from 1")
      .def_readonly("points", &Fruit::points, "number of its points")
      .def_readonly("found_by", &Fruit::found_by, "the stage that found it, as in fruits.json")
      .def_property_readonly(
          "position", [](const Fruit& f) { return f.position(); }, "center of its body, or centroid of its points (m)")
      .def_property_readonly("position_cluster", &Fruit::position_cluster, "position in the cluster frame (m)")
      .def_property_readonly(
          "pose", [](const Fruit& f) { return matrix_of(f.pose()); },
          "4 x 4: origin at position, axes of the pose frame (z: growth axis)")
      .def_property_readonly(
          "centroid", [](const Fruit& f) { return f.centroid; }, "mean of its points (m)")
      .def_property_readonly(
          "centroid_cluster", [](const Fruit& f) { return f.centroid_cluster; }, "centroid in the cluster frame (m)")
      .def_property_readonly(
          "centroid_pose", [](const Fruit& f) { return matrix_of(f.centroid_pose()); },
          "4 x 4: origin at centroid, axes those of pose")
      .def_property_readonly(
          "sigma", [](const Fruit& f) { return f.sigma; }, "standard deviation of its points along each axis (m)")
      .def_property_readonly(
          "orientation", [](const Fruit& f) { return f.orientation; }, "3 x 3 rotation of pose")
      .def_readonly("growth_axis_error", &Fruit::growth_axis_error,
                    "standard deviation (rad) of the orientation's z as the growth axis, or None if it is not that")
      .def_readonly("body", &Fruit::body, "the ellipsoid, or None")
      .def_readonly("picking", &Fruit::picking, "how to pick it, or None if that was not planned")
      .def(
          "to_dict", [](const Fruit& f) { return py::dict(dicts_of({f})[0]); },
          "The keys and values of fruits.json (docs/formats.md).")
      .def("__repr__", [](const Fruit& f) { return repr(f); });
  bind_pickle(fruit);
}

void bind_view(py::module_& m) {
  py::class_<View> view(m, "View", "A view that was taken.");
  view.def_property_readonly(
          "pose", [](const View& v) { return matrix_of(v.world_T_optical); },
          "4 x 4: world_T_optical, as reported by the robot")
      .def_property_readonly(
          "target", [](const View& v) { return v.target; }, "observed point on the optical axis (m)")
      .def_readonly("joints", &View::joints, "joints (rad), or None without an arm")
      .def_readonly("points_in", &View::points_in, "number of points measured inside the scan volume")
      .def_readonly("points_new", &View::points_new, "number of these that the merged cloud kept")
      .def_readonly("plan_seconds", &View::plan_seconds, "time it took to choose the view")
      .def_readonly("discarded", &View::discarded, "whether the view was rejected and is not part of the map")
      .def_property_readonly(
          "discard_reason", [](const View& v) { return to_string(v.discard_reason); },
          "why it was discarded: none, repeated_frame or contradicts_others")
      .def("__repr__", [](const View& v) { return repr(v); });
  bind_pickle(view);
  py::class_<FoundTruss> truss(m, "Truss", "Fruit that hang close to one another.");
  truss.def_readonly("id", &FoundTruss::id, "number, from 1, from the top down")
      .def_readonly("fruits", &FoundTruss::fruits, "ids of its fruit, from the top down")
      .def_property_readonly(
          "pose", [](const FoundTruss& t) { return matrix_of(t.world_T_truss); },
          "4 x 4 growth frame in world: z along the fruit, upwards")
      .def("__repr__",
           [](const FoundTruss& t) { return formatted("<Truss %d with %zu fruit>", t.id, t.fruits.size()); });
  bind_pickle(truss);
}

py::object completeness_of(const ScanResult& r) {
  if (!r.completeness) return py::none();
  py::dict out;
  out["seen"] = r.completeness->seen;
  out["observable"] = r.completeness->observable;
  return std::move(out);
}

/// @throws FileError if a folder holds a result
void check_free(const std::filesystem::path& folder) {
  std::vector<std::string> names(std::begin(io::kResultFiles), std::end(io::kResultFiles));
  names.insert(names.begin() + 1, "scan.json");  // of a scan that was not finished
  for (const std::string& name : names)
    if (std::error_code error; std::filesystem::exists(folder / name, error))
      throw FileError(folder.string() + ": already holds a result (" + name + "); use force=True to overwrite it");
}

/// Write a result folder with a report. Without a workcell the report shows the cloud alone.
void write_files(const ScanResult& result, const std::filesystem::path& folder, const py::object& workcell,
                 bool force) {
  if (!force) check_free(folder);
  Workcell cell;
  if (workcell.is_none()) {
    cell.name = "cloud";
    cell.scan_volume = bounding_box(result.cloud.points);
  } else {
    cell = workcell_of(workcell);
  }
  io::RunInfo info;
  info.scene = cell.name;
  info.version = AGRISEE_VERSION;
  info.time = io::utc_now();
  run_interruptibly([&] {
    io::write_result(folder, result, info);
    std::error_code error;
    std::filesystem::remove(folder / io::kPicture, error);  // the picture of an older result
    io::write_scan_page(folder / io::kReport, result, cell, info);
  });
}

void bind_result(py::module_& m) {
  using Result = py::class_<ScanResult, SharedResult>;
  Result result(m, "ScanResult",
                "The result of a scan, or of processing a cloud. Arrays are read-only views that keep the result "
                "alive.");
  const auto array = [&](const char* name, auto member, const char* doc) {
    result.def_property_readonly(
        name, [member](const py::object& self) { return shown(member(self.cast<const ScanResult&>()), self); }, doc);
  };
  array(
      "points", [](const ScanResult& r) -> const auto& { return r.cloud.points; },
      "N x 3 float32: the cleaned cloud (m, world)");
  array(
      "normals", [](const ScanResult& r) -> const auto& { return r.cloud.normals; },
      "N x 3 float32: unit normals towards the side that was seen");
  array(
      "labels", [](const ScanResult& r) -> const auto& { return r.labels; },
      "N int32: the id of each point's fruit, or 0");
  array(
      "point_views", [](const ScanResult& r) -> const auto& { return r.cloud.views; },
      "N int32: the view that saw each point, or -1");
  array(
      "raw_points", [](const ScanResult& r) -> const auto& { return r.raw.points; },
      "M x 3 float32: the merged cloud before cleaning (m, world)");
  result.def_readonly("fruits", &ScanResult::fruits, "list of Fruit: truss by truss, each from the top down")
      .def_readonly("trusses", &ScanResult::trusses, "list of Truss, from the top down")
      .def_readonly("views", &ScanResult::views, "list of View, in the order in which they were taken")
      .def_property_readonly(
          "stop_reason", [](const ScanResult& r) { return to_string(r.stop_reason); }, "why the scan ended")
      .def_property_readonly(
          "cluster_origin", [](const ScanResult& r) { return r.cluster_origin; },
          "origin of the cluster frame (m, world)")
      .def_property_readonly("completeness", &completeness_of,
                             "dict of shares of the fruit's surface, seen and observable, as the planner estimates; "
                             "or None")
      .def_property_readonly(
          "seconds", [](const ScanResult& r) { return dict_of_fields(r.seconds); },
          "dict: computing time of each stage (s)")
      .def_property_readonly(
          "bodies", [](const ScanResult& r) { return dict_of_fields(r.bodies); },
          "dict: how many proposed bodies were taken as fruit, or rejected for each reason")
      .def_property_readonly(
          "warnings", [](const ScanResult& r) { return warnings_of(r.warnings, r.views); },
          "sentences about discarded views, and input that should be checked")
      .def_property_readonly(
          "why_no_fruit", [](const ScanResult& r) { return why_no_fruit(r); },
          "why there is no fruit, as far as it is known; empty if there are fruit")
      .def(
          "to_dicts",
          [](const ScanResult& r) {
            py::list rows;
            for (const auto& fruit : dicts_of(r.fruits)) rows.append(flat(py::reinterpret_borrow<py::dict>(fruit)));
            return rows;
          },
          "One dict per fruit, with the columns of fruits.csv: pandas.DataFrame(result.to_dicts()).")
      .def("write", &write_files, py::arg("folder"), py::arg("workcell") = py::none(), py::arg("force") = false,
           "Write a result folder (docs/formats.md): clouds, fruits.json, fruits.csv, views.csv, run.json, and "
           "report.html, which shows the arm if a workcell is given. A result does not know its parameters and seed, "
           "so run.json lacks them. Raises FileError if the folder holds a result, unless force is given.")
      .def("__repr__", [](const ScanResult& r) { return repr(r); });
  result.def(py::pickle([](const ScanResult& r) { return py::bytes(to_bytes(r)); },
                        [](const py::bytes& bytes) { return shared(from_bytes<ScanResult>(bytes)); }));
}

}  // namespace

std::string views_text(const std::vector<View>& views) {
  const auto discarded = std::count_if(views.begin(), views.end(), [](const View& v) { return v.discarded; });
  return std::to_string(views.size()) + " views" +
         (discarded > 0 ? " (" + std::to_string(discarded) + " discarded)" : "");
}

std::vector<std::string> warnings_of(std::vector<std::string> warnings, const std::vector<View>& views) {
  if (std::string discarded = discarded_views(views); !discarded.empty())
    warnings.insert(warnings.begin(), std::move(discarded));
  return warnings;
}

Pose pose_of(const py::handle& argument, const char* name) {
  const auto given = array_of_numbers(argument, name);
  const std::string wanted = std::string(name) + " must be a 4 x 4 matrix";
  if (!given) throw py::type_error(wanted + ", got " + short_repr(argument));
  const Numbers& a = *given;
  check_input(a.ndim() == 2 && a.shape(0) == 4 && a.shape(1) == 4, wanted.c_str());
  Pose pose;
  pose.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(a.data());
  if (!pose.matrix().allFinite()) throw InputError(std::string(name) + " is not finite: it holds NaN or infinity");
  const Eigen::RowVector4d last(0, 0, 0, 1);
  if (pose.matrix().row(3) != last)
    throw InputError(wanted + " whose last row is 0 0 0 1" +
                     (pose.matrix().col(3).transpose() == last ? ". Is it transposed?" : ""));
  return pose;
}

void bind_results(py::module_& m) {
  bind_body(m);
  bind_picking(m);
  bind_fruit(m);
  bind_view(m);
  bind_result(m);
}

}  // namespace agrisee::python
