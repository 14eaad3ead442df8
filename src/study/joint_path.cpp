// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/arm/limits.hpp>
#include <agrisee/core/error.hpp>
#include <agrisee/study/joint_path.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

namespace agrisee::study {
namespace {

/// A path as its nodes after the start: node 0 is the start, node i + 1 the i-th configuration.
using Nodes = std::vector<Eigen::Index>;

/// Distances (rad) between all nodes.
Eigen::MatrixXd joint_distances(const Joints& start, const std::vector<Joints>& configurations) {
  const auto n = static_cast<Eigen::Index>(configurations.size()) + 1;
  const auto node = [&](Eigen::Index i) { return i == 0 ? start : configurations[static_cast<std::size_t>(i - 1)]; };
  Eigen::MatrixXd d(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) d(i, j) = arm::joint_distance(node(i), node(j));
  return d;
}

/// The shortest path by dynamic programming over sets of configurations (Held and Karp, 1962), for at least one
/// configuration. Cost: O(2^n n^2) for n configurations.
Nodes held_karp(const Eigen::MatrixXd& d) {
  const auto n = static_cast<std::size_t>(d.rows() - 1), sets = std::size_t{1} << n;
  const auto between = [&](std::size_t i, std::size_t j) {  // configurations
    return d(static_cast<Eigen::Index>(i + 1), static_cast<Eigen::Index>(j + 1));
  };
  // least[set * n + j]: length of the shortest path from the start through a set of configurations that ends at its
  // member j. via: the configuration before j on that path.
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

/// The path that always visits the nearest node next; of equally near ones, the first.
Nodes nearest_neighbor_path(const Eigen::MatrixXd& d) {
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

/// Shortens a path by local changes. Positions count from 1 along the path; position 0 is the start.
class LocalSearch {
 public:
  LocalSearch(const Eigen::MatrixXd& d, Nodes& path) : d_(d), path_(path), n_(path.size()) {}

  /// Change the path until neither kind of change makes it shorter.
  void run() {
    while (reverse_part() || move_part()) {
    }
  }

 private:
  static constexpr double kLess = 1e-12;  // rad: smaller gains are rounding errors

  Eigen::Index node(std::size_t i) const { return i == 0 ? Eigen::Index{0} : path_[i - 1]; }
  /// Distance from a node to the one at position `to`; 0 beyond the end of the path.
  double step(Eigen::Index from, std::size_t to) const { return to <= n_ ? d_(from, node(to)) : 0.0; }
  Nodes::iterator at(std::size_t i) { return path_.begin() + static_cast<std::ptrdiff_t>(i - 1); }
  void reverse(std::size_t first, std::size_t last) { std::reverse(at(first), at(last + 1)); }

  /// 2-opt: reverse the first part found whose reversal shortens the path. @return false if there is none
  bool reverse_part() {
    for (std::size_t i = 1; i <= n_; ++i)
      for (std::size_t j = i + 1; j <= n_; ++j) {
        const double before = d_(node(i - 1), node(i)) + step(node(j), j + 1);
        const double after = d_(node(i - 1), node(j)) + step(node(i), j + 1);
        if (after < before - kLess) return reverse(i, j), true;
      }
    return false;
  }

  /// Or-opt: move the first part of one to three nodes found that shortens the path elsewhere, reversed or not.
  /// @return false if there is none
  bool move_part() {
    for (std::size_t length = 1; length <= 3 && length < n_; ++length)
      for (std::size_t i = 1; i + length <= n_ + 1; ++i) {  // the nodes i..j move to between k and k + 1
        const std::size_t j = i + length - 1;
        const double freed = d_(node(i - 1), node(i)) + step(node(j), j + 1) - step(node(i - 1), j + 1);
        for (std::size_t k = 0; k <= n_; ++k) {
          if (k + 1 >= i && k <= j) continue;
          for (const bool reversed : {false, true}) {
            const Eigen::Index head = node(reversed ? j : i), tail = node(reversed ? i : j);
            if (d_(node(k), head) + step(tail, k + 1) - step(node(k), k + 1) >= freed - kLess) continue;
            if (reversed) reverse(i, j);
            if (k < i)
              std::rotate(at(k + 1), at(i), at(j + 1));
            else
              std::rotate(at(i), at(j + 1), at(k + 1));
            return true;
          }
        }
      }
    return false;
  }

  const Eigen::MatrixXd& d_;
  Nodes& path_;
  std::size_t n_;
};

/// The path in the given order. @throws InputError if a joint angle is not finite
JointPath given_path(const Joints& start, const std::vector<Joints>& configurations) {
  JointPath path;
  path.length = joint_path_length(start, configurations);
  path.order.resize(configurations.size());
  std::iota(path.order.begin(), path.order.end(), std::size_t{0});
  return path;
}

/// Replace `best` by a path if that is shorter.
void keep_shorter(const Eigen::MatrixXd& d, const Nodes& path, JointPath& best) {
  double length = 0.0;
  Eigen::Index at = 0;
  for (const Eigen::Index next : path) length += d(at, next), at = next;
  if (length >= best.length) return;
  best.length = length;
  for (std::size_t i = 0; i < path.size(); ++i) best.order[i] = static_cast<std::size_t>(path[i] - 1);
}

}  // namespace

std::vector<Joints> joint_configurations(const std::vector<View>& views) {
  std::vector<Joints> out;
  for (const View& view : views)
    if (view.joints) out.push_back(*view.joints);
  return out;
}

double joint_path_length(const Joints& start, const std::vector<Joints>& configurations) {
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

double joint_path_length(const Joints& start, const std::vector<View>& views) {
  return joint_path_length(start, joint_configurations(views));
}

JointPath shortest_joint_path(const Joints& start, const std::vector<Joints>& configurations) {
  if (configurations.size() > kExactPath) return local_joint_path(start, configurations);
  JointPath best = given_path(start, configurations);
  if (configurations.size() < 2) return best;
  const Eigen::MatrixXd d = joint_distances(start, configurations);
  keep_shorter(d, held_karp(d), best);
  return best;
}

JointPath shortest_joint_path(const Joints& start, const std::vector<View>& views) {
  return shortest_joint_path(start, joint_configurations(views));
}

JointPath local_joint_path(const Joints& start, const std::vector<Joints>& configurations) {
  JointPath best = given_path(start, configurations);
  if (configurations.size() < 2) return best;
  best.exact = false;
  const Eigen::MatrixXd d = joint_distances(start, configurations);
  Nodes given(configurations.size());
  std::iota(given.begin(), given.end(), Eigen::Index{1});
  for (Nodes path : {nearest_neighbor_path(d), given}) {
    LocalSearch(d, path).run();
    keep_shorter(d, path, best);
  }
  return best;
}

}  // namespace agrisee::study
