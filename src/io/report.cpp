// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/report.hpp>

#include "report_data.hpp"

namespace agrisee::io {
namespace {

/// A file name as part of a URL.
std::string url(const std::string& name) {
  static const char* const digits = "0123456789ABCDEF";
  std::string out;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    const bool plain =
        (u >= '0' && u <= '9') || ((u | 32) >= 'a' && (u | 32) <= 'z') || c == '-' || c == '_' || c == '.';
    if (plain)
      out += c;
    else
      out += '%', out += digits[u / 16], out += digits[u % 16];
  }
  return out;
}

}  // namespace

void write_report(const std::filesystem::path& path, const std::vector<study::CellRecord>& cells,
                  const std::vector<study::SceneRecord>& scenes, const ReportInfo& info) {
  if (!path.has_extension())
    throw InputError("report: '" + path.string() +
                     "' needs an extension such as .md, its folder takes the name without it");
  report::Data data = report::arrange(cells, scenes);
  data.folder = url(path.stem().string());
  std::string text = report::introduction(data, info);
  for (const auto section :
       {report::summary_section, report::scanning_section, report::segmentation_section, report::localization_section,
        report::noise_section, report::planner_section, report::limit_section, report::contradictions_section})
    text += section(data);
  std::vector<report::File> files = report::csv_files(data);
  for (report::File& plot : report::plots(data)) files.push_back(std::move(plot));
  const std::filesystem::path folder = path.parent_path() / path.stem();
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) fail(folder, "cannot be made: " + failed.message());
  for (const report::File& file : files) write_file(folder / file.name, file.bytes);
  write_file(path, text);
}

}  // namespace agrisee::io
