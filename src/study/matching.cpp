// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/core/error.hpp>
#include <agrisee/study/matching.hpp>

#include <algorithm>
#include <limits>

namespace agrisee::study {

std::vector<int> best_matching(const Eigen::MatrixXd& score) {
  std::vector<int> match(static_cast<std::size_t>(score.rows()), -1);
  if (score.size() == 0) return match;
  check_input(score.allFinite(), "matching: a score is not finite");
  if (score.rows() > score.cols()) {
    const std::vector<int> flipped = best_matching(score.transpose());
    for (std::size_t j = 0; j < flipped.size(); ++j)
      if (flipped[j] >= 0) match[static_cast<std::size_t>(flipped[j])] = static_cast<int>(j);
    return match;
  }
  const Eigen::Index n = score.rows(), m = score.cols();
  // Minimize the sum of -max(score, 0): an unwanted pair costs as much as no pair. Row 0 and column 0 are sentinels.
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(n + 1), v = Eigen::VectorXd::Zero(m + 1), least(m + 1);
  Eigen::VectorXi row_of = Eigen::VectorXi::Zero(m + 1), via(m + 1);
  for (int i = 1; i <= n; ++i) {
    row_of[0] = i;
    int j0 = 0;
    least.setConstant(kFar);
    std::vector<char> done(static_cast<std::size_t>(m + 1), 0);
    do {  // Dijkstra's algorithm over the columns, until it reaches an unmatched one
      done[static_cast<std::size_t>(j0)] = 1;
      const int i0 = row_of[j0];
      double step = kFar;
      int next = 0;
      for (int j = 1; j <= m; ++j) {
        if (done[static_cast<std::size_t>(j)]) continue;
        const double reduced = -std::max(score(i0 - 1, j - 1), 0.0) - u[i0] - v[j];
        if (reduced < least[j]) least[j] = reduced, via[j] = j0;
        if (least[j] < step) step = least[j], next = j;
      }
      for (int j = 0; j <= m; ++j)
        if (done[static_cast<std::size_t>(j)])
          u[row_of[j]] += step, v[j] -= step;
        else
          least[j] -= step;
      j0 = next;
    } while (row_of[j0] != 0);
    for (; j0 != 0; j0 = via[j0]) row_of[j0] = row_of[via[j0]];
  }
  for (int j = 1; j <= m; ++j)
    if (row_of[j] > 0 && score(row_of[j] - 1, j - 1) > 0.0) match[static_cast<std::size_t>(row_of[j] - 1)] = j - 1;
  return match;
}

}  // namespace agrisee::study
