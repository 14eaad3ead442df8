// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/cloud/icp.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include "cloud/cloud_cases.hpp"
#include "support/says.hpp"

using namespace agrisee;

namespace {

/// Points and normals of a truss of spheres, seen from -y when `front`.
template <typename S>
PointCloud<S> truss(std::size_t n, std::uint64_t seed, int spheres, double noise, bool front = false) {
  Rng rng(seed);
  PointCloud<S> out;
  while (out.size() < n) {
    const auto k = static_cast<double>(rng.below(static_cast<std::uint64_t>(spheres)));
    const Eigen::Vector3d center(0.03 * std::cos(2 * k), 0.5 + 0.03 * std::sin(2 * k), 0.6 - 0.035 * k);
    const Eigen::Vector3d normal = rng.direction();
    const Eigen::Vector3d p = center + (0.03 + noise * rng.normal()) * normal;
    if (front && normal.y() > -0.2) continue;
    out.points.push_back(p.cast<S>());
    out.normals.push_back(normal.cast<S>());
  }
  return out;
}

template <typename S>
PointCloud<S> moved(const Pose& motion, PointCloud<S> cloud) {
  for (auto& p : cloud.points) p = (motion * p.template cast<double>()).template cast<S>();
  for (auto& n : cloud.normals) n = (motion.linear() * n.template cast<double>()).template cast<S>();
  return cloud;
}

/// A motion about the truss's middle.
Pose about_middle(const Eigen::Vector3d& shift, const Eigen::Vector3d& rpy) {
  const Eigen::Vector3d middle(0.0, 0.5, 0.53);
  return Eigen::Translation3d(middle) * pose_from_xyz_rpy(shift, rpy) * Eigen::Translation3d(-middle);
}

/// How far (m) the truss still is from its place.
double error(const IcpResult& result, const Pose& motion) {
  double worst = 0.0;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(0, 0.5, 0.6), Eigen::Vector3d(0, 0.5, 0.45), Eigen::Vector3d(0.05, 0.45, 0.5)})
    worst = std::max(worst, (result.target_T_source * motion * p - p).norm());
  return worst;
}

const Pose kSmall = about_middle({0.002, -0.001, 0.0015}, {0.008, -0.005, 0.006});

template <typename S>
IcpResult align(const PointCloud<S>& source, const PointCloud<S>& target, const IcpParameters& parameters = {}) {
  return register_cloud(source, source.normals, target, target.normals, parameters);
}

}  // namespace

TEST_CASE("ICP finds a small motion, whatever the kernel and the distance") {
  const auto target = truss<float>(8000, 1, 6, 0.0);
  const auto source = moved(kSmall, truss<float>(1500, 2, 6, 0.0, true));
  for (const RobustKernel kernel : {RobustKernel::none, RobustKernel::huber, RobustKernel::tukey}) {
    IcpParameters parameters;
    parameters.kernel = kernel;
    const IcpResult result = align(source, target, parameters);
    INFO(to_string(kernel));
    CHECK(result.accepted);
    CHECK(error(result, kSmall) < 2e-4);
    CHECK(result.rms_after < 0.5 * result.rms_before);
    CHECK(result.constrained == 6);
    CHECK(result.matches > 1300);
    parameters.point_to_point = true;
    parameters.max_iterations = 100;
    const IcpResult points = align(source, target, parameters);
    CHECK(points.accepted);
    CHECK(error(points, kSmall) < 6e-4);  // points slide over points less easily
  }
}

TEMPLATE_TEST_CASE("ICP takes the normals that clouds hold", "", float, double) {
  const auto target = truss<TestType>(3000, 1, 6, 0.0);
  const auto source = moved(kSmall, truss<TestType>(800, 2, 6, 0.0, true));
  const IcpResult expected = align(source, target), result = register_cloud(source, target);
  CHECK(result.accepted);
  CHECK(result.target_T_source.matrix() == expected.target_T_source.matrix());
  CHECK(result.matches == expected.matches);
  IcpParameters parameters;
  parameters.max_iterations = 3;
  CHECK(register_cloud(source, target, parameters, kSmall.inverse(), 2).iterations <= 3);

  PointCloud<TestType> bare;
  bare.points = source.points;
  CHECK_THROWS_WITH(register_cloud(bare, target), test::says("the normals of the source"));
  CHECK_THROWS_WITH(register_cloud(source, bare), test::says("the normals of the target"));
  parameters.point_to_point = true;
  CHECK(register_cloud(bare, bare, parameters).matches == bare.size());
  bare.normals.resize(3);
  CHECK_THROWS_AS(register_cloud(bare, target), InputError);
  CHECK_THROWS_AS(register_cloud(source, bare), InputError);
  CHECK_FALSE(register_cloud(PointCloud<TestType>(), target).accepted);
  CHECK_FALSE(register_cloud(source, PointCloud<TestType>()).accepted);
}

TEST_CASE("ICP of a cloud with its own copy is exact") {
  const auto target = truss<double>(3000, 1, 6, 3e-4);
  for (const bool point_to_point : {false, true}) {
    IcpParameters parameters;
    parameters.point_to_point = point_to_point;
    parameters.max_iterations = 200;
    parameters.kernel = RobustKernel::none;
    const IcpResult result = align(moved(kSmall, target), target, parameters);
    CHECK(result.accepted);
    CHECK(error(result, kSmall) < 1e-5);
    CHECK(result.rms_after < 1e-5);
    const IcpResult still = align(target, target, parameters);  // nothing to gain
    CHECK_FALSE(still.accepted);
    CHECK(still.target_T_source.matrix() == Pose::Identity().matrix());
    CHECK(still.matches == target.size());
    CHECK(still.rms_before == 0.0);
  }
}

TEST_CASE("ICP with noise and strays: robust weights do better") {
  const auto target = truss<float>(8000, 1, 6, 5e-4);
  auto source = moved(kSmall, truss<float>(1500, 2, 6, 5e-4, true));
  for (std::size_t i = 0; i < source.size(); i += 8) source.points[i] += 0.004f * source.normals[i];
  IcpParameters parameters;
  const double robust = error(align(source, target, parameters), kSmall);
  parameters.kernel = RobustKernel::none;
  const double plain = error(align(source, target, parameters), kSmall);
  INFO(robust << " " << plain);
  CHECK(robust < 3e-4);
  CHECK(robust < 0.5 * plain);
}

TEMPLATE_TEST_CASE("matches that are kept are those that a search of all points finds", "", float, double) {
  using S = TestType;
  const auto target = truss<S>(3000, 1, 6, 5e-4);
  const auto source = truss<S>(400, 2, 6, 5e-4, true);
  const double angle = GENERATE(30.0, 180.0);  // degrees; 180: normals are not tested
  IcpParameters parameters;
  parameters.max_normal_angle = deg(angle);
  const Grid<S> search(target, S(0.003));
  detail::IcpProblem<S, PointCloud<S>, PointCloud<S>, Grid<S>> problem(source, source.normals, target, target.normals,
                                                                       parameters, search, 1);
  Pose pose = kSmall;
  double step = 1.0;
  std::size_t changed = 0;
  std::vector<Index> last;
  for (int k = 0; k < 14; ++k, step *= 0.6) {  // steps that get shorter, with a jump back
    if (k == 9) step = 0.5;
    pose = about_middle({3e-4 * step, -4e-4 * step, 2e-4 * step}, {-1e-3 * step, 2e-3 * step, 1e-3 * step}) * pose;
    problem.match(pose);
    for (std::size_t i = 0; i < problem.points().size(); ++i) {
      const Vector3<S> q = (pose * problem.points()[i]).template cast<S>();
      Index best = -1;
      S best_sq = S(parameters.max_distance) * S(parameters.max_distance);
      for (std::size_t j = 0; j < target.size(); ++j) {
        const bool agrees = problem.normals().empty() ||
                            target.normals[j].template cast<double>().dot(pose.linear() * problem.normals()[i]) >=
                                std::cos(parameters.max_normal_angle);
        const S d_sq = distance_sq<S>(target.points[j], q);
        if (agrees && d_sq <= best_sq && (d_sq < best_sq || best < 0)) best = static_cast<Index>(j), best_sq = d_sq;
      }
      if (problem.matches()[i] != best) FAIL("step " << k << ", point " << i);
    }
    for (std::size_t i = 0; i < last.size(); ++i) changed += last[i] != problem.matches()[i];
    last = problem.matches();
  }
  CHECK(changed > 100);
}

TEST_CASE("ICP obeys the laws: shuffles, motions, threads, searches") {
  const auto target = truss<double>(4000, 1, 6, 3e-4);
  const auto source = moved(kSmall, truss<double>(900, 2, 6, 3e-4, true));
  const IcpResult straight = align(source, target);
  REQUIRE(straight.accepted);
  const auto run = [&](const auto& search, int threads) {
    return register_cloud(source, source.normals, target, target.normals, {}, search, Pose::Identity(), threads);
  };
  for (const int threads : {1, 2, 5})
    CHECK(run(Grid<double>(target, 0.0025), threads).target_T_source.matrix() == straight.target_T_source.matrix());
  CHECK(run(KdTree<double>(target), 2).target_T_source.matrix() == straight.target_T_source.matrix());
  CHECK(run(Grid<double>(target, 0.1), 1).target_T_source.matrix() == straight.target_T_source.matrix());
  const IcpResult shuffled =
      align(select(source, cases::shuffled(source.size())), select(target, cases::shuffled(target.size())));
  CHECK(shuffled.target_T_source.isApprox(straight.target_T_source, 1e-9));
  const Pose motion = cases::some_motion();
  const IcpResult elsewhere = align(moved(motion, source), moved(motion, target));
  CHECK((motion.inverse() * elsewhere.target_T_source * motion).isApprox(straight.target_T_source, 1e-7));
  // The initial pose takes the motion's place.
  const IcpResult initial = register_cloud(source, source.normals, moved(motion, target), moved(motion, target).normals,
                                           {}, Grid<double>(moved(motion, target), 0.0025), motion);
  CHECK(initial.accepted);
  CHECK((motion.inverse() * initial.target_T_source).isApprox(straight.target_T_source, 1e-7));
  CHECK(initial.translation == Approx(straight.translation).epsilon(1e-4));
}

TEST_CASE("ICP does not drift where the surface says nothing") {
  const Pose lifted = about_middle({0, 0, 0.002}, {0, 0, 0});
  PointCloud<double> plane, patch;
  for (int i = 0; i < 3600; ++i) {
    plane.points.push_back({0.002 * (i % 60), 0.5 + 0.002 * (i / 60), 0.5});
    plane.normals.push_back(Eigen::Vector3d::UnitZ());
    if (i % 60 > 20 && i % 60 < 40 && i / 60 > 20 && i / 60 < 40) {
      patch.points.push_back(plane.points.back() + Eigen::Vector3d(7e-4, 3e-4, 0.002));
      patch.normals.push_back(Eigen::Vector3d::UnitZ());
    }
  }
  const IcpResult flat = align(patch, plane);
  CHECK(flat.accepted);
  CHECK(flat.constrained == 3);
  CHECK((flat.target_T_source.translation() - Eigen::Vector3d(0, 0, -0.002)).norm() < 1e-9);
  CHECK(flat.rotation < 1e-9);

  const auto ball = truss<double>(4000, 1, 1, 0.0);
  const IcpResult round = align(moved(lifted, truss<double>(800, 2, 1, 0.0)), ball);
  CHECK(round.accepted);
  CHECK(round.constrained == 3);
  CHECK(round.rotation < deg(0.3));  // matches lie a little aside, so turn and shift mix a little
  CHECK((round.target_T_source * lifted * Eigen::Vector3d(0.03, 0.5, 0.6) - Eigen::Vector3d(0.03, 0.5, 0.6)).norm() <
        2e-4);
}

TEST_CASE("ICP drops what it cannot believe") {
  const auto target = truss<double>(6000, 1, 6, 0.0);
  const auto whole = truss<double>(1500, 2, 6, 0.0);
  IcpParameters parameters;
  parameters.max_translation = 0.001;
  const Pose shift = about_middle({0, -0.002, 0}, {0, 0, 0});
  CHECK_FALSE(align(moved(shift, whole), target, parameters).accepted);
  parameters.max_translation = 0.003;
  CHECK(align(moved(shift, whole), target, parameters).accepted);
  const Pose turn = about_middle({0, 0, 0}, {0, 0.03, 0});
  const IcpResult turned = align(moved(turn, whole), target);
  CHECK_FALSE(turned.accepted);
  CHECK(turned.rotation > deg(1.0));
  CHECK(turned.target_T_source.matrix() == Pose::Identity().matrix());
  parameters.max_rotation = deg(3.0);
  CHECK(align(moved(turn, whole), target, parameters).accepted);
  // Too far away, or turned inside out: no matches.
  const Pose away = about_middle({0.5, 0, 0}, {0, 0, 0});
  CHECK(align(moved(away, whole), target).matches == 0);
  auto inside_out = truss<double>(1500, 2, 1, 0.0);
  for (auto& n : inside_out.normals) n = -n;
  const IcpResult none = align(inside_out, truss<double>(3000, 1, 1, 0.0));
  CHECK(none.matches == 0);
  CHECK_FALSE(none.accepted);
  CHECK(none.iterations == 0);
}

TEST_CASE("ICP finds more matches at the end than at the start") {
  const auto target = truss<double>(2000, 1, 6, 0.0);
  IcpParameters parameters;
  parameters.max_distance = 0.0008;
  const IcpResult result = align(moved(about_middle({0, 0, 0}, {0, 0.012, 0}), target), target, parameters);
  CHECK(result.accepted);
  CHECK(result.matches_before < 1800);
  CHECK(result.matches == 2000);
}

TEST_CASE("ICP needs as many matches as it is told, no more") {
  const auto target = truss<double>(2000, 1, 6, 0.0);
  const auto source = moved(about_middle({0, -0.0005, 0}, {0, 0, 0}), target);
  IcpParameters parameters;
  parameters.min_matches = 2000;  // all
  const IcpResult all = align(source, target, parameters);
  CHECK(all.matches == 2000);
  CHECK(all.accepted);
  parameters.min_matches = 2001;
  CHECK_FALSE(align(source, target, parameters).accepted);
}

TEST_CASE("errors that neighbors share move no pose that was right") {
  // A view whose depths are off by half a millimetre here and there, and a target without errors.
  const auto target = truss<double>(8000, 1, 6, 0.0);
  auto view = truss<double>(1500, 2, 6, 0.0);
  for (auto& p : view.points) p.y() += 0.0006 * std::sin(40.0 * p.z() + 1.0);
  const IcpResult any = align(view, target);
  CHECK(any.accepted);
  CHECK(any.target_T_source.matrix() != Pose::Identity().matrix());
  const IcpResult sure = align(view, target, IcpParameters::of_views());
  CHECK(sure.rms_after < sure.rms_before);
  CHECK_FALSE(sure.accepted);
  CHECK(sure.target_T_source.matrix() == Pose::Identity().matrix());
  // A pose that is off by more than that is still put right.
  const Pose off = about_middle({0.0, 0.003, 0.0}, {0, 0, 0});
  CHECK(align(moved(off, view), target, IcpParameters::of_views()).accepted);
}

TEST_CASE("a material that the sensor sees too deep moves no pose that was right") {
  // Leaves in front of and behind the truss, three times its points; the view sees them 3 mm too deep.
  const auto scene = [](std::size_t points, std::uint64_t seed, double deep) {  // deep in m
    auto cloud = truss<double>(points, seed, 6, 0.0);
    Rng rng(seed + 10);
    for (std::size_t i = 0; i < 3 * points; ++i) {
      const double x = 0.2 * rng.uniform() - 0.1, z = 0.4 + 0.25 * rng.uniform(), slope = 0.4 * std::cos(30.0 * x + z);
      cloud.points.emplace_back(x, (i % 2 ? 0.43 : 0.57) + deep + slope / 30.0 * std::sin(30.0 * z), z);
      cloud.normals.push_back(
          Eigen::Vector3d(-0.4 * std::sin(30.0 * x + z) * std::sin(30.0 * z), -1.0, slope * std::cos(30.0 * z))
              .normalized());
    }
    return cloud;
  };
  const auto target = scene(3000, 1, 0.0);
  const auto view = scene(600, 2, 0.003);
  IcpParameters anyhow = IcpParameters::of_views();
  anyhow.max_worse = 1.0;
  const IcpResult pulled = align(view, target, anyhow);
  CHECK(pulled.accepted);
  CHECK(error(pulled, Pose::Identity()) > 0.002);
  CHECK(pulled.worse > 0.15);
  const IcpResult kept = align(view, target, IcpParameters::of_views());
  CHECK_FALSE(kept.accepted);
  CHECK(kept.worse == pulled.worse);
  // Where all surfaces say the same, the pose is put right.
  const IcpResult put_right = align(moved(kSmall, scene(600, 2, 0.0)), target, IcpParameters::of_views());
  CHECK(put_right.accepted);
  CHECK(put_right.worse < 0.05);
  CHECK(error(put_right, kSmall) < 0.0005);
}

TEST_CASE("ICP of next to nothing, degenerate clouds and bad input") {
  const auto target = truss<float>(500, 1, 2, 0.0);
  const Cloud none;
  CHECK_FALSE(align(none, target).accepted);
  CHECK_FALSE(align(target, none).accepted);
  CHECK_FALSE(align(none, none).accepted);
  const float nan = std::nanf("");
  for (const std::string kind : {"one", "two", "equal", "line", "nan", "duplicated"}) {
    INFO(kind);
    Cloud cloud;
    cloud.points = cases::cloud_of<float>(kind, 300);
    cloud.normals.assign(cloud.size(), Eigen::Vector3f::UnitX());
    Cloud shifted = cloud;
    for (auto& p : shifted.points) p.x() += 0.001f;
    for (const bool point_to_point : {false, true}) {
      IcpParameters parameters;
      parameters.point_to_point = point_to_point;
      const IcpResult result = align(shifted, cloud, parameters);
      CHECK(result.target_T_source.matrix().allFinite());
      CHECK(is_rigid(result.target_T_source));
      CHECK(std::isfinite(result.rms_after));
      if (kind == "equal") CHECK((result.target_T_source.translation() + Eigen::Vector3d(0.001, 0, 0)).norm() < 1e-6);
    }
  }
  Cloud bad = target;
  bad.normals.assign(bad.size(), Eigen::Vector3f::Zero());
  CHECK(align(target, bad).matches == 0);  // no normals, no planes
  CHECK(align(bad, target).matches == 0);
  bad.points.assign(bad.size(), {nan, nan, nan});
  CHECK(align(bad, target).matches == 0);
  bad.normals.pop_back();
  CHECK_THROWS_AS(align(bad, target), InputError);
  CHECK_THROWS_AS(align(target, bad), InputError);
  IcpParameters points;
  points.point_to_point = true;
  const Cloud bare{target.points, {}, {}};
  CHECK(align(bare, bare, points).matches == bare.size());
  CHECK(align(target, bare, points).matches == bare.size());
  CHECK_THROWS_AS(align(bare, bare), InputError);
  Pose skewed = Pose::Identity();
  skewed.linear() *= 2.0;
  CHECK_THROWS_AS(register_cloud(target, target.normals, target, target.normals, {}, Grid(target, 0.01f), skewed),
                  InputError);
  CHECK_THROWS_AS(register_cloud(target, target.normals, target, target.normals, {}, Grid(none, 0.01f)), InputError);
  const auto refuses = [&](auto change, const char* name) {
    IcpParameters p;
    change(p);
    CHECK(cases::rejects(name, [&] { align(target, target, p); }));
    const Grid<float> search(target, 0.01f);
    CHECK(cases::rejects(name, [&] { register_cloud(target, target.normals, target, target.normals, p, search); }));
  };
  refuses([](auto& p) { p.max_distance = 0; }, "max_distance");
  refuses([](auto& p) { p.max_normal_angle = -1; }, "max_normal_angle");
  refuses([](auto& p) { p.max_iterations = 0; }, "max_iterations");
  refuses([](auto& p) { p.translation_tolerance = -1; }, "translation_tolerance");
  refuses([](auto& p) { p.rotation_tolerance = std::nan(""); }, "rotation_tolerance");
  refuses([](auto& p) { p.degeneracy = 1; }, "degeneracy");
  refuses([](auto& p) { p.min_matches = 2; }, "min_matches");
  refuses([](auto& p) { p.max_translation = 0; }, "max_translation");
  refuses([](auto& p) { p.max_rotation = -1; }, "max_rotation");
  refuses([](auto& p) { p.max_rotation = 5; }, "max_rotation");    // degrees
  refuses([](auto& p) { p.pose_rotation = 5; }, "pose_rotation");  // degrees
  CHECK(robust_kernel("huber") == RobustKernel::huber);
  CHECK_THROWS_AS(robust_kernel("cauchy"), ParameterError);
}

TEST_CASE("robust weights are the derivatives of the costs") {
  for (const RobustKernel kernel : {RobustKernel::none, RobustKernel::huber, RobustKernel::tukey})
    for (const double r : {-3.0, -0.4, 0.1, 1.0, 2.0, 9.0}) {
      const double h = 1e-6;
      const double slope = (robust_cost(kernel, r + h, 0.7) - robust_cost(kernel, r - h, 0.7)) / (2 * h);
      CHECK(robust_weight(kernel, r, 0.7) * r == Approx(slope).margin(1e-6));
    }
  CHECK(robust_scale({0, 0, -1, 0}, {1.0, -2.0, 50.0, 3.0}, 0.1) == Approx(1.4826 * 2.0));
  CHECK(robust_scale({-1}, {1.0}, 0.1) == 0.1);
}

TEST_CASE("the size of a rank is that of a sort") {
  Rng rng(5);
  for (const std::size_t n : {1u, 2u, 7u, 1000u}) {
    std::vector<double> sizes;
    for (std::size_t i = 0; i < n; ++i)
      sizes.push_back(i % 5 == 0   ? 0.25
                      : i % 7 == 0 ? 0.0
                      : i % 9 == 0 ? std::numeric_limits<double>::infinity()
                                   : std::pow(10.0, rng.uniform(-320.0, 300.0)));
    std::vector<double> sorted = sizes;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t rank = 0; rank < n; rank += n < 10 ? 1 : 37) {
      std::vector<double> some = sizes;
      CHECK(detail::nth_size(some, rank) == sorted[rank]);
    }
  }
}

TEMPLATE_TEST_CASE("of equally near target points the one with the smaller index is the match", "", float, double) {
  using S = TestType;
  IcpParameters parameters;
  parameters.max_distance = 0.5;
  const auto match = [&](const std::vector<Vector3<S>>& points, const auto& search) {
    PointCloud<S> target, source;
    target.points = points;
    target.normals.assign(points.size(), Vector3<S>::UnitZ());
    source.points = {{0, 0, 0}};
    using Search = std::decay_t<decltype(search)>;
    detail::IcpProblem<S, PointCloud<S>, PointCloud<S>, Search> problem(source, {}, target, target.normals, parameters,
                                                                        search, 1);
    problem.match(Pose::Identity());
    const Index first = problem.matches()[0];
    problem.match(Pose(Eigen::Translation3d(0, 0, 0.01)));
    problem.match(Pose::Identity());  // also when it is looked up again
    CHECK(problem.matches()[0] == first);
    return first;
  };
  const std::vector<Vector3<S>> four{{S(0.25), 0, 0}, {0, S(-0.25), 0}, {S(-0.25), 0, 0}, {0, S(0.25), 0}};
  for (std::size_t turn = 0; turn < 4; ++turn) {
    std::vector<Vector3<S>> points = four;
    std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(turn), points.end());
    for (const bool mirrored : {false, true}) {
      if (mirrored) std::reverse(points.begin(), points.end());
      CHECK(match(points, KdTree<S>(points)) == 0);
      CHECK(match(points, Grid<S>(points, S(0.1))) == 0);
      CHECK(match(points, Grid<S>(points, S(1.0))) == 0);
    }
  }
  const std::vector<Vector3<S>> equal(5, Vector3<S>(S(0.25), 0, 0));
  CHECK(match(equal, KdTree<S>(equal)) == 0);
  CHECK(match(equal, Grid<S>(equal, S(0.1))) == 0);
}

TEST_CASE("residuals before and after, by hand; without matches they are zero") {
  PointCloud<double> plane, patch;
  for (int i = 0; i < 400; ++i) {
    plane.points.emplace_back(0.002 * (i % 20), 0.002 * (i / 20), 0.5);
    plane.normals.push_back(Eigen::Vector3d::UnitZ());
  }
  patch = plane;
  for (std::size_t i = 0; i < patch.size(); ++i) patch.points[i].z() += i % 20 % 4 < 2 ? 0.0005 : 0.0015;
  IcpParameters parameters;
  parameters.kernel = RobustKernel::none;
  const IcpResult result = align(patch, plane, parameters);
  CHECK(result.accepted);
  CHECK(result.matches_before == 400);
  CHECK(result.matches == 400);
  CHECK(result.rms_before == Approx(std::sqrt((0.25 + 2.25) / 2.0) * 1e-3));
  CHECK(result.rms_after == Approx(0.5e-3).epsilon(0.02));
  CHECK(result.translation == Approx(0.001).epsilon(0.01));
  for (auto& p : patch.points) p.z() += 1.0;
  for (const RobustKernel kernel : {RobustKernel::none, RobustKernel::tukey}) {
    parameters.kernel = kernel;
    const IcpResult away = align(patch, plane, parameters);
    CHECK(away.matches == 0);
    CHECK(away.rms_before == 0.0);
    CHECK(away.rms_after == 0.0);
    CHECK(away.translation == 0.0);
    CHECK(away.rotation == 0.0);
    CHECK_FALSE(away.accepted);
  }
}
