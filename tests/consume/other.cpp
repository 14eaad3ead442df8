// SPDX-License-Identifier: BSD-3-Clause
#include "other.hpp"

#include <agrisee/version.hpp>

std::size_t kept(const std::vector<Eigen::Vector3f>& points) {
  return agrisee::remove_statistical_outliers(points, {}, 2).size();
}

std::string version() { return AGRISEE_VERSION; }
