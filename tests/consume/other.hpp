// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <agrisee/cloud/sor.hpp>
#include <agrisee/neighbors/kdtree.hpp>

#include <string>

std::size_t kept(const std::vector<Eigen::Vector3f>& points);
std::string version();
