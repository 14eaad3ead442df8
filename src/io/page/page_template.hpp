// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The template of the page of a scan. CMake embeds it from viewer/report.template.html (cmake/EmbedReportPage.cmake).
#pragma once

#include <cstddef>
#include <string_view>

namespace agrisee::io {

/// The text of the template in consecutive pieces. The mark `@REPORT_DATA@`, which the data of the scan replaces, may
/// be divided between two pieces.
extern const std::string_view kPageTemplate[];
/// The number of pieces.
extern const std::size_t kPageTemplatePieces;

}  // namespace agrisee::io
