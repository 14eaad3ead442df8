// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The page that reports are made of, embedded at build time from viewer/report.template.html.
#pragma once

#include <cstddef>
#include <string_view>

namespace agrisee::io {

/// Pieces of the page in order; one of them holds, whole or in part, the mark `@REPORT_DATA@`.
extern const std::string_view kReportPage[];
extern const std::size_t kReportPagePieces;

}  // namespace agrisee::io
