// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/ground_truth.hpp>

#include <array>

#include "io/formats/json_value.hpp"

namespace agrisee::io {
namespace {

Json array(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d vector(const Json& j) {
  const auto v = j.get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

}  // namespace

void write_ground_truth(const std::filesystem::path& path, const study::GroundTruth& truth) {
  Json out;
  out["format_version"] = 1;
  out["fruits"] = Json::array();
  for (const study::TrueFruit& f : truth.fruits) {
    Json fruit;
    fruit["id"] = f.id;
    fruit["center"] = array(f.center);
    fruit["radii"] = array(f.radii);
    fruit["axes"] = {array(f.axes.col(0)), array(f.axes.col(1)), array(f.axes.col(2))};
    fruit["volume"] = f.volume;
    if (f.growth_axis) fruit["growth_axis"] = array(*f.growth_axis);
    if (f.hidden) fruit["hidden"] = *f.hidden;
    if (f.visible_share) fruit["visible_share_frontal"] = *f.visible_share;
    if (f.ripeness) fruit["ripeness"] = *f.ripeness;
    out["fruits"].push_back(std::move(fruit));
  }
  write_file(path, out.dump(2) + "\n");
}

std::optional<study::GroundTruth> read_ground_truth(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  const Json root = load_json(path);
  if (!root.is_object() || !root.contains("format_version") || !root.contains("fruits")) return std::nullopt;
  try {
    if (root.at("format_version") != 1) fail(path, "unknown format_version " + root.at("format_version").dump());
    study::GroundTruth truth;
    for (const Json& j : root.at("fruits")) {
      study::TrueFruit f;
      f.id = j.at("id").get<int>();
      f.center = vector(j.at("center"));
      f.radii = vector(j.at("radii"));
      for (int a = 0; a < 3; ++a) f.axes.col(a) = vector(j.at("axes").at(static_cast<std::size_t>(a)));
      f.volume = j.at("volume").get<double>();
      if (j.contains("growth_axis")) f.growth_axis = vector(j.at("growth_axis"));
      if (j.contains("hidden")) f.hidden = j.at("hidden").get<bool>();
      if (j.contains("visible_share_frontal")) f.visible_share = j.at("visible_share_frontal").get<double>();
      if (j.contains("ripeness")) f.ripeness = j.at("ripeness").get<double>();
      truth.fruits.push_back(f);
    }
    return truth;
  } catch (const Json::exception& e) {
    fail(path, e.what());
  }
}

}  // namespace agrisee::io
