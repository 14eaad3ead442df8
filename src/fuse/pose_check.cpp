// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/median.hpp>
#include <agrisee/fuse/pose_check.hpp>
#include <agrisee/neighbors/hash_grid.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace agrisee::fuse {
namespace {

/// A change of a pose that mends a common mistake.
struct Mistake {
  const char* words;
  std::function<Pose(const Pose&)> mend;
};

/// A pose of a frame with other axes than the optical one. @param axes columns: x, y and z of the optical frame in it
Pose turned(const Pose& pose, const Eigen::Matrix3d& axes) {
  Pose out = pose;
  out.linear() = pose.linear() * axes;
  return out;
}

/// A pose whose quaternion was stated as w x y z and read as x y z w.
Pose with_w_first(const Pose& pose) {
  const Eigen::Quaterniond read(pose.linear());
  Pose out = pose;
  out.linear() = Eigen::Quaterniond(read.x(), read.y(), read.z(), read.w()).toRotationMatrix();
  return out;
}

const std::vector<Mistake>& mistakes() {
  static const Eigen::Matrix3d body = (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();
  static const Eigen::Matrix3d graphics = Eigen::Vector3d(1, -1, -1).asDiagonal();
  static const std::vector<Mistake> all{
      {"are inverted (optical_T_world)", [](const Pose& pose) { return pose.inverse(Eigen::Isometry); }},
      {"are those of a frame with x forward and z up", [](const Pose& pose) { return turned(pose, body); }},
      {"are those of a frame with z backward and y up", [](const Pose& pose) { return turned(pose, graphics); }},
      {"have quaternions in the order w x y z", with_w_first}};
  return all;
}

std::vector<ViewSample> with_poses(std::vector<ViewSample> views, const std::function<Pose(const Pose&)>& mend) {
  for (ViewSample& view : views) view.world_T_optical = mend(view.world_T_optical);
  return views;
}

/// Share of all points that are in a volume.
double share_inside(const std::vector<ViewSample>& views, const Aabb& volume) {
  std::size_t all = 0, inside = 0;
  for (const ViewSample& view : views) {
    all += view.points.size();
    for (const auto& p : view.points) inside += volume.contains(view.world_T_optical * p.cast<double>());
  }
  return all > 0 ? static_cast<double>(inside) / static_cast<double>(all) : 0.0;
}

/// Edge length of cells (m) in which the samples of one surface touch: 2 % of the median depth, at least 1 cm.
double cell_for(const std::vector<ViewSample>& views) {
  std::vector<float> depths;
  for (const ViewSample& view : views)
    for (const auto& p : view.points) depths.push_back(p.z());
  return std::max(0.01, 0.02 * double(median(depths)));
}

}  // namespace

ViewSample sample_of(const sensor::DepthFrame& frame, const Pose& world_T_optical) {
  constexpr double kSamples = 5000.0;
  const int step =
      std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(frame.intrinsics.size()) / kSamples))));
  ViewSample sample;
  sample.world_T_optical = world_T_optical;
  for (int v = step / 2; v < frame.intrinsics.height; v += step)
    for (int u = step / 2; u < frame.intrinsics.width; u += step)
      if (sensor::DepthFrame::valid(frame.at(u, v))) sample.points.push_back(frame.point(u, v));
  return sample;
}

double agreement(const std::vector<ViewSample>& views, double cell) {
  constexpr std::size_t kMost = 16;  // one bit of a cell's value each
  std::vector<const ViewSample*> with_points, used;
  for (const ViewSample& view : views)
    if (!view.points.empty()) with_points.push_back(&view);
  if (with_points.size() < 2) return 0.0;
  const std::size_t count = std::min(kMost, with_points.size());
  for (std::size_t k = 0; k < count; ++k) used.push_back(with_points[k * with_points.size() / count]);
  std::vector<std::vector<CellIndex>> cells(used.size());
  CellTable seen_by;
  for (std::size_t i = 0; i < used.size(); ++i)
    for (const auto& p : used[i]->points) {
      const Eigen::Vector3d world = used[i]->world_T_optical * p.cast<double>();
      cells[i].push_back(CellTable::cell(world, 1.0 / cell));
      const Index others = std::max<Index>(seen_by.find(cells[i].back()), 0);
      seen_by.exchange(cells[i].back(), others | Index(1) << i);
    }
  const auto seen_by_another = [&](const CellIndex& center, std::size_t view) {
    for (int n = 0; n < 27; ++n) {
      const Index by = seen_by.find(center + CellIndex(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
      if (by > 0 && (by & ~(Index(1) << view)) != 0) return true;
    }
    return false;
  };
  double sum = 0.0;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const auto agree =
        std::count_if(cells[i].begin(), cells[i].end(), [&](const CellIndex& c) { return seen_by_another(c, i); });
    sum += static_cast<double>(agree) / static_cast<double>(cells[i].size());
  }
  return sum / static_cast<double>(used.size());
}

PoseCheck check_poses(const std::vector<ViewSample>& views, const Aabb& volume) {
  constexpr double kMany = 0.4, kFactor = 2.0, kSome = 0.05;
  const double cell = cell_for(views);
  PoseCheck check;
  check.as_reported = agreement(views, cell);
  const auto shows = [](const ViewSample& view) { return !view.points.empty(); };
  const bool alone = std::count_if(views.begin(), views.end(), shows) == 1;
  const bool missed = alone && !volume.empty() && share_inside(views, volume) == 0.0;
  for (const Mistake& mistake : mistakes()) {
    const std::vector<ViewSample> mended = with_poses(views, mistake.mend);
    const double agree = agreement(mended, cell);
    const bool better = agree >= kMany && agree >= kFactor * check.as_reported;
    const bool seen = missed && share_inside(mended, volume) >= kSome;
    if ((better || seen) && (check.mistake.empty() || agree > check.mended)) check.mistake = mistake.words;
    check.mended = std::max(check.mended, agree);
  }
  return check;
}

}  // namespace agrisee::fuse
