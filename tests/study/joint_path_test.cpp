// SPDX-License-Identifier: BSD-3-Clause
// The path through the views: compared with all permutations and, for many views, with its own bounds.
#include <agrisee/core/random.hpp>
#include <agrisee/study/joint_path.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

#include "catch.hpp"

using namespace agrisee;
using namespace agrisee::study;

namespace {

std::vector<Joints> random_joints(std::size_t n, std::uint64_t seed) {
  Rng rng(seed, 0x701);
  std::vector<Joints> out(n);
  for (Joints& q : out)
    for (int j = 0; j < 6; ++j) q[j] = rng.uniform(-kPi, kPi);
  return out;
}

std::vector<Joints> ordered(const std::vector<Joints>& configurations, const std::vector<std::size_t>& order) {
  std::vector<Joints> out;
  for (const std::size_t i : order) out.push_back(configurations[i]);
  return out;
}

bool is_permutation_of(std::vector<std::size_t> order, std::size_t n) {
  std::sort(order.begin(), order.end());
  if (order.size() != n) return false;
  for (std::size_t i = 0; i < n; ++i)
    if (order[i] != i) return false;
  return true;
}

double by_brute_force(const Joints& start, const std::vector<Joints>& configurations) {
  std::vector<std::size_t> order(configurations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  double least = std::numeric_limits<double>::infinity();
  do least = std::min(least, joint_path_length(start, ordered(configurations, order)));
  while (std::next_permutation(order.begin(), order.end()));
  return least;
}

/// n configurations along a line in joint space, in shuffled order. The start is at the end of the line, so the
/// shortest path has length n.
std::vector<Joints> shuffled_line(std::size_t n, std::uint64_t seed) {
  std::vector<Joints> out(n);
  for (std::size_t i = 0; i < n; ++i) out[i] = Joints::Constant(double(i + 1) / std::sqrt(6.0));
  Rng rng(seed, 0x702);
  for (std::size_t i = n; i > 1; --i) std::swap(out[i - 1], out[rng.below(i)]);
  return out;
}

}  // namespace

TEST_CASE("the length of a path is the sum of its joint differences, views without joints are skipped") {
  std::vector<View> views(4);
  views[0].joints = Joints::Zero();
  views[0].joints->head<2>() << 3.0, 4.0;
  views[2].joints = *views[0].joints;
  (*views[2].joints)[5] = -2.0;
  CHECK(joint_path_length(Joints::Zero(), views) == Approx(7.0));
  CHECK(joint_configurations(views).size() == 2);
  CHECK(joint_path_length(Joints::Zero(), std::vector<View>(3)) == 0.0);
  CHECK(shortest_joint_path(Joints::Zero(), views).length == Approx(7.0));
  CHECK(shortest_joint_path(Joints::Zero(), std::vector<Joints>()).order.empty());
  CHECK(shortest_joint_path(Joints::Zero(), std::vector<Joints>()).length == 0.0);
  views[0].joints->x() = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(joint_path_length(Joints::Zero(), views), InputError);
  CHECK_THROWS_AS(shortest_joint_path(Joints::Zero(), views), InputError);
}

TEST_CASE("the shortest path is the shortest of all permutations") {
  for (std::size_t n = 1; n <= 7; ++n)
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      std::vector<Joints> configurations = random_joints(n + 1, seed + 10 * n);
      const Joints start = configurations.back();
      configurations.pop_back();
      if (n >= 3 && seed == 3) configurations[1] = configurations[0];  // the same joints twice
      const JointPath path = shortest_joint_path(start, configurations);
      CHECK(path.exact);
      REQUIRE(is_permutation_of(path.order, n));
      CHECK(path.length == Approx(joint_path_length(start, ordered(configurations, path.order))));
      CHECK(path.length == Approx(by_brute_force(start, configurations)));
      // Local search, which is used for more configurations, gives a path too, and never a shorter one.
      const JointPath local = local_joint_path(start, configurations);
      REQUIRE(is_permutation_of(local.order, n));
      CHECK(local.exact == (n < 2));
      CHECK(local.length == Approx(joint_path_length(start, ordered(configurations, local.order))));
      CHECK(local.length >= path.length - 1e-9);
      CHECK(local.length <= 1.2 * path.length);
    }
}

TEST_CASE("up to thirteen configurations the path is exact, beyond that it is a good upper bound") {
  for (const std::size_t n : {kExactPath, kExactPath + 1, std::size_t{40}}) {
    // Along a line the shortest path is known.
    const std::vector<Joints> line = shuffled_line(n, n);
    const JointPath straight = shortest_joint_path(Joints::Zero(), line);
    CHECK(straight.exact == (n <= kExactPath));
    CHECK(is_permutation_of(straight.order, n));
    CHECK(straight.length == Approx(double(n)));
    CHECK(joint_path_length(Joints::Zero(), line) > 1.5 * double(n));

    const std::vector<Joints> scattered = random_joints(n, 7);
    const JointPath path = shortest_joint_path(Joints::Zero(), scattered);
    CHECK(is_permutation_of(path.order, n));
    CHECK(path.length == Approx(joint_path_length(Joints::Zero(), ordered(scattered, path.order))));
    CHECK(path.length < joint_path_length(Joints::Zero(), scattered));
    // Starting from the best known order, the search does not end with a longer path.
    CHECK(shortest_joint_path(Joints::Zero(), ordered(scattered, path.order)).length <= path.length + 1e-9);
    CHECK(shortest_joint_path(Joints::Zero(), scattered).order == path.order);
  }
  // The exact path through thirteen is not longer than that of local search.
  const std::vector<Joints> scattered = random_joints(kExactPath, 3);
  CHECK(shortest_joint_path(Joints::Zero(), scattered).length <=
        local_joint_path(Joints::Zero(), scattered).length + 1e-9);
}
