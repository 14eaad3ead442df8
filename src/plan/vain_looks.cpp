// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/plan/vain_looks.hpp>

#include <algorithm>

namespace agrisee::plan {

void VainLooks::add(const Ellipsoid& body) {
  const std::size_t known = find(body);
  if (known < places_.size())
    ++places_[known].looks;
  else
    places_.push_back({body.center, 1});
}

int VainLooks::count(const Ellipsoid& body) const {
  const std::size_t known = find(body);
  return known < places_.size() ? places_[known].looks : 0;
}

std::size_t VainLooks::find(const Ellipsoid& body) const {
  const auto same = [&](const Place& p) { return (p.center - body.center).norm() < 0.5 * body.mean_radius(); };
  return static_cast<std::size_t>(std::find_if(places_.begin(), places_.end(), same) - places_.begin());
}

}  // namespace agrisee::plan
