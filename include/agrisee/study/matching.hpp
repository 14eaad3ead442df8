// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The one-to-one matching with the largest total score. Used to match fruit to the instances of a result.
#pragma once

#include <Eigen/Core>

#include <vector>

namespace agrisee::study {

/// Match rows to columns one to one so that the sum of the matched scores is largest. Pairs with a score of 0 or less
/// are not matched.
///
/// Hungarian method with potentials by successive shortest paths (Kuhn 1955; Munkres 1957). Cost: O(n^2 m) with n =
/// min(rows, columns) and m = max(rows, columns). If several matchings have the same total, the same one is returned
/// every time.
/// @param score one row per fruit, one column per instance, for example; any size, finite
/// @return for each row its column, or -1
/// @throws InputError if a score is not finite
std::vector<int> best_matching(const Eigen::MatrixXd& score);

}  // namespace agrisee::study
