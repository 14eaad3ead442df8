// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/geometry/angle.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/mcap.hpp>
#include <agrisee/sensor/depth_encoding.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "io/formats/mcap.hpp"
#include "io/formats/text.hpp"
#include "io/results/transform_tree.hpp"

namespace agrisee::io {

namespace fs = std::filesystem;

/// What a recording keeps in memory.
struct McapRecording::Parts {
  fs::path path;
  Workcell workcell;
  std::vector<mcap::Message> images;  ///< of the views
  std::vector<Pose> poses;
  std::vector<std::string> warnings;
  sensor::Distortion distortion;
};

namespace {

/// Read a message and take it apart. @throws FileError that names file and topic
template <typename Read>
auto taken(const fs::path& path, const mcap::Contents& contents, const mcap::Message& message, Read&& read) {
  const std::string bytes = mcap::read_message(path, message);
  try {
    return read(bytes);
  } catch (const InputError& e) {
    fail(path, contents.channels.at(message.channel).topic + ": a message " + e.what());
  }
}

/// The beginning of a message, enough for the time in its header: images are large.
mcap::Message head_of(mcap::Message message) {
  message.size = std::min(message.size, ros::kTimeSize);
  return message;
}

bool has_type(const mcap::Channel& channel, const ros::Type& type) {
  return channel.schema == type.name && channel.encoding == "cdr";
}

/// The messages of all channels of a type.
std::vector<mcap::Message> messages_of(const mcap::Contents& contents, const ros::Type& type) {
  std::vector<mcap::Message> out;
  for (const mcap::Message& message : contents.messages)
    if (has_type(contents.channels.at(message.channel), type)) out.push_back(message);
  return out;
}

ros::TransformTree tree_of(const fs::path& path, const mcap::Contents& contents) {
  ros::TransformTree tree;
  for (const mcap::Message& message : messages_of(contents, ros::kTransforms)) {
    const std::string& topic = contents.channels.at(message.channel).topic;
    const bool is_static = topic.size() >= 10 && topic.compare(topic.size() - 10, 10, "/tf_static") == 0;
    for (const ros::Transform& t : taken(path, contents, message, ros::read_transforms)) tree.add(t, is_static);
  }
  tree.finish();
  return tree;
}

/// The images of the chosen topic, or of the only one with depth. @throws FileError if there is none, or there are more
std::vector<mcap::Message> depth_images(const fs::path& path, const mcap::Contents& contents,
                                        const std::string& wanted) {
  std::map<std::string, std::vector<mcap::Message>> by_topic;
  for (const mcap::Message& message : messages_of(contents, ros::kImage))
    by_topic[contents.channels.at(message.channel).topic].push_back(message);
  std::vector<std::string> depth, all;
  for (const auto& [topic, messages] : by_topic) {
    all.push_back(topic);
    const std::string encoding = taken(path, contents, messages.front(),
                                       [](const std::string& bytes) { return ros::read_image(bytes).encoding; });
    if (sensor::depth_bytes(encoding) > 0) depth.push_back(topic);
  }
  if (!wanted.empty()) {
    if (!by_topic.count(wanted)) fail(path, "has no images on " + wanted + did_you_mean(wanted, all));
    return by_topic[wanted];
  }
  if (depth.empty() && contents.cut_off)
    fail(path,
         "is cut off before the end of its first chunk with depth images; it was perhaps copied while it was recorded");
  if (depth.empty())
    fail(path, "has no depth images (sensor_msgs/msg/Image with 16UC1 or 32FC1, of " + std::to_string(all.size()) +
                   " topics with images)");
  if (depth.size() > 1) {
    std::string list;
    for (const std::string& topic : depth) list += (list.empty() ? "" : ", ") + topic;
    fail(path, "has depth images on several topics: " + list + ". Choose one (--topic)");
  }
  return by_topic[depth.front()];
}

/// The camera of images.
struct Camera {
  sensor::Intrinsics intrinsics;
  sensor::Distortion distortion;  // none of rectified images
};

/// The camera of an image: that of the topic beside it, else any of its frame. @throws FileError if there is none
Camera camera_of(const fs::path& path, const mcap::Contents& contents, const std::string& topic,
                 const ros::Image& image) {
  const std::string beside = topic.substr(0, topic.rfind('/')) + "/camera_info";
  std::optional<ros::CameraInfo> found;
  std::set<std::uint16_t> looked_at;
  for (const mcap::Message& message : messages_of(contents, ros::kCameraInfo)) {
    if (!looked_at.insert(message.channel).second) continue;
    ros::CameraInfo info = taken(path, contents, message, ros::read_camera_info);
    const bool is_beside = contents.channels.at(message.channel).topic == beside;
    if (!is_beside && (found || info.header.frame != image.header.frame)) continue;
    found = std::move(info);
    if (is_beside) break;
  }
  if (!found) fail(path, "has no sensor_msgs/msg/CameraInfo for " + topic + " (" + beside + ")");
  const sensor::CameraInfo& info = found->camera;
  if (info.width != image.width || info.height != image.height)
    fail(path, "the camera of " + topic + " does not fit its images: " + std::to_string(info.width) + " x " +
                   std::to_string(info.height) + " pixels against " + std::to_string(image.width) + " x " +
                   std::to_string(image.height));
  const bool rectified = topic.find("image_rect") != std::string::npos;  // as image_proc and camera drivers call it
  try {
    return {sensor::intrinsics_of(info, rectified), rectified ? sensor::Distortion() : sensor::distortion_of(info)};
  } catch (const InputError& e) {
    fail(path, "the camera of " + topic + ": " + e.what());
  }
}

std::string world_of(const fs::path& path, const ros::TransformTree& tree, const std::string& frame,
                     const std::string& wanted) {
  const std::vector<std::string> chain = tree.chain(frame);
  const auto has = [&](const std::string& name) { return std::find(chain.begin(), chain.end(), name) != chain.end(); };
  if (!wanted.empty()) {
    if (!has(wanted)) fail(path, "no transform leads from '" + wanted + "' to the camera's frame '" + frame + "'");
    return wanted;
  }
  if (chain.size() < 2) fail(path, "has no transform (tf) to the camera's frame '" + frame + "'");
  return has("world") ? "world" : has("base_link") ? "base_link" : chain.back();
}

bool near(const Pose& a, const Pose& b, double move, double turn) {
  return (a.translation() - b.translation()).norm() < move && turn_between(a, b) < turn;
}

/// "-0.2 0.4 0" of a record of metadata.
std::optional<Eigen::Vector3d> three_numbers_of(const std::map<std::string, std::string>& values, const char* key) {
  const auto found = values.find(key);
  if (found == values.end()) return std::nullopt;
  std::string_view rest = found->second;
  Eigen::Vector3d out;
  for (int a = 0; a < 3; ++a) {
    const auto number = to_number(next_word(rest));
    if (!number) return std::nullopt;
    out[a] = *number;
  }
  return out;
}

}  // namespace

McapRecording::McapRecording(const fs::path& path, const McapChoice& choice) : parts_(std::make_shared<Parts>()) {
  parts_->path = path;
  const mcap::Contents contents = mcap::read_contents(path);
  std::vector<mcap::Message> images = depth_images(path, contents, choice.topic);
  std::stable_sort(images.begin(), images.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
  const std::string topic = contents.channels.at(images.front().channel).topic;
  const ros::Image image = taken(path, contents, images.front(), [](const std::string& bytes) {
    ros::Image head = ros::read_image(bytes);
    head.data = {};  // it refers to the bytes
    return head;
  });
  const Camera camera = camera_of(path, contents, topic, image);
  const ros::TransformTree tree = tree_of(path, contents);
  const std::string world = world_of(path, tree, image.header.frame, choice.world_frame);
  Workcell& cell = parts_->workcell;
  cell.name = path.filename().string();
  cell.sensor.intrinsics = camera.intrinsics;
  parts_->distortion = camera.distortion;
  cell.sensor.range_min = 0.0;
  cell.sensor.range_max = 1e6;  // an image holds only what was in range
  if (const auto own = contents.metadata.find("agrisee"); own != contents.metadata.end()) {
    const auto least = three_numbers_of(own->second, "scan_volume_min");
    const auto most = three_numbers_of(own->second, "scan_volume_max");
    if (least && most) cell.scan_volume.min = *least, cell.scan_volume.max = *most;
  }
  std::size_t without_pose = 0, moving = 0;
  const auto rest = static_cast<std::uint64_t>(choice.rest * 1e9);
  for (const mcap::Message& message : images) {
    const std::uint64_t time = taken(path, contents, head_of(message), ros::read_time);
    const auto pose = tree.pose(world, image.header.frame, time);
    if (!pose) {
      ++without_pose;
      continue;
    }
    // Where nothing is known of the time before, such as at the beginning, that after it tells.
    auto other = time > rest ? tree.pose(world, image.header.frame, time - rest, true) : std::nullopt;
    if (!other) other = tree.pose(world, image.header.frame, time + rest, true);
    if (other && !near(*other, *pose, choice.rest_move, choice.rest_turn)) {
      ++moving;
      continue;
    }
    if (!parts_->poses.empty() && near(parts_->poses.back(), *pose, choice.least_move, choice.least_turn)) continue;
    parts_->images.push_back(message);
    parts_->poses.push_back(*pose);
    if (parts_->poses.size() == 1)
      if (const auto base = tree.pose(world, "base_link", time)) cell.world_T_base = *base;
  }
  if (parts_->poses.empty())
    fail(path, "none of its " + std::to_string(images.size()) +
                   " depth images can be a view: " + std::to_string(without_pose) +
                   " have no pose at that time (tf), during " + std::to_string(moving) + " the camera moved");
  const auto warn = [&](const std::string& text) { parts_->warnings.push_back(text); };
  if (contents.cut_off) warn(path.filename().string() + " is cut off: its end is missing");
  if (without_pose > 0) warn(std::to_string(without_pose) + " depth images have no pose at their time (tf)");
}

const Workcell& McapRecording::workcell() const { return parts_->workcell; }
const std::vector<Pose>& McapRecording::world_T_optical() const { return parts_->poses; }
const std::vector<std::string>& McapRecording::warnings() const { return parts_->warnings; }

sensor::DepthFrame McapRecording::frame(std::size_t view) const {
  check_input(view < parts_->images.size(), "McapRecording::frame: there is no view with this number");
  const std::string bytes = mcap::read_message(parts_->path, parts_->images[view]);
  sensor::DepthFrame frame;
  frame.intrinsics = parts_->workcell.sensor.intrinsics;
  try {
    const ros::Image image = ros::read_image(bytes);
    check_input(static_cast<int>(image.width) == frame.intrinsics.width &&
                    static_cast<int>(image.height) == frame.intrinsics.height,
                "the size of the images changes");
    frame.depth = ros::depths_of(image);
    sensor::check_depth_unit(frame);
    return sensor::rectified(frame, parts_->distortion);
  } catch (const InputError& e) {
    fail(parts_->path, "view " + std::to_string(view) + ": " + e.what());
  }
}

}  // namespace agrisee::io
