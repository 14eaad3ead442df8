// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The results that [1] reports: the figures of its three result tables, and those in its text. Percentages as printed
/// (0..100); metres and seconds unless stated otherwise.
#pragma once

#include <array>
#include <cstddef>

namespace agrisee::study {

/// A row of the table "Analysis of AgriSEE scanning and SOR filtering".
struct PaperScanning {
  int total;         ///< number of fruit
  int hidden;        ///< how many of them are hidden
  int views;         ///< number of views taken
  int merged;        ///< points before SOR
  int filtered;      ///< points after SOR
  double seconds;    ///< computation time
  double scanned;    ///< scanned percentage (%)
  double precision;  ///< %
  double recall;     ///< %
  double f1;         ///< %
};

/// A row of the table "RG and DBSCAN Evaluation".
struct PaperSegmentation {
  int total;                ///< number of fruit
  int hidden;               ///< how many of them are hidden
  int n_real;               ///< "real tomatoes"; the first row has 6 for a truss of 5
  int n_det;                ///< number of fruit detected
  int counting_error;       ///< CE
  double object_precision;  ///< P_obj (%)
  double object_recall;     ///< R_obj (%)
  double miou;              ///< %
};

/// A row of the table of tomato centers, which shows the truss of kPaperLocalizationTotal fruit.
struct PaperLocalization {
  int fruit;                            ///< number of the fruit, from 1
  std::array<double, 3> cluster;        ///< centroid in the cluster frame (m)
  std::array<double, 3> cluster_sigma;  ///< standard deviation of its points (m)
  std::array<double, 3> world;          ///< centroid in world (m)
  std::array<double, 3> world_sigma;    ///< standard deviation of its points (m)
  double rmse;                          ///< repeatability over three trials (mm)
};

/// The table "Analysis of AgriSEE scanning and SOR filtering".
constexpr std::array<PaperScanning, 11> kPaperScanning{{{5, 1, 5, 12460, 7850, 40.1, 86.2, 95.1, 84.8, 89.7},
                                                        {6, 2, 7, 12610, 7620, 46.8, 82.8, 93.8, 81.2, 87.0},
                                                        {6, 3, 9, 12330, 7380, 51.3, 74.4, 91.6, 72.5, 80.9},
                                                        {7, 1, 12, 14101, 9240, 72.1, 80.6, 95.3, 79.1, 86.4},
                                                        {7, 2, 12, 13940, 9050, 72.3, 74.1, 94.1, 72.6, 82.0},
                                                        {7, 3, 13, 13410, 8810, 76.1, 65.9, 92.4, 64.2, 75.7},
                                                        {8, 2, 12, 15742, 10610, 71.5, 82.3, 95.0, 80.8, 87.3},
                                                        {8, 3, 13, 15630, 10240, 77.2, 71.5, 92.9, 69.8, 79.7},
                                                        {8, 4, 13, 15112, 10780, 76.6, 64.2, 88.5, 62.5, 73.3},
                                                        {9, 2, 14, 17480, 11950, 82.3, 71.4, 95.3, 69.9, 80.6},
                                                        {9, 4, 14, 17220, 11510, 84.7, 56.7, 93.0, 55.1, 69.2}}};

/// The table "RG and DBSCAN Evaluation".
constexpr std::array<PaperSegmentation, 11> kPaperSegmentation{{{5, 1, 6, 6, 0, 100.0, 100.0, 88.4},
                                                                {6, 2, 6, 5, 1, 100.0, 83.3, 85.1},
                                                                {6, 3, 6, 4, 2, 100.0, 66.7, 79.2},
                                                                {7, 1, 7, 7, 0, 100.0, 100.0, 87.3},
                                                                {7, 2, 7, 6, 1, 100.0, 85.7, 83.9},
                                                                {7, 3, 7, 5, 2, 100.0, 71.4, 76.5},
                                                                {8, 2, 8, 8, 0, 100.0, 100.0, 86.8},
                                                                {8, 3, 8, 6, 2, 100.0, 75.0, 78.3},
                                                                {8, 4, 8, 4, 4, 100.0, 50.0, 67.2},
                                                                {9, 2, 9, 9, 0, 100.0, 100.0, 85.9},
                                                                {9, 4, 9, 7, 2, 100.0, 77.8, 77.6}}};

/// Number of fruit of the truss in the localization table. The text's example of the residual seems to be the same
/// truss.
constexpr int kPaperLocalizationTotal = 7;
constexpr int kPaperLocalizationHidden = 1;  ///< how many of these are hidden

/// The table of tomato centers.
constexpr std::array<PaperLocalization, 7> kPaperLocalization{
    {{1, {0.065, 0.044, 0.044}, {0.006, 0.007, 0.008}, {0.060, 0.519, 0.154}, {0.007, 0.009, 0.010}, 3.6},
     {2, {-0.032, 0.039, 0.043}, {0.009, 0.011, 0.012}, {-0.023, 0.521, 0.154}, {0.011, 0.013, 0.014}, 4.1},
     {3, {0.051, 0.047, 0.133}, {0.012, 0.015, 0.016}, {0.064, 0.555, 0.238}, {0.014, 0.017, 0.018}, 4.7},
     {4, {-0.046, 0.050, 0.129}, {0.007, 0.009, 0.010}, {-0.033, 0.550, 0.236}, {0.008, 0.011, 0.012}, 3.9},
     {5, {0.052, 0.042, 0.214}, {0.015, 0.019, 0.021}, {0.060, 0.577, 0.318}, {0.017, 0.022, 0.023}, 5.2},
     {6, {-0.037, 0.053, 0.226}, {0.010, 0.012, 0.013}, {-0.035, 0.573, 0.331}, {0.011, 0.014, 0.015}, 4.3},
     {7, {0.032, 0.002, 0.085}, {0.018, 0.022, 0.024}, {0.030, 0.536, 0.087}, {0.020, 0.025, 0.026}, 5.6}}};

/// Figures in the text and in the average rows of the tables.
struct PaperText {
  double abstract_recall = 82.8;       ///< abstract: average recall (%)
  double abstract_miou = 80.7;         ///< abstract and section on segmentation: mIoU (%)
  double abstract_rmse = 4.2;          ///< abstract: repeatability RMSE (mm)
  double text_object_recall = 82.8;    ///< section on segmentation: average R_obj (%)
  double table_object_recall = 82.7;   ///< average row of the segmentation table (%)
  double table_miou = 81.5;            ///< average row of the segmentation table (%)
  double conclusion_precision = 91.6;  ///< conclusion: precision is consistently above this (%)
  int residual_cloud = 8325;           ///< text: points of the filtered cloud of a truss of seven
  int residual_grown = 2632;           ///< text: how many of these are in the seven clusters of region growing
  int residual_per_instance = 439;     ///< text: points per instance, "approximately"
};
/// The one instance of PaperText.
constexpr PaperText kPaperText{};

/// The row of a table for a truss of `total` fruit of which `hidden` are hidden; null if there is none.
template <typename Row, std::size_t N>
constexpr const Row* find_paper_row(const std::array<Row, N>& table, int total, int hidden) {
  for (std::size_t i = 0; i < N; ++i)
    if (table[i].total == total && table[i].hidden == hidden) return &table[i];
  return nullptr;
}
/// The row of kPaperScanning for a truss; null if there is none.
constexpr const PaperScanning* paper_scanning(int total, int hidden) {
  return find_paper_row(kPaperScanning, total, hidden);
}
/// The row of kPaperSegmentation for a truss; null if there is none.
constexpr const PaperSegmentation* paper_segmentation(int total, int hidden) {
  return find_paper_row(kPaperSegmentation, total, hidden);
}
/// The row of kPaperLocalization for fruit number `fruit` of a truss; null if there is none.
constexpr const PaperLocalization* paper_localization(int total, int hidden, int fruit) {
  if (total != kPaperLocalizationTotal || hidden != kPaperLocalizationHidden) return nullptr;
  if (fruit < 1 || fruit > static_cast<int>(kPaperLocalization.size())) return nullptr;
  return &kPaperLocalization[static_cast<std::size_t>(fruit - 1)];
}

}  // namespace agrisee::study
