// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/study/paper_truss.hpp>

#include <string>

#include "truss_search.hpp"

namespace agrisee::study {

namespace {

/// The truss of the table on localization in [1]. Fruit 1 to 6 hang close to the world centers in the table. Fruit 7
/// hangs behind one of them, because nothing would hide it at its place in the table, below the others.
TrussLayout localization_layout(const TrussParameters& parameters, double spread, Rng& rng) {
  struct Row {
    Eigen::Vector3d center;  // the world center in the table (m)
    double size;             // our choice (m): as large as the centers allow, and larger at the top
  };
  const Row rows[] = {{{0.060, 0.519, 0.154}, 0.0400}, {{-0.023, 0.521, 0.154}, 0.0400},
                      {{0.064, 0.555, 0.238}, 0.0410}, {{-0.033, 0.550, 0.236}, 0.0415},
                      {{0.060, 0.577, 0.318}, 0.0415}, {{-0.035, 0.573, 0.331}, 0.0420}};
  TrussLayout layout;
  layout.eye = frontal_eye(parameters.center);
  // The rachis runs between the pairs of fruit, a little behind them.
  const Eigen::Vector3d top(0.012, 0.606, 0.375), bottom(0.019, 0.528, 0.130);
  for (int i = 0; i <= 40; ++i) layout.rachis.push_back(top + (bottom - top) * (i / 40.0));
  for (const Row& row : rows) {
    const FruitShape shape = draw_shape(parameters, row.size, rng);
    layout.fruits.push_back(draw_fruit(shape, row.center, layout.rachis, rng));
  }
  settle(layout, 0);
  hide_behind(layout, parameters.hidden, parameters, spread, rng);
  return layout;
}

}  // namespace

Truss make_paper_truss(int total, int hidden) {
  for (const PaperTruss& p : kPaperTrusses) {
    if (p.total != total || p.hidden != hidden) continue;
    TrussParameters parameters;
    parameters.total = total;
    parameters.hidden = hidden;
    parameters.seed = p.seed;
    parameters.leaflets = p.leaflets;
    if (total == 7 && hidden == 1)
      return find_truss(parameters,
                        [&](double spread, Rng& rng) { return localization_layout(parameters, spread, rng); });
    return make_truss(parameters);
  }
  throw ParameterError("total, hidden: the paper has no truss of " + std::to_string(total) + " fruit with " +
                       std::to_string(hidden) + " hidden");
}

}  // namespace agrisee::study
