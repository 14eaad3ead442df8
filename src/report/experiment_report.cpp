// SPDX-License-Identifier: BSD-3-Clause
#include "report/experiment_report.hpp"

#include <agrisee/io/files.hpp>

#include "report/sections.hpp"

namespace agrisee::report {
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

void write_experiment_report(const std::filesystem::path& path, const std::vector<study::CellRecord>& cells,
                             const std::vector<study::SceneRecord>& scenes, const ReportInfo& info) {
  if (!path.has_extension())
    throw InputError("report: '" + path.string() +
                     "' needs an extension such as .md; the name without it is that of the folder of attachments");
  Data data = arrange(cells, scenes);
  data.folder = url(path.stem().string());
  std::string text = introduction(data, info);
  for (const auto section : {summary_section, planner_section, noise_section}) text += section(data);
  if (info.per_truss) {
    for (const auto section : {limit_section, scanning_section, segmentation_section, localization_section})
      text += section(data);
    text += paper_section();
  }
  std::vector<File> files;
  for (std::vector<File> all : {csv_files(data), plots(data)})
    for (File& file : all)
      if (text.find("/" + file.name + ")") != std::string::npos) files.push_back(std::move(file));
  const std::filesystem::path folder = path.parent_path() / path.stem();
  io::make_folder(folder);
  for (const File& file : files) io::write_file(folder / file.name, file.bytes);
  io::write_file(path, text);
}

}  // namespace agrisee::report
