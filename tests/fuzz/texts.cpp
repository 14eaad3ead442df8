// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/mesh_file.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scan_record.hpp>
#include <agrisee/io/scene.hpp>

#include <algorithm>

#include "seeds.hpp"
#include "targets.hpp"

namespace agrisee::fuzz {

namespace fs = std::filesystem;

void scene(const std::uint8_t* data, std::size_t size) {
  static const bool ready = (io::write_stl(scratch() / "fruit_1.stl", seed_mesh()), true);
  require(ready, "a mesh stands beside the scene");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (text.find("/proc") != text.npos || text.find("/dev") != text.npos) return;  // absolute: the user's own choice
  const fs::path path = scratch() / "scene.yaml";
  io::write_file(path, text);
  attempt([&] {
    const io::SceneFile file = io::read_scene(path);
    require(!file.workcell.scan_volume.empty() && file.workcell.scan_volume.size().allFinite(), "a volume to scan");
    require(is_rigid(file.workcell.world_T_base) && is_rigid(file.workcell.tool0_T_optical), "rigid poses");
    require(file.workcell.start.allFinite(), "finite joints");
    file.workcell.sensor.check();
  });
}

void parameters(const std::uint8_t* data, std::size_t size) {
  const fs::path path = as_file(data, size);
  attempt([&] {
    const Parameters read = io::read_parameters(path.string());
    const std::string yaml = io::parameters_to_yaml(read), json = io::parameters_to_json(read);
    const fs::path again = as_file(reinterpret_cast<const std::uint8_t*>(yaml.data()), yaml.size());
    require(io::parameters_to_yaml(io::read_parameters(again.string())) == yaml, "parameters survive as YAML");
    require(io::parameters_to_yaml(io::parameters_from_json(json, "json")) == yaml, "and as JSON");
  });
}

void records(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return;
  const std::uint8_t which = data[0];
  ++data, --size;
  attempt([&] {
    switch (which) {
      case 't': {
        const io::ScanTask task = io::read_scan_task(as_file(data, size));
        task.parameters.check();
        break;
      }
      case 'v': {
        static const fs::path path = io::view_record_path(scratch(), 2);
        static const bool made = fs::create_directories(path.parent_path());
        require(made, "a folder for the record");
        io::write_file(path, {reinterpret_cast<const char*>(data), size});
        const auto record = io::read_view_record(scratch(), 2, "scan", 48);
        require(record && record->frame.depth.size() == 48, "as many depths as pixels");
        break;
      }
      case 'r':
        io::read_run(as_file(data, size));
        break;
      case 'f':
        io::read_fruits(as_file(data, size));
        break;
      case 'c':
        for (const View& view : io::read_views(as_file(data, size)))
          require(is_rigid(view.world_T_optical), "poses of views are rigid");
        break;
      default:
        break;
    }
  });
}

}  // namespace agrisee::fuzz
