// SPDX-License-Identifier: BSD-3-Clause
#include "workcell.hpp"

#include <agrisee/core/cancellation.hpp>
#include <agrisee/io/scene.hpp>

#include <memory>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "archive.hpp"
#include "arrays.hpp"
#include "bindings.hpp"
#include "parameters.hpp"
#include "results.hpp"

namespace agrisee::python {
namespace {

/// What JSON has no notation for as something that it has: mappings as dicts, arrays as lists.
py::object plain(const py::object& value) {
  if (const auto values = dict_of(value)) return *values;
  return value.attr("tolist")();
}

/// A workcell from a dict with the keys of scene.yaml; `name` and `objects` may be left out.
Workcell from_dict(const py::dict& values) {
  py::dict scene = values.attr("copy")();
  if (!scene.contains("name")) scene["name"] = "workcell";
  if (!scene.contains("objects")) scene["objects"] = py::list();
  const auto text = py::module_::import("json").attr("dumps")(scene, py::arg("default") = py::cpp_function(&plain),
                                                              py::arg("allow_nan") = false);
  try {
    return io::scene_from_yaml(text.cast<std::string>(), "workcell").workcell;  // JSON is YAML
  } catch (const FileError& e) {
    throw ParameterError(e.what());
  }
}

std::string repr(const Workcell& cell) {
  const Eigen::Vector3d size = cell.scan_volume.size();
  const sensor::Intrinsics& k = cell.sensor.intrinsics;
  return "<Workcell '" + cell.name + "': " + std::string(cell.arm.name) + ", camera of " + std::to_string(k.width) +
         " x " + std::to_string(k.height) + " pixels, scan volume of " + number_text(size.x(), 3) + " x " +
         number_text(size.y(), 3) + " x " + number_text(size.z(), 3) + " m>";
}

py::dict intrinsics_of(const Workcell& cell) {
  const sensor::Intrinsics& k = cell.sensor.intrinsics;
  py::dict out;
  out["width"] = k.width;
  out["height"] = k.height;
  out["fx"] = k.fx;
  out["fy"] = k.fy;
  out["cx"] = k.cx;
  out["cy"] = k.cy;
  return out;
}

py::object tool_of(const Workcell& cell) {
  return cell.tool0_T_tool ? py::cast(matrix_of(*cell.tool0_T_tool)) : py::none();
}

void bind_cell(py::module_& m) {
  py::class_<Workcell> cell(m, "Workcell",
                            "Arm, camera, scan volume and keep-out spaces; docs/formats.md has the keys.");
  cell.def_static(
          "from_yaml", [](const std::filesystem::path& path) { return io::read_scene(scene_file(path)).workcell; },
          py::arg("path"),
          "The workcell of a scene file, or of its folder. Raises FileError, which names line and key.")
      .def_static(
          "from_dict", [](const py::object& values) { return from_dict(mapping_of(values, "values")); },
          py::arg("values"),
          "A workcell from the keys of a scene file, as nested dicts or other mappings. Raises ParameterError, which "
          "names the key.")
      .def_readonly("name", &Workcell::name, "name of the scene, as in run.json")
      .def_property_readonly(
          "arm", [](const Workcell& c) { return std::string(c.arm.name); }, "name of the model")
      .def_property_readonly(
          "base", [](const Workcell& c) { return matrix_of(c.world_T_base); }, "4 x 4: the arm's base_link in world")
      .def_property_readonly(
          "hand_eye", [](const Workcell& c) { return matrix_of(c.tool0_T_optical); },
          "4 x 4: the optical frame in tool0")
      .def_property_readonly("tool", &tool_of, "4 x 4: the gripper's tool frame in tool0, or None")
      .def_property_readonly(
          "start", [](const Workcell& c) { return c.start; }, "joints before the first move (rad)")
      .def_property_readonly("intrinsics", &intrinsics_of, "dict: width, height, fx, fy, cx, cy of the depth image")
      .def_property_readonly(
          "scan_volume", [](const Workcell& c) { return std::pair(c.scan_volume.min, c.scan_volume.max); },
          "lower and upper corner of the volume to scan (m, world)")
      .def("__repr__", &repr);
  bind_pickle(cell);
}

void bind_views(py::module_& m) {
  using plan::ReachableView;
  using plan::ViewRequest;
  py::class_<ViewRequest> request(m, "ViewRequest",
                                  "A request to look at target from target - distance * direction (m, world).");
  request
      .def_property_readonly(
          "target", [](const ViewRequest& r) { return r.target; }, "the point to look at (m)")
      .def_property_readonly(
          "direction", [](const ViewRequest& r) { return r.direction; }, "unit vector from the sensor to the target")
      .def_readonly("distance", &ViewRequest::distance, "preferred distance from the sensor to the target (m)")
      .def_readonly("distance_min", &ViewRequest::distance_min, "shortest distance (m)")
      .def_readonly("distance_max", &ViewRequest::distance_max, "longest distance (m)")
      .def_property_readonly(
          "pose",
          [](const ViewRequest& r) { return matrix_of(look_along(r.target - r.distance * r.direction, r.direction)); },
          "4 x 4: the sensor at the preferred distance, its image upright")
      .def("__repr__", [](const ViewRequest& r) {
        return "<ViewRequest: look at " + py::str(py::cast(r.target)).cast<std::string>() + " along " +
               py::str(py::cast(r.direction)).cast<std::string>() + ">";
      });
  bind_pickle(request);
  py::class_<ReachableView> reachable(m, "ReachableView", "A view that the arm can take.");
  reachable
      .def(py::init([](const py::object& pose, const py::object& target, const py::object& joints, double move_time) {
             ReachableView view;
             view.world_T_optical = pose_of(pose, "pose");
             view.target =
                 vector_of<3>(target, "target").value_or(view.world_T_optical * Eigen::Vector3d(0, 0, kViewDistance));
             view.joints = vector_of<6>(joints, "joints");
             check_parameter(std::isfinite(move_time) && move_time >= 0.0, "move_time", "zero or more", move_time);
             view.move_time = move_time;
             return view;
           }),
           py::arg("pose"), py::arg("target") = py::none(), py::arg("joints") = py::none(), py::arg("move_time") = 0.0,
           "pose: 4 x 4, world_T_optical; target: the point looked at (m), by default 0.38 m ahead; joints: six "
           "numbers (rad), or None if the arm does not report them; move_time: duration of the move there (s).")
      .def_property_readonly(
          "pose", [](const ReachableView& v) { return matrix_of(v.world_T_optical); },
          "4 x 4 pose of the sensor: world_T_optical")
      .def_property_readonly(
          "target", [](const ReachableView& v) { return v.target; }, "the point looked at, on the optical axis (m)")
      .def_readonly("joints", &ReachableView::joints, "six joint angles (rad), or None")
      .def_readonly("move_time", &ReachableView::move_time, "duration of the move there (s)")
      .def_readonly("gain", &ReachableView::gain, "what the planner expects to gain from it, in the planner's own unit")
      .def("__repr__", [](const ReachableView& v) {
        return "<ReachableView at " + py::str(py::cast(v.target)).cast<std::string>() + ", " +
               number_text(v.move_time, 3) + " s away>";
      });
  bind_pickle(reachable);
}

}  // namespace

std::filesystem::path scene_file(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error) ? path / "scene.yaml" : path;
}

Workcell workcell_of(const py::object& argument) {
  if (py::isinstance<Workcell>(argument)) return argument.cast<Workcell>();
  if (const auto values = dict_of(argument)) return from_dict(*values);
  if (py::isinstance<py::str>(argument) || py::hasattr(argument, "__fspath__"))
    return io::read_scene(scene_file(argument.cast<std::filesystem::path>())).workcell;
  throw py::type_error("workcell must be agrisee.Workcell, a dict, or the path of a scene file, got " +
                       short_repr(argument));
}

SharedFunction function_of(const py::object& argument, const char* name) {
  if (argument.is_none()) return nullptr;
  if (!PyCallable_Check(argument.ptr()))
    throw py::type_error(std::string(name) + " must be a function, got " + short_repr(argument));
  return {new py::object(argument), [](const py::object* object) {
            const py::gil_scoped_acquire python;
            delete object;
          }};
}

plan::Reach reach_of(const SharedFunction& function) {
  if (!function) return {};
  return [function](const plan::ViewRequest& request, const Joints& current) -> std::optional<plan::ReachableView> {
    throw_if_cancelled();
    const py::gil_scoped_acquire python;
    const py::object answer = (*function)(request, current);
    if (answer.is_none()) return std::nullopt;
    if (!py::isinstance<plan::ReachableView>(answer))
      throw py::type_error("reach must return agrisee.ReachableView or None, got " + short_repr(answer));
    return answer.cast<plan::ReachableView>();
  };
}

void bind_workcell(py::module_& m) {
  bind_cell(m);
  bind_views(m);
}

}  // namespace agrisee::python
