// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How views kept what was promised of them, and how much further ones can be expected to show. World frame, metres.
/// Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/core/pose.hpp>

#include <vector>

namespace agrisee::plan {

/// How views kept what was promised of them.
class PromiseRecord {
 public:
  /// What a view was expected to show (m2), and what it showed of that.
  struct Outcome {
    double promised = 0.0;  ///< (m2)
    double kept = 0.0;      ///< (m2)
    /// Whether it showed hardly any.
    bool blind() const { return kept < 0.1 * promised; }
  };

  /// Let the outcome of a view count for reliability().
  /// @param measured share (0..1) of the surface in front of the camera that the view measured
  void weigh(const Outcome& outcome, double measured);
  /// Let a view that showed hardly any count for clearness().
  void add_blind(const Pose& world_T_optical) { blind_.push_back(world_T_optical); }

  /// Share (0..1) of what was promised of the last views that they kept; older views count less. 1 while there are
  /// none.
  /// @param area of all fruit found (m2): a small share of it is taken to have been promised and kept before
  double reliability(double area) const;
  /// How much a view can be expected to show (above 0, up to 1) of what is promised of it: less for each blind view
  /// that is close to it and looks in about the same direction.
  double clearness(const Pose& world_T_optical) const;

 private:
  double promised_ = 0.0, kept_ = 0.0;  // of the last views (m2)
  std::vector<Pose> blind_;             // views that showed hardly any of what was promised of them
};

}  // namespace agrisee::plan
