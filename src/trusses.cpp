// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/poses.hpp>
#include <agrisee/geometry/pca.hpp>
#include <agrisee/trusses.hpp>

#include <map>
#include <utility>

namespace agrisee {
namespace {

/// The radius of a fruit (m), roughly where no body was fitted.
double radius_of(const Fruit& fruit) { return fruit.body ? fruit.body->radii.mean() : fruit.sigma.norm(); }

/// Eigenvalue of the positions' covariance along a truss over that across it, from which on the direction counts.
constexpr double kStrung = 2.0;

/// The direction along which fruit are strung (unit, upwards); zero where none stands out.
Eigen::Vector3d strung_along(const std::vector<const Fruit*>& fruits, const Eigen::Vector3d& mean) {
  if (fruits.size() < 3) return Eigen::Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Fruit* f : fruits) spread += (f->position() - mean) * (f->position() - mean).transpose();
  const auto pca = principal_axes<double>(mean, spread);
  if (!(pca.variance[2] > kStrung * pca.variance[1])) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d along = pca.axes.col(2);
  return along.z() < 0.0 ? Eigen::Vector3d(-along) : along;
}

/// The growth frame of a truss, see FoundTruss.
Pose growth_frame(const std::vector<const Fruit*>& fruits) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero(), axes = Eigen::Vector3d::Zero();
  for (const Fruit* f : fruits) {
    mean += f->position() / static_cast<double>(fruits.size());
    axes += f->orientation.col(2);
  }
  const Eigen::Vector3d along = strung_along(fruits, mean);
  Pose pose = Pose::Identity();
  pose.linear() = frame_from_z_and_x(along.isZero() ? axes : along, Eigen::Vector3d::UnitX());
  pose.translation() = mean;
  return pose;
}

}  // namespace

std::vector<int> trusses_of(const std::vector<Fruit>& fruits, double truss_gap) {
  std::vector<int> truss(fruits.size(), -1);
  int count = 0;
  for (std::size_t first = 0; first < fruits.size(); ++first) {
    if (truss[first] >= 0) continue;
    std::vector<std::size_t> front{first};
    truss[first] = count;
    while (!front.empty()) {
      const Fruit& a = fruits[front.back()];
      front.pop_back();
      for (std::size_t i = 0; i < fruits.size(); ++i) {
        if (truss[i] >= 0) continue;
        const double radii = radius_of(a) + radius_of(fruits[i]);
        if ((a.position() - fruits[i].position()).norm() > radii + truss_gap * 0.5 * radii) continue;
        truss[i] = count;
        front.push_back(i);
      }
    }
    ++count;
  }
  return truss;
}

std::vector<FoundTruss> found_trusses(const std::vector<Fruit>& fruits) {
  std::map<int, std::vector<const Fruit*>> by_truss;
  for (const Fruit& f : fruits) by_truss[f.truss].push_back(&f);
  std::vector<FoundTruss> out;
  for (const auto& [id, members] : by_truss) {
    FoundTruss truss;
    truss.id = id;
    for (const Fruit* f : members) truss.fruits.push_back(f->id);
    truss.world_T_truss = growth_frame(members);
    out.push_back(std::move(truss));
  }
  return out;
}

}  // namespace agrisee
