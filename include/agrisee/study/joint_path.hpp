// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How far an arm turns on its way through the views of a scan, and the shortest way through the same views.
///
/// The length of a path is the sum of the Euclidean norms of its joint differences (rad). Each move is a straight line
/// in joint space; collisions along it are not checked.
#pragma once

#include <agrisee/core/types.hpp>
#include <agrisee/result.hpp>

#include <cstddef>
#include <vector>

namespace agrisee::study {

/// A path through some joint configurations.
struct JointPath {
  double length = 0.0;             ///< from the start through all of them (rad)
  std::vector<std::size_t> order;  ///< indices of the configurations in the order in which they are visited
  bool exact = true;               ///< true: no path is shorter; false: the length is an upper bound of the shortest
};

/// Up to this many configurations, shortest_joint_path() is exact.
constexpr std::size_t kExactPath = 13;

/// The joints (rad) of all views that have them, in the order of the views.
std::vector<Joints> joint_configurations(const std::vector<View>& views);

/// Length (rad) of the path from `start` through the configurations in the given order.
/// @throws InputError if a joint angle is not finite
double joint_path_length(const Joints& start, const std::vector<Joints>& configurations);

/// Length (rad) of the path from `start` through the views of a scan in their order. Views without joints are skipped.
/// @throws InputError if a joint angle is not finite
double joint_path_length(const Joints& start, const std::vector<View>& views);

/// The shortest open path from `start` through all configurations; it may end at any of them.
///
/// Up to kExactPath configurations it is exact (Held and Karp, "A Dynamic Programming Approach to Sequencing Problems",
/// 1962). For more, it is local_joint_path(). Nothing is random.
/// Cost: a few milliseconds for 13 configurations, or for 40.
/// @param start joints before the first move (rad)
/// @param configurations joints (rad); one that occurs twice is visited twice
/// @throws InputError if a joint angle is not finite
JointPath shortest_joint_path(const Joints& start, const std::vector<Joints>& configurations);

/// The shortest path through the views of a scan. Views without joints are skipped; `order` counts the others.
/// @throws InputError if a joint angle is not finite
JointPath shortest_joint_path(const Joints& start, const std::vector<View>& views);

/// A short open path from `start` through all configurations, found by local search: an upper bound of the shortest,
/// never longer than the given order.
///
/// The better of two local optima of 2-opt and or-opt (Or, 1976). One search starts from the path that always visits
/// the nearest configuration next, the other from the given order. Nothing is random.
/// @param start joints before the first move (rad)
/// @param configurations joints (rad); one that occurs twice is visited twice
/// @throws InputError if a joint angle is not finite
JointPath local_joint_path(const Joints& start, const std::vector<Joints>& configurations);

}  // namespace agrisee::study
