// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/mcap.hpp>
#include <agrisee/io/recorded_views.hpp>

#include "targets.hpp"

namespace agrisee::fuzz {

void depth(const std::uint8_t* data, std::size_t size) {
  attempt([&] {
    const io::DepthImage image = io::read_depth_image(as_file(data, size));
    require(image.width > 0 && image.height > 0, "an image has pixels");
    require(image.values.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
            "one value a pixel");
    sensor::Intrinsics k;
    k.width = image.width;
    k.height = image.height;
    const sensor::DepthFrame frame = io::to_frame(image, k, io::default_depth_scale(image));
    for (const float z : frame.depth) require(z >= 0.0f, "a depth is positive, or 0");
  });
}

void recorded(const std::uint8_t* data, std::size_t size) {
  static const bool ready = [] {
    sensor::DepthFrame frame;
    frame.intrinsics = {4, 2, 5.0, 6.0, 1.5, 0.5};
    frame.depth.assign(8, 0.5f);
    io::write_depth_png(scratch() / "d.png", frame);
    return true;
  }();
  require(ready, "a depth image stands beside views.yaml");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  if (text.find("/proc") != text.npos || text.find("/dev") != text.npos) return;  // absolute: the user's own choice
  const std::filesystem::path path = scratch() / "views.yaml";
  io::write_file(path, text);
  attempt([&] {
    const io::RecordedViews read = io::read_recorded_views(path);
    require(!read.views.empty() && is_rigid(read.workcell.world_T_base), "views, and a rigid base");
    for (std::size_t i = 0; i < read.views.size(); ++i) {
      require(is_rigid(read.views[i].world_T_optical), "poses are rigid");
      attempt([&] { check(io::read_frame(read, i)); });
    }
    io::write_recorded_views(scratch() / "again.yaml", read);
    require(io::read_recorded_views(scratch() / "again.yaml").views.size() == read.views.size(), "views survive");
  });
}

void mcap(const std::uint8_t* data, std::size_t size) {
  attempt([&] {
    const io::McapRecording recording(as_file(data, size));
    require(!recording.world_T_optical().empty(), "a recording has views");
    for (std::size_t i = 0; i < recording.world_T_optical().size(); ++i) {
      require(is_rigid(recording.world_T_optical()[i]), "poses are rigid");
      attempt([&] { check(recording.frame(i)); });
    }
  });
}

}  // namespace agrisee::fuzz
