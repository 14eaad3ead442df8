// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The eleven trusses of the paper's experiment, made anew: its own models are not public, so these have the same
/// counts of total and hidden fruit (scanning and segmentation tables) and come from fixed seeds. World frame, metres.
#pragma once

#include <agrisee/study/truss.hpp>

namespace agrisee::study {

/// One of the paper's trusses.
struct PaperTruss {
  int total;           ///< fruit
  int hidden;          ///< of them, behind the others
  std::uint64_t seed;  ///< of ours
  int leaflets;        ///< of ours
};

/// The eleven, in the order of the paper's tables.
constexpr std::array<PaperTruss, 11> kPaperTrusses{{{5, 1, 51, 0},
                                                    {6, 2, 62, 0},
                                                    {6, 3, 63, 2},
                                                    {7, 1, 71, 0},
                                                    {7, 2, 72, 0},
                                                    {7, 3, 73, 3},
                                                    {8, 2, 82, 0},
                                                    {8, 3, 83, 2},
                                                    {8, 4, 84, 0},
                                                    {9, 2, 92, 3},
                                                    {9, 4, 94, 0}}};

namespace detail {

/// The truss of the paper's localisation table: fruit 1 to 6 near its world centres, fruit 7 behind one of them (where
/// the table puts it, below the others, nothing would hide it).
inline TrussLayout localization_layout(const TrussParameters& params, double spread, Rng& rng) {
  struct Row {
    Eigen::Vector3d center;  // the table's world centre (m)
    double size;             // ours: as large as the centres allow, the uppermost largest
  };
  const Row rows[] = {{{0.060, 0.519, 0.154}, 0.0400}, {{-0.023, 0.521, 0.154}, 0.0400},
                      {{0.064, 0.555, 0.238}, 0.0410}, {{-0.033, 0.550, 0.236}, 0.0415},
                      {{0.060, 0.577, 0.318}, 0.0415}, {{-0.035, 0.573, 0.331}, 0.0420}};
  TrussLayout layout;
  layout.eye = frontal_eye(params.center);
  // The rachis passes between the pairs and a little behind them.
  const Eigen::Vector3d top(0.012, 0.606, 0.375), bottom(0.019, 0.528, 0.130);
  for (int i = 0; i <= 40; ++i) layout.rachis.push_back(top + (bottom - top) * (i / 40.0));
  for (const Row& row : rows) {
    const FruitShape shape = draw_shape(params, row.size, rng);
    layout.fruits.push_back(
        place(shape, row.center, draw_growth_axis(layout.rachis, row.center, rng), rng.uniform(0.0, kTwoPi)));
  }
  settle(layout, 0);
  hide_behind(layout, params.hidden, params, spread, rng);
  return layout;
}

}  // namespace detail

/// One of the eleven trusses.
/// @throws ParameterError when the paper has none with these counts
inline Truss make_paper_truss(int total, int hidden) {
  for (const PaperTruss& p : kPaperTrusses) {
    if (p.total != total || p.hidden != hidden) continue;
    TrussParameters params;
    params.total = total;
    params.hidden = hidden;
    params.seed = p.seed;
    params.leaflets = p.leaflets;
    if (total == 7 && hidden == 1)
      return detail::draw_until_good(
          params, [&](double spread, Rng& rng) { return detail::localization_layout(params, spread, rng); });
    return make_truss(params);
  }
  throw ParameterError("total, hidden: the paper has no truss of " + std::to_string(total) + " fruit with " +
                       std::to_string(hidden) + " hidden");
}

}  // namespace agrisee::study
