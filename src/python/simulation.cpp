// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/ground_truth.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/simulated_scan.hpp>
#include <agrisee/study/truss.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "parameters.hpp"
#include "results.hpp"
#include "running.hpp"
#include "workcell.hpp"

namespace agrisee::python {
namespace {

namespace fs = std::filesystem;

SharedResult scan(const fs::path& scene, const std::string& noise, std::uint64_t seed, const py::object& parameters,
                  const py::object& planner, const py::object& reach, const py::object& progress, int threads) {
  Parameters values = parameters_of(parameters);
  if (!planner.is_none()) values.planner = text_of(planner, "planner");
  values.check();
  if (!progress.is_none() && !PyCallable_Check(progress.ptr())) throw py::type_error("progress must be a function");
  study::SimulationOptions options;
  options.noise = study::parse_noise(noise);
  options.seed = seed;
  options.threads = threads_of(threads);
  options.reach = reach_of(function_of(reach, "reach"));
  if (!progress.is_none())
    options.on_view = [&](const Pipeline& pipeline) {
      call_back([&] { progress(pipeline.views().size(), pipeline.views().back()); });
    };
  return shared(interruptible([&] {
    const io::SceneFile file = io::read_scene(scene_file(scene));
    const study::TracedScene traced(file.scene, options.threads);
    ScanResult result = study::scan(file.workcell, traced, values, std::move(options));
    result.warnings.insert(result.warnings.begin(), file.warnings.begin(), file.warnings.end());
    return result;
  }));
}

fs::path make_truss(const fs::path& folder, int total, int hidden, std::uint64_t seed, bool force) {
  if (std::error_code error; !force && fs::exists(folder / "scene.yaml", error))
    throw FileError(folder.string() + ": already holds a scene; use force=True to overwrite it");
  study::TrussParameters parameters;
  parameters.total = total;
  parameters.hidden = hidden;
  parameters.seed = seed;
  interruptible([&] {
    study::Truss truss = study::make_truss(parameters);
    truss.workcell.name = "truss";
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw FileError(folder.string() + ": " + error.message());
    io::write_scene(folder / "scene.yaml", {truss.workcell, truss.scene, {}});
    io::write_ground_truth(folder / "ground_truth.json", truss.truth);
    return true;
  });
  return folder / "scene.yaml";
}

/// A camera in a scene.
class Camera {
 public:
  Camera(const fs::path& scene, const std::string& noise, std::uint64_t seed, int threads)
      : file_(io::read_scene(scene_file(scene))),
        noise_(study::parse_noise(noise)),
        seed_(seed),
        threads_(threads_of(threads)),
        traced_(file_.scene, threads_) {}

  const Workcell& workcell() const { return file_.workcell; }

  py::array capture(const py::object& pose) {
    const Pose world_T_optical = pose_of(pose, "pose");
    const sensor::Intrinsics& k = file_.workcell.sensor.intrinsics;
    const std::uint64_t number = taken_++;
    study::Capture taken = interruptible([&] {
      return study::capture(traced_, file_.workcell.sensor, world_T_optical, noise_, seed_, number, threads_);
    });
    return py::array(owned(std::move(taken.frame.depth)).attr("reshape")(k.height, k.width));
  }

 private:
  io::SceneFile file_;
  study::NoiseModel noise_;
  std::uint64_t seed_, taken_ = 0;
  int threads_;
  study::TracedScene traced_;
};

}  // namespace

void bind_simulation(py::module_& m) {
  m.def("scan", &scan, py::arg("scene"), py::arg("noise") = "none", py::arg("seed") = 0,
        py::arg("parameters") = py::none(), py::arg("planner") = py::none(), py::arg("reach") = py::none(),
        py::arg("progress") = py::none(), py::arg("threads") = 0,
        R"(Scan a scene with a simulated camera and arm.

scene: path of a scene file, or of its folder.
noise: none, gaussian:SIGMA (m), l515, azure, d405 (each also with :shade or :sun), l515-white or rough.
seed: of noise and planner.
parameters, planner, reach, threads: as for Pipeline.
progress: progress(number of views taken, last View), called after each view; an exception ends the scan.

Returns a ScanResult.)");
  m.def("make_truss", &make_truss, py::arg("folder"), py::arg("total") = 7, py::arg("hidden") = 1, py::arg("seed") = 1,
        py::arg("force") = false,
        "Write a procedural truss with ground truth into a folder; returns the path of its scene.yaml. Raises "
        "FileError if the folder holds a scene, unless force is given.");
  py::class_<Camera>(m, "SimulatedCamera", "A simulated depth camera in a scene.")
      .def(py::init<const fs::path&, const std::string&, std::uint64_t, int>(), py::arg("scene"),
           py::arg("noise") = "none", py::arg("seed") = 0, py::arg("threads") = 0, "scene, noise: as for scan.")
      .def_property_readonly("workcell", &Camera::workcell, "the workcell of the scene")
      .def("capture", &Camera::capture, py::arg("pose"),
           "H x W float32: z (m) of each pixel as seen from the 4 x 4 pose world_T_optical; 0 = no return.");
}

}  // namespace agrisee::python
