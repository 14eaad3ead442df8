// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// How often bodies were looked at that are still not surely fruit. World frame, metres. Defined in `agrisee::agrisee`.
#pragma once

#include <agrisee/cloud/body_shape.hpp>

#include <cstddef>
#include <vector>

namespace agrisee::plan {

/// Counts the views that looked at bodies which are not surely fruit. A body that was fitted anew is known by its
/// center: it is less than half its mean radius from where the body was first looked at.
class VainLooks {
 public:
  /// Note that a view looked at a body.
  void add(const Ellipsoid& body);
  /// How many views looked at a body.
  int count(const Ellipsoid& body) const;
  /// Forget all.
  void clear() { places_.clear(); }

 private:
  struct Place {
    Eigen::Vector3d center;  // of the body (m, world)
    int looks;               // views that looked at it
  };

  /// Index of the place of a body; the number of places if there is none.
  std::size_t find(const Ellipsoid& body) const;

  std::vector<Place> places_;
};

}  // namespace agrisee::plan
