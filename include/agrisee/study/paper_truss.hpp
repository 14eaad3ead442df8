// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Eleven trusses in place of those of the experiment in [1] (docs/paper.md), whose models are not public. They have
/// the same numbers of total and hidden fruit as in the tables on scanning and segmentation, and they are generated
/// from fixed seeds. World frame, metres.
#pragma once

#include <agrisee/study/truss.hpp>

#include <array>
#include <cstdint>

namespace agrisee::study {

/// One of the eleven trusses. The numbers of fruit are from [1]; seed and leaflets are our own choice.
struct PaperTruss {
  int total;           ///< number of fruit
  int hidden;          ///< how many of them hang behind the others
  std::uint64_t seed;  ///< TrussParameters::seed
  int leaflets;        ///< TrussParameters::leaflets
};

/// The eleven trusses, in the order of the tables in [1].
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

/// Generates the one of the eleven trusses that has `total` fruit, `hidden` of them hidden. In the truss with 7 and 1,
/// the fruit hang where the table on localization in [1] puts them.
/// @throws ParameterError if there is no truss with these numbers
Truss make_paper_truss(int total, int hidden);

}  // namespace agrisee::study
