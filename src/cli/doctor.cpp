// SPDX-License-Identifier: BSD-3-Clause
// agrisee doctor: what this program and this machine can do, and whether a workcell makes sense.
#include <agrisee/arm/collision.hpp>
#include <agrisee/geometry/angle.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/plan/arm_reach.hpp>
#include <agrisee/plan/directions.hpp>
#include <agrisee/study/limit.hpp>

#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <thread>
#include <unistd.h>

#include "commands.hpp"
#include "inputs.hpp"
#include "version.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;

/// How a line of the answer is meant: `missing` is only left out, `note` is unusual, `wrong` is a mistake.
enum class Level { ok, missing, note, wrong };

/// Prints findings, and remembers whether any is wrong.
class Findings {
 public:
  void title(const std::string& text) const { std::cout << "\n" << text << "\n"; }
  void tell(Level level, const std::string& text) {
    constexpr const char* kWords[] = {"ok    ", "none  ", "NOTE  ", "WRONG "};
    std::cout << "  " << kWords[static_cast<int>(level)] << text << "\n";
    notes_ += level == Level::note;
    wrong_ += level == Level::wrong;
  }
  std::size_t notes() const { return notes_; }
  std::size_t wrong() const { return wrong_; }

 private:
  std::size_t notes_ = 0, wrong_ = 0;
};

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str().find_first_not_of("-0.") == std::string::npos && value < 0.0 ? text.str().substr(1) : text.str();
}

/// "0.40 x 0.35 x 0.45 m"
std::string size_text(const Eigen::Vector3d& size) {
  return rounded(size.x(), 2) + " x " + rounded(size.y(), 2) + " x " + rounded(size.z(), 2) + " m";
}

/// "(0.00, 0.56, 0.22)"
std::string place_text(const Eigen::Vector3d& p) {
  return "(" + rounded(p.x(), 2) + ", " + rounded(p.y(), 2) + ", " + rounded(p.z(), 2) + ")";
}

/// The angle between two directions (degrees).
double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return angle_between(a, b) * 180.0 / kPi; }

/// Where a program lies in PATH; empty if it does not.
std::string found_in_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (const fs::path file = fs::path(folder) / program; ::access(file.c_str(), X_OK) == 0) return file.string();
  return "";
}

void look_at_machine(Findings& out) {
  out.title("Machine");
  out.tell(Level::ok, std::to_string(std::thread::hardware_concurrency()) + " threads at a time, " +
                          rounded(static_cast<double>(::sysconf(_SC_PHYS_PAGES)) *
                                      static_cast<double>(::sysconf(_SC_PAGE_SIZE)) / 1e9,
                                  1) +
                          " GB of memory");
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  if (error || ::access(temporary.c_str(), W_OK) != 0)
    out.tell(Level::note, "the temporary folder cannot be written, so clouds cannot come through a pipe (TMPDIR)");
  else
    out.tell(Level::ok, "temporary folder " + temporary.string());
  const std::string sqlite = sqlite_version();
  out.tell(sqlite.empty() ? Level::missing : Level::ok,
           sqlite.empty() ? "SQLite, for `agrisee merge --db` and `agrisee season`: install libsqlite3-dev, build again"
                          : "SQLite " + sqlite + ", for `agrisee merge --db` and `agrisee season`");
  struct Helper {
    const char *program, *what, *package;
  };
  constexpr Helper kHelpers[] = {{"parallel", "many scans on one machine", "parallel"},
                                 {"sbatch", "many scans on a cluster", "slurm-client"},
                                 {"snakemake", "many scans as a workflow", "snakemake"},
                                 {"sqlite3", "questions to a season's database", "sqlite3"}};
  for (const Helper& helper : kHelpers) {
    const std::string where = found_in_path(helper.program);
    out.tell(where.empty() ? Level::missing : Level::ok,
             std::string(helper.program) + ", for " + helper.what + ": " +
                 (where.empty() ? "package " + std::string(helper.package) : where));
  }
}

void look_at_units(const io::SceneFile& file, Findings& out) {
  constexpr double kShort = 0.05, kLong = 2.0, kTiny = 0.003, kHuge = 0.15;  // m
  const Eigen::Vector3d size = file.workcell.scan_volume.size();
  if (size.minCoeff() < kShort || size.maxCoeff() > kLong)
    out.tell(Level::note, "scan_volume: " + size_text(size) + "; most are between 5 cm and 2 m wide. Is it in metres?");
  else
    out.tell(Level::ok, "scan_volume: " + size_text(size) + " about " + place_text(file.workcell.scan_volume.center()));
  std::size_t fruit = 0;
  std::string odd, outside, cut;
  for (const study::Object& object : file.scene.objects) {
    if (object.cls != study::ObjectClass::fruit) continue;
    ++fruit;
    const Aabb box = bounding_box(object.mesh.vertices);
    const double radius = 0.5 * box.size().maxCoeff();
    const std::string id = std::to_string(object.id);
    if (radius < kTiny || radius > kHuge) odd += (odd.empty() ? "" : ", ") + id + " (" + rounded(radius, 3) + " m)";
    const Aabb& volume = file.workcell.scan_volume;
    if (!volume.contains(box.center()))
      outside += (outside.empty() ? "" : ", ") + id;
    else if (!volume.contains(box.min) || !volume.contains(box.max))
      cut += (cut.empty() ? "" : ", ") + id;
  }
  if (!odd.empty())
    out.tell(Level::note, "fruit with an odd radius: " + odd + ". Is its mesh in metres (scale: 0.001)?");
  if (!outside.empty()) out.tell(Level::note, "fruit outside of scan_volume, which will not be found: " + outside);
  if (!cut.empty()) out.tell(Level::note, "fruit that reach out of scan_volume, where nothing is measured: " + cut);
  if (odd.empty() && outside.empty() && cut.empty())
    out.tell(Level::ok, std::to_string(fruit) + " fruit, all inside the scan volume");
}

void look_at_frames(const io::SceneFile& file, Findings& out) {
  const Workcell& cell = file.workcell;
  for (const std::string& warning : file.warnings) out.tell(Level::note, warning);
  const Eigen::Vector3d base = cell.world_T_base.translation();
  const double tilt = degrees_between(cell.world_T_base.linear().col(2), Eigen::Vector3d::UnitZ());
  const std::string stands = "robot.base: " + std::string(cell.arm.name) + " at " + place_text(base);
  if (cell.scan_volume.contains(base))
    out.tell(Level::wrong, stands + ", inside of scan_volume: the arm would scan itself");
  else
    out.tell(Level::ok, stands + (tilt < 1.0 ? ", upright" : ", tilted by " + rounded(tilt, 0) + " degrees"));
  const double off = degrees_between(cell.tool0_T_optical.linear().col(2), Eigen::Vector3d::UnitZ());
  const double away = cell.tool0_T_optical.translation().norm();
  const std::string looks = "robot.tool: the camera is " + rounded(1e3 * away, 0) + " mm from tool0 and looks " +
                            (off < 1.0 ? "along its axis" : rounded(off, 0) + " degrees off its axis");
  if (off > 90.0)
    out.tell(Level::wrong, looks +
                               ", back at the arm. It is the pose of the optical frame (z forward) in tool0, not "
                               "that of tool0 in the optical frame");
  else if (off > 60.0 || away > 0.3)
    out.tell(Level::note, looks + ". Is it the pose of the optical frame (z forward, x right, y down), in metres?");
  else
    out.tell(Level::ok, looks);
  if (cell.tool0_T_tool)
    out.tell(Level::ok,
             "robot.gripper: the gripping point is at " + place_text(cell.tool0_T_tool->translation()) + " in tool0");
  else
    out.tell(
        file.scene.objects.empty() ? Level::note : Level::ok,
        "robot.gripper: not given, so the gripping point is on the optical axis, picking.tool_length (by default 0) "
        "ahead of the camera");
  const arm::Mount mount = plan::mount_of(cell);
  if (const auto contact = arm::find_collision(cell.start, mount)) {
    out.tell(Level::note, "robot.start: " + std::string(arm::to_string(contact->part)) + " is inside of " +
                              std::string(contact->with) + ": the first move starts there");
    return;
  }
  const Pose start = optical_pose(cell, cell.start);
  out.tell(Level::ok, "robot.start: the camera is at " + place_text(start.translation()) + " and looks along " +
                          place_text(start.linear().col(2)) + ", touching nothing");
}

void look_at_camera(const Workcell& cell, Findings& out) {
  const plan::ViewRequest usual;
  const sensor::Intrinsics& k = cell.sensor.intrinsics;
  const double pixel = 1e3 * usual.distance / std::min(k.fx, k.fy);  // mm
  const auto angle = [](int pixels, double focal) { return rounded(std::atan(0.5 * pixels / focal) * 360.0 / kPi, 0); };
  const std::string text = "sensor: " + std::to_string(k.width) + " x " + std::to_string(k.height) + " pixels over " +
                           angle(k.width, k.fx) + " x " + angle(k.height, k.fy) + " degrees, a pixel covers " +
                           rounded(pixel, 1) + " mm at the usual distance of " + rounded(usual.distance, 2) +
                           " m, range " + rounded(cell.sensor.range_min, 2) + " to " +
                           rounded(cell.sensor.range_max, 2) + " m";
  if (cell.sensor.range_min > usual.distance_max || cell.sensor.range_max < usual.distance_min)
    out.tell(Level::wrong, text + ": views are taken from " + rounded(usual.distance_min, 2) + " to " +
                               rounded(usual.distance_max, 2) + " m, out of this range");
  else
    out.tell(pixel > 2.0 ? Level::note : Level::ok, text + (pixel > 2.0 ? ": coarse for fruit" : ""));
}

void look_at_reach(const Workcell& cell, int threads, Findings& out) {
  study::LimitParameters tried;
  tried.candidates = 500;
  const auto count = [&](const Workcell& with) {
    return study::reachable_views(plan::reach_of(with), with.start, with.scan_volume, tried, threads);
  };
  const std::vector<plan::ReachableView> views = count(cell);
  const Eigen::Vector3d front = plan::frontal_direction(cell.scan_volume, cell.world_T_base.translation());
  double nearest = 180.0;
  for (const plan::ReachableView& view : views)
    nearest = std::min(nearest, degrees_between(view.world_T_optical.linear().col(2), front));
  const Eigen::Vector3d to = cell.scan_volume.center() - cell.world_T_base.translation();
  const double away = to.norm();
  const std::string where = "the middle of scan_volume is " + rounded(away, 2) + " m from the base";
  std::string text = "reach: the arm takes " + std::to_string(views.size()) + " of " +
                     std::to_string(tried.candidates) + " views of the volume from all around";
  Workcell free = cell;
  free.keep_out.clear();
  const std::size_t unhindered = cell.keep_out.empty() ? views.size() : count(free).size();
  if (unhindered > views.size()) text += " (" + std::to_string(unhindered) + " without keep_out)";
  constexpr double kFrontal = 30.0;  // degrees
  if (views.empty())
    out.tell(Level::wrong,
             text + "; " + where +
                 (unhindered > 0 ? ". keep_out stands in the way" : ". Is it too near or too far, or behind the arm?"));
  else if (views.size() < static_cast<std::size_t>(tried.candidates) / 100 || nearest > kFrontal)
    out.tell(Level::note, text + ", the most frontal " + rounded(nearest, 0) + " degrees off; " + where +
                              ". `agrisee limit --base-search` looks for a better place");
  else
    out.tell(Level::ok, text + "; " + where);
}

int run_doctor(const std::string& scene) {
  Findings out;
  std::cout << version_text() << "\n";
  look_at_machine(out);
  if (scene.empty()) {
    std::cout << "\nTo check a workcell: agrisee doctor scene.yaml\n";
    return kSuccess;
  }
  const std::string path = scene_file(scene);
  const io::SceneFile file = io::read_scene(path);
  out.title("Workcell " + file.workcell.name + " (" + path + ")");
  plan::mount_of(file.workcell).check();
  look_at_units(file, out);
  look_at_frames(file, out);
  look_at_camera(file.workcell, out);
  if (out.wrong() == 0) look_at_reach(file.workcell, threads_of(0), out);  // else it would mean nothing
  std::cout << "\n" << out.wrong() << " wrong, " << out.notes() << " to look at\n";
  return out.wrong() > 0 ? kBadInput : kSuccess;
}

}  // namespace

void add_doctor(CLI::App& app, Run& run) {
  auto* command =
      app.add_subcommand("doctor", "show what is installed, and check a workcell: units, frames, camera, reach");
  auto scene = std::make_shared<std::string>();
  command->add_option("scene", *scene, "scene file (YAML) of the workcell to check, or a folder with scene.yaml");
  command->footer(
      "WRONG marks a mistake that makes a scan fail or find little (exit code 2). NOTE marks what is unusual.\n"
      "Example:\n  agrisee doctor truss/scene.yaml");
  command->callback([scene, &run] { run = [scene] { return run_doctor(*scene); }; });
}

}  // namespace agrisee::cli
