// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far an arm turns on its way through the views of a scan, and how far it would have had to: the length of a path
/// is the sum of the Euclidean norms of its joint differences (rad). Straight moves; what lies between is not asked.
#pragma once

#include <agrisee/arm/limits.hpp>
#include <agrisee/result.hpp>

#include <algorithm>
#include <limits>
#include <numeric>

namespace agrisee::study {

/// A way through some configurations.
struct JointPath {
  double length = 0.0;             ///< rad, from the start through all of them
  std::vector<std::size_t> order;  ///< indices of the configurations in the order of the way
  bool exact = true;               ///< no shorter one exists; otherwise the length is an upper bound of the shortest
};

/// Up to this many configurations the shortest path is found exactly.
constexpr std::size_t kExactPath = 13;

/// The joints (rad) of those views that have any, in their order.
inline std::vector<Joints> joint_configurations(const std::vector<View>& views) {
  std::vector<Joints> out;
  for (const View& view : views)
    if (view.joints) out.push_back(*view.joints);
  return out;
}

/// Length (rad) of the path from `start` through the configurations in their order.
/// @throws InputError when a joint angle is not finite
inline double joint_path_length(const Joints& start, const std::vector<Joints>& configurations) {
  check_input(start.allFinite(), "joint path: a joint angle is not finite");
  double length = 0.0;
  const Joints* from = &start;
  for (const Joints& q : configurations) {
    check_input(q.allFinite(), "joint path: a joint angle is not finite");
    length += arm::joint_distance(*from, q);
    from = &q;
  }
  return length;
}

/// The same of the views of a scan; views without joints are passed over.
inline double joint_path_length(const Joints& start, const std::vector<View>& views) {
  return joint_path_length(start, joint_configurations(views));
}

namespace detail {

/// Distances between nodes: 0 is the start, i + 1 the i-th configuration.
inline Eigen::MatrixXd joint_distances(const Joints& start, const std::vector<Joints>& configurations) {
  const auto n = static_cast<Eigen::Index>(configurations.size()) + 1;
  const auto node = [&](Eigen::Index i) { return i == 0 ? start : configurations[static_cast<std::size_t>(i - 1)]; };
  Eigen::MatrixXd d(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) d(i, j) = arm::joint_distance(node(i), node(j));
  return d;
}

/// A path as the nodes after the start.
using Nodes = std::vector<Eigen::Index>;

/// The shortest path (Held and Karp, "A Dynamic Programming Approach to Sequencing Problems", 1962), its end free.
/// O(2^n n^2) time for n nodes, at least one.
inline Nodes held_karp(const Eigen::MatrixXd& d) {
  const auto n = static_cast<std::size_t>(d.rows() - 1), sets = std::size_t{1} << n;
  const auto between = [&](std::size_t i, std::size_t j) {  // configurations
    return d(static_cast<Eigen::Index>(i + 1), static_cast<Eigen::Index>(j + 1));
  };
  // The shortest way from the start through a set of configurations that ends at its member j, and where it came from.
  std::vector<double> least(sets * n, std::numeric_limits<double>::infinity());
  std::vector<std::uint8_t> via(sets * n, 0);
  for (std::size_t j = 0; j < n; ++j) least[(std::size_t{1} << j) * n + j] = d(0, static_cast<Eigen::Index>(j + 1));
  for (std::size_t set = 1; set < sets; ++set)
    for (std::size_t j = 0; j < n; ++j) {
      if (!((set >> j) & 1U)) continue;
      const double so_far = least[set * n + j];
      for (std::size_t k = 0; k < n; ++k) {
        if ((set >> k) & 1U) continue;
        const std::size_t to = (set | (std::size_t{1} << k)) * n + k;
        const double length = so_far + between(j, k);
        if (length < least[to]) least[to] = length, via[to] = static_cast<std::uint8_t>(j);
      }
    }
  std::size_t set = sets - 1, at = 0;
  for (std::size_t j = 1; j < n; ++j)
    if (least[set * n + j] < least[set * n + at]) at = j;
  Nodes path(n);
  for (std::size_t i = n; i-- > 0;) {
    path[i] = static_cast<Eigen::Index>(at + 1);
    const std::size_t before = via[set * n + at];
    set &= ~(std::size_t{1} << at);
    at = before;
  }
  return path;
}

/// Always the nearest node that has not been visited, the first of equals.
inline Nodes nearest_neighbour_path(const Eigen::MatrixXd& d) {
  Nodes path, left(static_cast<std::size_t>(d.rows() - 1));
  std::iota(left.begin(), left.end(), Eigen::Index{1});
  for (Eigen::Index at = 0; !left.empty();) {
    const auto next =
        std::min_element(left.begin(), left.end(), [&](Eigen::Index a, Eigen::Index b) { return d(at, a) < d(at, b); });
    path.push_back(at = *next);
    left.erase(next);
  }
  return path;
}

/// Shorten a path until neither turning a part of it round (2-opt) nor moving up to three nodes that follow each other
/// elsewhere, turned round or not (or-opt; Or, 1976), makes it shorter.
inline void improve_path(const Eigen::MatrixXd& d, Nodes& path) {
  const std::size_t n = path.size();
  constexpr double kLess = 1e-12;                                                           // rad: less is rounding
  const auto node = [&](std::size_t i) { return i == 0 ? Eigen::Index{0} : path[i - 1]; };  // i-th of the whole way
  // Step from the i-th to the next; beyond the end nothing follows.
  const auto step = [&](Eigen::Index from, std::size_t to) { return to <= n ? d(from, node(to)) : 0.0; };
  const auto turn_round = [&](std::size_t first, std::size_t last) {
    std::reverse(path.begin() + static_cast<std::ptrdiff_t>(first - 1),
                 path.begin() + static_cast<std::ptrdiff_t>(last));
  };
  const auto improve_once = [&] {
    for (std::size_t i = 1; i <= n; ++i)
      for (std::size_t j = i + 1; j <= n; ++j) {
        const double before = d(node(i - 1), node(i)) + step(node(j), j + 1);
        const double after = d(node(i - 1), node(j)) + step(node(i), j + 1);
        if (after < before - kLess) return turn_round(i, j), true;
      }
    for (std::size_t length = 1; length <= 3 && length < n; ++length)
      for (std::size_t i = 1; i + length <= n + 1; ++i) {  // the nodes i..j move to between k and k + 1
        const std::size_t j = i + length - 1;
        const double freed = d(node(i - 1), node(i)) + step(node(j), j + 1) - step(node(i - 1), j + 1);
        for (std::size_t k = 0; k <= n; ++k) {
          if (k + 1 >= i && k <= j) continue;
          for (const bool round : {false, true}) {
            const Eigen::Index head = node(round ? j : i), tail = node(round ? i : j);
            if (d(node(k), head) + step(tail, k + 1) - step(node(k), k + 1) >= freed - kLess) continue;
            if (round) turn_round(i, j);
            const auto at = [&](std::size_t p) { return path.begin() + static_cast<std::ptrdiff_t>(p - 1); };
            if (k < i)
              std::rotate(at(k + 1), at(i), at(j + 1));
            else
              std::rotate(at(i), at(j + 1), at(k + 1));
            return true;
          }
        }
      }
    return false;
  };
  while (improve_once()) {
  }
}

}  // namespace detail

/// The shortest open path from `start` through all configurations, its end free: exact up to kExactPath of them. Beyond
/// that the better of two local optima of 2-opt and or-opt, one begun with the nearest neighbours and one with the
/// order given: an upper bound of the shortest, and never longer than the order given. Nothing is random.
/// Cost: a few milliseconds for 13 configurations, or for 40.
/// @param start           joints that the arm comes from (rad)
/// @param configurations  joints (rad); one that occurs twice is visited twice
/// @throws InputError when a joint angle is not finite
inline JointPath shortest_joint_path(const Joints& start, const std::vector<Joints>& configurations) {
  JointPath best;
  best.length = joint_path_length(start, configurations);  // which checks them
  best.order.resize(configurations.size());
  std::iota(best.order.begin(), best.order.end(), std::size_t{0});
  best.exact = configurations.size() <= kExactPath;
  if (configurations.size() < 2) return best;
  const Eigen::MatrixXd d = detail::joint_distances(start, configurations);
  const auto offer = [&](const detail::Nodes& path) {
    double length = 0.0;
    Eigen::Index at = 0;
    for (const Eigen::Index next : path) length += d(at, next), at = next;
    if (length >= best.length) return;
    best.length = length;
    for (std::size_t i = 0; i < path.size(); ++i) best.order[i] = static_cast<std::size_t>(path[i] - 1);
  };
  if (best.exact) {
    offer(detail::held_karp(d));
    return best;
  }
  detail::Nodes given(configurations.size());
  std::iota(given.begin(), given.end(), Eigen::Index{1});
  for (detail::Nodes path : {detail::nearest_neighbour_path(d), given}) {
    detail::improve_path(d, path);
    offer(path);
  }
  return best;
}

/// The same through the configurations of the views of a scan; views without joints are passed over, and `order` counts
/// the others.
inline JointPath shortest_joint_path(const Joints& start, const std::vector<View>& views) {
  return shortest_joint_path(start, joint_configurations(views));
}

}  // namespace agrisee::study
