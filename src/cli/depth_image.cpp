// SPDX-License-Identifier: BSD-3-Clause
#include "depth_image.hpp"

#include <agrisee/io/depth_image.hpp>
#include <agrisee/io/detections.hpp>
#include <agrisee/process.hpp>
#include <agrisee/sensor/detection_check.hpp>
#include <agrisee/sensor/rectify.hpp>

#include <optional>

#include "commands.hpp"
#include "inputs.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

/// The depth image of --depth with its channels. @throws FileError, UsageError
sensor::DepthFrame frame_of(const DepthImageOptions& options) {
  const io::DepthImage image = io::read_depth_image(options.depth);
  sensor::Intrinsics k;
  k.width = image.width;
  k.height = image.height;
  k.fx = options.intrinsics[0];
  k.fy = options.intrinsics[1];
  k.cx = options.intrinsics[2];
  k.cy = options.intrinsics[3];
  if (!(k.fx > 0.0 && k.fy > 0.0)) throw UsageError("--intrinsics: fx and fy have to be above 0 (pixels)");
  if (!(k.cx >= -0.5 && k.cx <= k.width - 0.5 && k.cy >= -0.5 && k.cy <= k.height - 0.5))
    throw FileError(options.depth + ": has " + std::to_string(k.width) + " x " + std::to_string(k.height) +
                    " pixels, so the principal point cx,cy of --intrinsics lies outside of it");
  const double scale = options.depth_scale > 0.0 ? options.depth_scale : io::default_depth_scale(image);
  sensor::DepthFrame frame = io::to_frame(image, k, scale);
  try {
    sensor::check_depth_unit(frame);
  } catch (const InputError& e) {
    throw FileError(options.depth + ": " + e.what() + " (--depth-scale)");
  }
  io::add_channels(frame, {options.color, options.masks, options.boxes});
  try {
    return sensor::rectified(frame, sensor::distortion_from(options.distortion));
  } catch (const InputError& e) {
    throw UsageError("--distortion: " + std::string(e.what()));
  }
}

/// The points of a frame (m, optical frame) with the colors and detections of their pixels.
Cloud points_of(const sensor::DepthFrame& frame) {
  Cloud cloud;
  for (int v = 0; v < frame.intrinsics.height; ++v)
    for (int u = 0; u < frame.intrinsics.width; ++u) {
      if (!sensor::DepthFrame::valid(frame.at(u, v))) continue;
      const std::size_t pixel = frame.intrinsics.index(u, v);
      cloud.points.push_back(frame.point(u, v));
      if (!frame.color.empty()) cloud.colors.push_back(frame.color[pixel]);
      if (!frame.instances.empty()) cloud.instances.push_back(frame.instances[pixel]);
    }
  return cloud;
}

/// That no pixel has a depth, or that the scale of the depths may be wrong, if no fruit was found and the scale was not
/// given, or most bodies are of no expected size.
std::optional<std::string> doubt_of_scale(const ScanResult& result, double median_depth, bool given) {
  const BodyCounts& n = result.bodies;
  if (!result.fruits.empty()) return std::nullopt;
  if (!(median_depth > 0.0)) return "no pixel of the depth image has a depth";
  const std::string depth = "the median depth is " + metres(median_depth);
  if (2 * (n.too_large + n.too_small) > n.rejected())
    return "most surfaces are too " + std::string(n.too_large > n.too_small ? "large" : "small") + " for fruit, and " +
           depth + ": is --depth-scale right?";
  if (given) return std::nullopt;
  return depth + " at the default --depth-scale: is that right?";
}

}  // namespace

void add_depth_image_options(CLI::App& command, DepthImageOptions& options) {
  auto* depth =
      command.add_option("--depth", options.depth,
                         "depth image to process instead of an input (PNG with 16 bits, or NPY); the result is in its "
                         "optical frame (z forward, x right, y down)");
  command.add_option("--intrinsics", options.intrinsics, "fx,fy,cx,cy of the depth image (pixels)")
      ->delimiter(',')
      ->expected(4)
      ->needs(depth);
  command
      .add_option("--distortion", options.distortion,
                  "distortion k1,k2,p1,p2,k3 of the lens (or 4 of them, or 8 with k4,k5,k6), to be removed "
                  "(default: none)")
      ->delimiter(',')
      ->expected(4, 8)
      ->option_text("FLOAT x 4, 5 or 8")
      ->needs(depth);
  command
      .add_option("--depth-scale", options.depth_scale,
                  "metres per unit of the depth image (0.001 for whole numbers, 1 for floats)")
      ->check(above_zero())
      ->needs(depth);
  command.add_option("--color", options.color, "color image (PNG) registered to the depth image")->needs(depth);
  command
      .add_option("--masks", options.masks,
                  "label image (PNG): the instance of each pixel, 0 = none; classes and scores come from a file of the "
                  "same name with .json or .csv")
      ->needs(depth);
  command
      .add_option("--boxes", options.boxes,
                  "boxes of a detector (JSON or CSV): instance, class, score, u, v, width, height")
      ->needs(depth);
}

Processed process_depth_image(const DepthImageOptions& options, const Parameters& parameters, int threads) {
  sensor::DepthFrame frame = frame_of(options);
  const auto doubt = sensor::doubt_of(frame.intrinsics), masks = sensor::doubt_of_masks(frame);
  const double median_depth = sensor::median_depth(frame).value_or(0.0);
  const Cloud all = points_of(frame);
  CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d::Zero();
  origin.trust_viewpoint = true;
  if (frame.detected || !frame.color.empty()) origin.detected.push_back({std::move(frame), Pose::Identity()});
  const Cloud cloud = parameters.fuse_surfaces ? thinned(all, parameters) : all;
  Processed out;
  out.workcell.name = name_of(options.depth);
  out.workcell.scan_volume = bounding_box(cloud.points);
  try {
    out.result = process(cloud, parameters, origin, {}, threads_of(threads));
  } catch (const InputError& e) {
    throw FileError(options.depth + ": " + e.what());
  }
  for (const auto& text : {doubt, masks, doubt_of_scale(out.result, median_depth, options.depth_scale > 0.0)})
    if (text) out.result.warnings.push_back(*text);
  return out;
}

}  // namespace agrisee::cli
