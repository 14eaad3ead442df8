// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/fault_report.hpp>
#include <agrisee/io/files.hpp>

#include <algorithm>
#include <map>
#include <tuple>

#include "csv.hpp"
#include "report_data.hpp"
#include "svg.hpp"

namespace agrisee::io {
namespace {

using study::FaultRecord;

/// All scans of a kind of fault at a rate.
struct Sum {
  std::size_t scans = 0;
  int fruit = 0, found = 0, invented = 0, views = 0, discarded = 0, faults = 0, wrong = 0, believed = 0, least = 100;

  void add(const FaultRecord& r) {
    ++scans;
    fruit += r.fruit;
    found += r.found;
    invented += r.invented;
    views += r.views;
    discarded += r.discarded;
    faults += r.faults;
    wrong += r.wrong_poses;
    believed += r.wrong_believed;
    if (r.fruit > 0) least = std::min(least, 100 * r.found / r.fruit);
  }
  double share() const { return fruit > 0 ? 100.0 * found / fruit : 0.0; }
};

using Sums = std::map<std::pair<std::string, double>, Sum>;  // by kind and rate

std::string spaced(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string table(const Sums& sums) {
  report::Table out({"faults", "rate", "scans", "fruit", "found", "worst truss", "invented", "views", "struck",
                     "discarded", "wrong poses", "of them believed"});
  for (const auto& [key, s] : sums)
    out.row({spaced(key.first), report::fixed(100.0 * key.second, 0) + " %", std::to_string(s.scans),
             std::to_string(s.fruit), report::fixed(s.share(), 1) + " %", std::to_string(s.least) + " %",
             std::to_string(s.invented), std::to_string(s.views), std::to_string(s.faults), std::to_string(s.discarded),
             std::to_string(s.wrong), std::to_string(s.believed)});
  return out.markdown();
}

std::string csv(const std::vector<FaultRecord>& records) {
  CsvWriter out;
  for (const char* name : {"scene", "faults", "rate", "trial", "fruit", "found", "invented", "views", "discarded",
                           "struck", "wrong_poses", "wrong_believed", "stop_reason"})
    out.cell(name);
  out.end_row();
  for (const FaultRecord& r : records) {
    out.cell(r.scene);
    out.cell(r.kind);
    out.cell(r.rate);
    for (const int n :
         {r.trial, r.fruit, r.found, r.invented, r.views, r.discarded, r.faults, r.wrong_poses, r.wrong_believed})
      out.cell(static_cast<std::size_t>(n));
    out.cell(r.stop_reason);
    out.end_row();
  }
  return out.text();
}

std::string plot(const Sums& sums) {
  std::vector<svg::Line> lines;
  for (const auto& [key, s] : sums) {
    const std::string name = spaced(key.first);
    if (lines.empty() || lines.back().name != name) lines.push_back({name, svg::color(lines.size()), {}});
    lines.back().points.emplace_back(100.0 * key.second, s.share());
  }
  return svg::line_chart("Fruit found under faults", "views that go wrong (%)", "fruit found (%)", 100.0, lines);
}

}  // namespace

void write_fault_report(const std::filesystem::path& path, std::vector<FaultRecord> records, const ReportInfo& info) {
  check_input(!records.empty(), "fault report: no record");
  check_input(path.has_extension(), "fault report: the document's name needs an extension such as .md");
  std::sort(records.begin(), records.end(), [](const FaultRecord& a, const FaultRecord& b) {
    return std::tie(a.kind, a.rate, a.scene, a.trial) < std::tie(b.kind, b.rate, b.scene, b.trial);
  });
  Sums sums;
  for (const FaultRecord& r : records) sums[{r.kind, r.rate}].add(r);
  const std::string stem = path.stem().string();
  std::string text =
      "# Faults of the world\n\n"
      "Scans whose sensor and arm go wrong: each view that is asked for is struck at the rate by one fault of the "
      "kind, "
      "or by any,\neach as likely (include/agrisee/study/faults.hpp says what each does). Made by AgriSEE " +
      info.version + " with\n\n```\n" + info.command + "\n```\n\n![Fruit found](" + stem + "/found.svg)\n\n" +
      table(sums) +
      "\nfound: share of all fruit; worst truss: the least of one scan. invented: located without being there. "
      "discarded: views that\nthe pipeline did not believe. wrong poses: reported 50 mm off; believed: those of them "
      "that showed something and were not\ndiscarded. A row a scan: [faults.csv](" +
      stem + "/faults.csv).\n";
  const std::filesystem::path folder = path.parent_path() / stem;
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) fail(folder, "cannot be made: " + failed.message());
  write_file(folder / "faults.csv", csv(records));
  write_file(folder / "found.svg", plot(sums));
  write_file(path, text);
}

}  // namespace agrisee::io
