// SPDX-License-Identifier: BSD-3-Clause
// ICP point to plane, 20 iterations, search included, against Open3D.
#include <agrisee/cloud/icp.hpp>

#ifdef PEERS_OPEN3D
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/Registration.h>
#endif

#include "conversions.hpp"

using namespace agrisee;

namespace {

constexpr double kReach = 0.02;  // m, matches are nearer

/// Another sample of the truss, moved by 2 mm and half a degree.
const Cloud& source(std::size_t n) {
  static std::map<std::size_t, Cloud> clouds;
  Cloud& c = clouds[n];
  if (!c.points.empty()) return c;
  const Eigen::Vector3d middle(0.0, 0.545, 0.5);
  Pose moved = Pose::Identity();
  moved.translate(middle).rotate(Eigen::AngleAxisd(deg(0.5), Eigen::Vector3d::UnitX()));
  moved.translate(Eigen::Vector3d(0.0015, 0.0, 0.0015) - middle);
  c = bench::noisy_truss(n, 2);
  for (auto& p : c.points) p = (moved * p.cast<double>()).cast<float>();
  return c;
}

IcpParameters plain() {
  IcpParameters p;
  p.max_distance = kReach;
  p.max_normal_angle = kPi;
  p.kernel = RobustKernel::none;
  p.max_iterations = 20;
  p.translation_tolerance = p.rotation_tolerance = 0.0;
  p.degeneracy = 0.0;
  p.max_translation = p.max_rotation = 1.0;
  return p;
}

}  // namespace

int main(int argc, char** argv) {
  peers::for_sizes([](std::size_t n, int threads) {
    if (n > 150000) return;
    const auto ours = [=](int t) {
      const Cloud& target = peers::cloud(n);
      return register_cloud(source(n), {}, target, target.normals, plain(), Pose::Identity(), t).target_T_source;
    };
    peers::add("icp", "ours", n, threads, ours, peers::Unchecked());
#ifdef PEERS_OPEN3D
    namespace registration = open3d::pipelines::registration;
    peers::add(
        "icp", "Open3D", n, threads,
        [=](int) {
          static std::map<std::size_t, std::pair<open3d::geometry::PointCloud, open3d::geometry::PointCloud>> all;
          auto& [from, to] = all[n];
          if (from.points_.empty()) {
            from = peers::open3d_cloud(source(n));
            to = peers::open3d_cloud(peers::cloud(n));
            for (const auto& normal : peers::cloud(n).normals) to.normals_.push_back(normal.cast<double>());
          }
          const auto result = registration::RegistrationICP(from, to, kReach, Eigen::Matrix4d::Identity(),
                                                            registration::TransformationEstimationPointToPlane(),
                                                            registration::ICPConvergenceCriteria(0.0, 0.0, 20));
          return Eigen::Matrix4d(result.transformation_);
        },
        [=](const Eigen::Matrix4d& theirs) {
          const double gap = (theirs - ours(1).matrix()).cwiseAbs().maxCoeff();
          peers::require(gap < 1e-4, "pose of Open3D's ICP by " + std::to_string(gap));
        });
#endif
  });
  return peers::main(argc, argv);
}
