// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// Results as Python objects, and the conversions of poses that other parts need too.
#pragma once

#include <agrisee/core/pose.hpp>
#include <agrisee/result.hpp>

#include <memory>
#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <string>
#include <vector>

namespace agrisee::python {

namespace py = pybind11;

/// A result that Python's arrays share.
using SharedResult = std::shared_ptr<ScanResult>;

/// A result that Python owns.
inline SharedResult shared(ScanResult&& result) { return std::make_shared<ScanResult>(std::move(result)); }

/// A pose as a homogeneous 4 x 4 matrix.
inline Eigen::Matrix4d matrix_of(const Pose& pose) { return pose.matrix(); }

/// "12 views (4 discarded)"
std::string views_text(const std::vector<View>& views);

/// Warnings, and before them a sentence about the views that were discarded, if any was.
std::vector<std::string> warnings_of(std::vector<std::string> warnings, const std::vector<View>& views);

/// A pose from an argument that has to be a homogeneous 4 x 4 matrix; whether it is rigid is tested where it is used.
/// @param name of the argument, for messages
/// @throws pybind11::type_error for what holds no numbers; InputError for another shape, for masked items, for numbers
///   that are not finite, or for a last row that is not 0 0 0 1
Pose pose_of(const py::handle& argument, const char* name);

}  // namespace agrisee::python
