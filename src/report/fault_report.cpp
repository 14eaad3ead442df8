// SPDX-License-Identifier: BSD-3-Clause
#include "report/fault_report.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <map>
#include <tuple>

#include "io/formats/csv.hpp"
#include "report/markdown.hpp"
#include "report/svg.hpp"

namespace agrisee::report {
namespace {

using study::FaultRecord;

/// Sums over all scans with one kind of fault at one rate.
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
  Table out({"faults", "rate", "scans", "fruit", "found", "worst truss", "invented", "views", "faulty", "discarded",
             "wrong poses", "of them believed"});
  for (const auto& [key, s] : sums)
    out.row({spaced(key.first), fixed(100.0 * key.second, 0) + " %", std::to_string(s.scans), std::to_string(s.fruit),
             fixed(s.share(), 1) + " %", std::to_string(s.least) + " %", std::to_string(s.invented),
             std::to_string(s.views), std::to_string(s.faults), std::to_string(s.discarded), std::to_string(s.wrong),
             std::to_string(s.believed)});
  return out.markdown();
}

std::string csv(const std::vector<FaultRecord>& records) {
  io::CsvWriter out;
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
  check_input(!records.empty(), "fault report: there is no record of a scan");
  check_input(path.has_extension(), "fault report: the name of the document needs an extension such as .md");
  std::sort(records.begin(), records.end(), [](const FaultRecord& a, const FaultRecord& b) {
    return std::tie(a.kind, a.rate, a.scene, a.trial) < std::tie(b.kind, b.rate, b.scene, b.trial);
  });
  Sums sums;
  for (const FaultRecord& r : records) sums[{r.kind, r.rate}].add(r);
  const std::string stem = path.stem().string();
  const std::string text =
      "# Scans under faults\n\nScans in which the sensor and the arm fail: each requested view has a fault at the "
      "given rate, either of one kind or,\nfor `any`, of all kinds with equal probability "
      "(include/agrisee/study/faults.hpp describes them). Made by AgriSEE " +
      info.version + " with\n\n```\n" + info.command + "\n```\n\n![Fruit found](" + stem + "/found.svg)\n\n" +
      table(sums) +
      "\nfound: share of all fruit. worst truss: the smallest share in a scan. invented: located fruit that do not "
      "exist. faulty: views with a\nfault. discarded: views whose pose the pipeline found to be wrong. wrong poses: "
      "reported 50 mm off. of them believed: those that\nshowed something and were kept. As a file, with a "
      "row per scan: [faults.csv](" +
      stem + "/faults.csv).\n";
  const std::filesystem::path folder = path.parent_path() / stem;
  io::make_folder(folder);
  io::write_file(folder / "faults.csv", csv(records));
  io::write_file(folder / "found.svg", plot(sums));
  io::write_file(path, text);
}

}  // namespace agrisee::report
