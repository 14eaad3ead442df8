// SPDX-License-Identifier: BSD-3-Clause
// ICP; motions, shuffles and threads are tested in tests/cloud/icp_test.cpp. Scaling by a power of two with the
// lengths: to the bit. Copies of the target: to the bit, since of equal points the first is taken. Copies of the
// source: all sums are multiplied, the motion is the same to rounding. Single precision: to the rounding of the
// coordinates.
#include <agrisee/cloud/icp.hpp>

#include "properties/laws.hpp"

using namespace agrisee;

namespace {

template <typename S>
PointCloud<S> spheres(std::size_t n, std::uint64_t seed, const Pose& motion) {
  Rng rng(seed);
  PointCloud<S> out;
  while (out.size() < n) {
    const double k = double(rng.below(4));
    const Eigen::Vector3d d = rng.direction(), center(0.03 * std::cos(2 * k), 0.5 + 0.03 * std::sin(2 * k), -0.04 * k);
    const Eigen::Vector3d p = center + (0.03 + 2e-4 * rng.normal()) * d;
    out.points.push_back((motion * p).cast<float>().cast<S>());
    out.normals.push_back((motion.linear() * d).cast<float>().cast<S>());
  }
  return out;
}

const Pose kMotion = pose_from_xyz_rpy({0.001, -0.0015, 0.0005}, {0.002, 0.001, -0.002});

template <typename S>
IcpResult align(const PointCloud<S>& source, const PointCloud<S>& target, const IcpParameters& parameters) {
  return register_cloud(source, source.normals, target, target.normals, parameters);
}

template <typename S>
PointCloud<S> copies(const PointCloud<S>& cloud, std::size_t m) {
  PointCloud<S> out;
  out.points = laws::repeated(cloud.points, m);
  out.normals = laws::repeated(cloud.normals, m);
  return out;
}

}  // namespace

TEST_CASE("ICP: scales, copies and precision") {
  const auto kernel = GENERATE(RobustKernel::none, RobustKernel::huber, RobustKernel::tukey);
  const bool point_to_point = GENERATE(false, true);
  INFO(to_string(kernel) << ", point to point " << point_to_point);
  IcpParameters parameters;
  parameters.kernel = kernel;
  parameters.point_to_point = point_to_point;
  const auto target = spheres<double>(4000, 1, Pose::Identity()), source = spheres<double>(700, 2, kMotion);
  const IcpResult straight = align(source, target, parameters);
  REQUIRE(straight.accepted);

  for (const double by : {0x1p-7, 4.0, 0x1p9}) {
    PointCloud<double> a = source, b = target;
    a.points = laws::scaled(a.points, by);
    b.points = laws::scaled(b.points, by);
    IcpParameters scaled = parameters;
    for (double* length : {&scaled.max_distance, &scaled.translation_tolerance, &scaled.max_translation}) *length *= by;
    const IcpResult got = align(a, b, scaled);
    CHECK(got.accepted);
    CHECK(got.target_T_source.linear() == straight.target_T_source.linear());
    CHECK(got.target_T_source.translation() == by * straight.target_T_source.translation());
    CHECK(got.rms_after == by * straight.rms_after);
    CHECK(got.matches == straight.matches);
    CHECK(got.iterations == straight.iterations);
  }

  const IcpResult twin_target = align(source, copies(target, 2), parameters);
  CHECK(twin_target.target_T_source.matrix() == straight.target_T_source.matrix());
  CHECK(twin_target.rms_after == straight.rms_after);
  const IcpResult twin_source = align(copies(source, 2), target, parameters);
  CHECK(twin_source.accepted);
  CHECK((twin_source.target_T_source.matrix() - straight.target_T_source.matrix()).norm() < 1e-9);
  CHECK(twin_source.matches == 2 * straight.matches);

  const IcpResult single =
      align(spheres<float>(700, 2, kMotion), spheres<float>(4000, 1, Pose::Identity()), parameters);
  CHECK(single.accepted);
  CHECK((single.target_T_source.matrix() - straight.target_T_source.matrix()).norm() < 2e-6);
}

TEST_CASE("ICP of hostile clouds ends, and moves nothing that it cannot judge") {
  const auto target = spheres<float>(2000, 1, Pose::Identity());
  for (const auto& kind : laws::hostile_kinds()) {
    INFO(kind);
    PointCloud<float> hostile;
    hostile.points = laws::hostile_cloud<float>(kind);
    Rng rng(3);
    for (std::size_t i = 0; i < hostile.size(); ++i) hostile.normals.push_back(rng.direction().cast<float>());
    for (const IcpResult& r : {align(hostile, target, {}), align(target, hostile, {}), align(hostile, hostile, {})}) {
      CHECK(is_rigid(r.target_T_source));
      CHECK(std::isfinite(r.rms_after));
      if (!r.accepted) CHECK(r.target_T_source.matrix() == Pose::Identity().matrix());
    }
  }
}
