// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/pipeline.hpp>
#include <agrisee/sensor/rectify.hpp>

#include <cstring>
#include <limits>
#include <mutex>
#include <pybind11/stl.h>
#include <string_view>
#include <type_traits>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "parameters.hpp"
#include "results.hpp"
#include "running.hpp"
#include "workcell.hpp"

namespace agrisee::python {
namespace {

/// A pipeline, and where its arm stands.
class Scan {
 public:
  Scan(const Workcell& workcell, const Parameters& parameters, PipelineOptions options, SharedFunction reach)
      : pipeline_(workcell, parameters, std::move(options)), reach_(std::move(reach)), joints_(workcell.start) {}

  /// Call f with the pipeline as interruptible work. @throws BusyError if another call is not over
  template <typename F>
  auto run(F&& f) {
    const std::unique_lock<std::mutex> lock = begin();
    return interruptible([&] { return f(pipeline_); });
  }

  /// Read from the pipeline. @throws BusyError as run
  template <typename F>
  auto read(F&& f) {
    const std::unique_lock<std::mutex> lock = begin();
    return f(pipeline_);
  }

  /// Joints from an argument, or where the arm went last (rad).
  Joints joints_or_last(const py::object& argument) const { return vector_of<6>(argument, "joints").value_or(joints_); }
  /// The Python function that the pipeline owns; null without one.
  const SharedFunction& reach() const { return reach_; }
  /// The arm has moved.
  void moved(const std::optional<Joints>& joints) {
    if (joints) joints_ = *joints;
  }

 private:
  std::unique_lock<std::mutex> begin() {
    std::unique_lock<std::mutex> lock(busy_, std::try_to_lock);
    if (!lock)
      throw BusyError("this Pipeline is at work already: use one for each thread, and read from it between calls");
    return lock;
  }

  Pipeline pipeline_;
  SharedFunction reach_;  // the one in the pipeline
  Joints joints_;
  std::mutex busy_;
};

std::unique_ptr<Scan> make_scan(const py::object& workcell, const py::object& parameters, const py::object& planner,
                                const py::object& reach, std::uint64_t seed, int threads) {
  Parameters values = parameters_of(parameters);
  if (!planner.is_none()) {
    values.planner = text_of(planner, "planner");
    values.check();
  }
  PipelineOptions options;
  const SharedFunction function = function_of(reach, "reach");
  options.reach = reach_of(function);
  options.seed = seed;
  options.threads = threads_of(threads);
  return std::make_unique<Scan>(workcell_of(workcell), values, std::move(options), function);
}

/// z (m) of each pixel: the items of an image times a scale. As in files, the largest whole number is no return.
template <typename T>
std::vector<float> scaled(const py::array& image, double scale) {
  std::vector<float> depth;
  depth.reserve(static_cast<std::size_t>(image.size()));
  const auto factor = static_cast<float>(scale);
  for (py::ssize_t v = 0; v < image.shape(0); ++v)
    for (py::ssize_t u = 0; u < image.shape(1); ++u) {
      T item;  // fields of packed records need not be aligned
      std::memcpy(&item, image.data(v, u), sizeof item);
      const bool no_return = std::is_integral_v<T> && item == std::numeric_limits<T>::max();
      depth.push_back(no_return ? 0.0f : factor * static_cast<float>(item));
    }
  return depth;
}

/// A depth frame from an H x W array; masked items are no return.
sensor::DepthFrame frame_of(const py::handle& argument, const sensor::Intrinsics& intrinsics, double scale) {
  if (!py::isinstance<py::array>(argument))
    throw py::type_error("depth must be an array of float32 or uint16, got " +
                         py::str(py::type::of(argument).attr("__name__")).cast<std::string>());
  const auto image =
      has_mask(argument) ? py::array(argument.attr("filled")(0)) : py::reinterpret_borrow<py::array>(argument);
  const std::string shape = py::str(image.attr("shape")).cast<std::string>();
  if (image.ndim() != 2 || image.shape(0) != intrinsics.height || image.shape(1) != intrinsics.width)
    throw InputError("depth must have the shape (" + std::to_string(intrinsics.height) + ", " +
                     std::to_string(intrinsics.width) + ") of the workcell's camera, got " + shape);
  check_parameter(std::isfinite(scale) && scale > 0.0, "depth_scale", "positive", scale);
  sensor::DepthFrame frame;
  frame.intrinsics = intrinsics;
  if (py::isinstance<py::array_t<float>>(image))
    frame.depth = scaled<float>(image, scale);
  else if (py::isinstance<py::array_t<std::uint16_t>>(image))
    frame.depth = scaled<std::uint16_t>(image, scale);
  else
    throw py::type_error("depth must be float32 or uint16, got " + py::str(image.dtype()).cast<std::string>());
  return frame;
}

/// Coefficients from a list, or from an array of one row or column, as OpenCV has them; none from None.
std::vector<double> distortion_of(const py::object& argument) {
  if (argument.is_none()) return {};
  const auto given = array_of_numbers(argument, "distortion");
  if (!given)
    throw py::type_error("distortion must be a list of numbers, got " +
                         py::str(py::type::of(argument).attr("__name__")).cast<std::string>());
  const bool one_line = given->ndim() == 1 || (given->ndim() == 2 && (given->shape(0) == 1 || given->shape(1) == 1));
  check_input(one_line, "distortion must be a list of numbers, or an array with one row or column");
  return {given->data(), given->data() + given->size()};
}

/// Calls f; where it doubts the unit of depths, the message names the argument that sets it.
template <typename F>
View with_advice_on_units(F&& f) {
  try {
    return f();
  } catch (const InputError& e) {
    if (std::string_view(e.what()).find("its median depth is") == std::string_view::npos) throw;
    throw InputError(std::string(e.what()) +
                     " (depth_scale is the length of a unit: 0.001 for millimetres; 1, the default, for metres)");
  }
}

View observe(Scan& scan, const py::object& depth, const py::object& pose, const py::object& joints, double depth_scale,
             const py::object& distortion) {
  const Pose world_T_optical = pose_of(pose, "pose");
  const std::optional<Joints> at = vector_of<6>(joints, "joints");
  const sensor::Intrinsics intrinsics = scan.read([](const Pipeline& p) { return p.workcell().sensor.intrinsics; });
  const sensor::DepthFrame frame =
      sensor::rectified(frame_of(depth, intrinsics, depth_scale), sensor::distortion_from(distortion_of(distortion)));
  return scan.run([&](Pipeline& p) {
    const View view = with_advice_on_units([&] { return p.observe(frame, world_T_optical, at); });
    scan.moved(at);
    return view;
  });
}

View observe_points(Scan& scan, const py::object& points, const py::object& pose, const py::object& joints) {
  const py::array rows = array_of_rows(points, "points");
  const Pose world_T_optical = pose_of(pose, "pose");
  const std::optional<Joints> at = vector_of<6>(joints, "joints");
  return with_points(rows, [&](const auto& cloud) {
    return scan.run([&](Pipeline& p) {
      const View view = p.observe_points(cloud, world_T_optical, at);
      scan.moved(at);
      return view;
    });
  });
}

std::optional<plan::ReachableView> next_view(Scan& scan, const py::object& joints) {
  const Joints from = scan.joints_or_last(joints);
  scan.moved(from);
  return scan.run([&](Pipeline& p) { return p.next_view(from); });
}

py::object completeness_of(Scan& scan) {
  const auto c = scan.read([](const Pipeline& p) { return p.completeness(); });
  if (!c) return py::none();
  py::dict out;
  out["seen"] = c->seen;
  out["observable"] = c->observable;
  return std::move(out);
}

std::string repr(Scan& scan) {
  return scan.read([](const Pipeline& p) {
    std::string out = "<Pipeline of " + p.workcell().name + ": " + views_text(p.views()) + ", " +
                      std::to_string(p.merged().size()) + " points";
    if (p.stop_reason() != StopReason::not_stopped) out += std::string(", ended by ") + to_string(p.stop_reason());
    return out + ">";
  });
}

void bind_calls(py::class_<Scan>& scan) {
  scan.def("next_view", &next_view, py::arg("joints") = py::none(),
           "Where to look next, as a ReachableView, or None when the scan is over (stop_reason says why).\n\n"
           "joints: the arm's posture (six numbers, rad); by default that of the last observe, or the start.")
      .def(
          "refused", [](Scan& s) { s.read([](Pipeline& p) { return p.refused(), 0; }); },
          "Report that the arm could not take the view that next_view returned last; then ask for another one.")
      .def("observe", &observe, py::arg("depth"), py::arg("pose"), py::arg("joints") = py::none(),
           py::arg("depth_scale") = 1.0, py::arg("distortion") = py::none(),
           R"(Add a depth image to the scan and return the View as recorded.

depth: H x W, float32 or uint16: z along the optical axis, in metres after multiplication by depth_scale (0.001 for
  millimetres). Zero, negative, NaN and infinite values mean no return, and so do 65535 in uint16 and masked
  items.
pose: 4 x 4, world_T_optical, at which the image was really taken.
joints: six numbers (rad) at that moment, if an arm is known; warnings tell if they put the sensor elsewhere.
distortion: k1, k2, p1, p2, k3 of the lens (or 4 of them, or 8 with k4, k5, k6), to be removed, as a list or as OpenCV's
  arrays of one row or column; None or empty for a pinhole.

Raises InputError for a wrong shape, unit, pose or posture; the scan so far is kept.)")
      .def("observe_points", &observe_points, py::arg("points"), py::arg("pose"), py::arg("joints") = py::none(),
           "Like observe, for N x 3 points (m, optical frame) in any order.")
      .def(
          "result", [](Scan& s) { return shared(s.run([](Pipeline& p) { return p.result(); })); },
          "The ScanResult of the views so far: clean, segment and locate, and plan the picking.");
}

void bind_state(py::class_<Scan>& scan) {
  scan.def_property_readonly(
          "views", [](Scan& s) { return s.read([](Pipeline& p) { return p.views(); }); },
          "the views taken so far, a list of View")
      .def_property_readonly(
          "candidates", [](Scan& s) { return s.read([](Pipeline& p) { return p.candidates(); }); },
          "the views that the last next_view chose from, best first, a list of ReachableView")
      .def_property_readonly(
          "points",
          [](Scan& s) {
            return s.read([](Pipeline& p) { return owned(std::vector<Eigen::Vector3f>(p.merged().points)); });
          },
          "N x 3 float32: the cloud merged so far (m, world), a copy")
      .def_property_readonly(
          "stop_reason", [](Scan& s) { return s.read([](Pipeline& p) { return to_string(p.stop_reason()); }); },
          "why next_view last returned None")
      .def_property_readonly("completeness", &completeness_of,
                             "dict of shares of the fruit's surface, seen and observable, as the planner estimates; "
                             "or None")
      .def_property_readonly(
          "warnings", [](Scan& s) { return s.read([](Pipeline& p) { return warnings_of(p.warnings(), p.views()); }); },
          "sentences about views discarded so far, and input that should be checked")
      .def("__repr__", &repr);
}

/// The function that the pipeline in a Python object owns; null if the object is not complete.
py::object* owned_function(PyObject* self) {
  const auto* type = py::detail::get_type_info(typeid(Scan));
  const auto held = reinterpret_cast<py::detail::instance*>(self)->get_value_and_holder(type, false);
  if (!held.inst || !held.holder_constructed()) return nullptr;
  return held.value_ptr<Scan>()->reach().get();
}

/// Shows the function to Python's garbage collector. It often is a method of the object that keeps the pipeline: a
/// cycle.
void collect_cycles(PyHeapTypeObject* heap_type) {
  PyTypeObject& type = heap_type->ht_type;
  type.tp_flags |= Py_TPFLAGS_HAVE_GC;
  type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) {
    if (const py::object* function = owned_function(self)) Py_VISIT(function->ptr());
#if PY_VERSION_HEX >= 0x03090000
    Py_VISIT(Py_TYPE(self));
#endif
    return 0;
  };
  type.tp_clear = [](PyObject* self) {
    if (py::object* function = owned_function(self)) *function = py::none();
    return 0;
  };
}

}  // namespace

void bind_pipeline(py::module_& m) {
  py::class_<Scan> scan(
      m, "Pipeline", py::custom_type_setup(&collect_cycles),
      "One scan of one truss: observe each frame, ask next_view, move, repeat; then take the result.\n\n"
      "Calls raise KeyboardInterrupt within 50 ms of Ctrl-C and leave the scan as it was. Only observe may have taken "
      "the\n"
      "view in already; len(views) tells. During a call, also within reach, other calls and attributes raise "
      "BusyError.");
  scan.def(py::init(&make_scan), py::arg("workcell"), py::arg("parameters") = py::none(),
           py::arg("planner") = py::none(), py::arg("reach") = py::none(), py::arg("seed") = 0, py::arg("threads") = 0,
           R"(workcell: Workcell, a dict as of Workcell.from_dict, or the path of a scene file or its folder.
parameters: Parameters, or a dict of them.
planner: gain, see, fixed or random; by default that of the parameters.
reach: reach(request, joints) -> ReachableView or None, for an arm of your own: whether it can take a ViewRequest from
  its present joints (six numbers, rad). Called up to gain.candidates times per view, on a thread of the library.
seed: of the planner's random draws.
threads: 0 for all processor cores; the result does not depend on it.)");
  bind_calls(scan);
  bind_state(scan);
}

}  // namespace agrisee::python
