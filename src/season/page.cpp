// SPDX-License-Identifier: BSD-3-Clause
#include "season/page.hpp"

#include <algorithm>
#include <functional>
#include <iomanip>
#include <sstream>

namespace agrisee::season {
namespace {

constexpr const char* kRipenessColors[kRipenessClasses] = {"#4b8b3b", "#a3b04a", "#d9b44a",
                                                           "#e39a7b", "#dd6b4d", "#c2281c"};
constexpr const char* kStyle = R"(
:root { color-scheme: light dark; --line: #8884; --bar: #5b7fb5; }
body { font: 15px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 72rem; padding: 0 1rem; }
h1 { margin-bottom: .2rem; } h2 { margin-top: 2.2rem; } .note { border-left: 4px solid #d9a400; padding-left: .8rem; }
table { border-collapse: collapse; } .wide { overflow-x: auto; }
th, td { padding: .2rem .6rem; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; } th { font-weight: 600; }
.grid td { min-width: 3.2rem; color: #000; } .grid td:first-child, .grid td.none { color: inherit; }
.ripe { display: flex; width: 9rem; height: .9rem; } .ripe i { display: block; height: 100%; }
.key i { display: inline-block; width: .9rem; height: .9rem; margin: 0 .3rem 0 1rem; vertical-align: -.1rem; }
svg { display: block; } .sizes { display: flex; flex-wrap: wrap; gap: 1rem; } .sizes figure { margin: 0; }
figcaption { font-size: .85rem; } rect { fill: var(--bar); } text { fill: currentColor; font-size: 10px; }
@media print { body { max-width: none; margin: 0; } }
)";

std::string escaped_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string number(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

/// "1 234 567", with thin spaces
std::string count_text(std::size_t value) {
  std::string text = std::to_string(value);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, "&#8239;");
  return text;
}

std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }
std::string optional_cell(const std::optional<double>& value, int digits) {
  return cell(value ? number(*value, digits) : "");
}
std::string label(const std::string& name) { return name.empty() ? "unknown" : escaped_html(name); }

std::optional<double> fruit_per_scan(const Tally& tally) {
  if (tally.scans == 0) return std::nullopt;
  return static_cast<double>(tally.fruit) / static_cast<double>(tally.scans);
}
std::optional<double> ripe_percent(const Tally& tally) {
  const auto share = tally.ripe_share();
  return share ? std::optional(100.0 * *share) : std::nullopt;
}

/// A bar with the shares of the classes of ripeness.
std::string ripeness_bar(const Tally& tally) {
  if (tally.colored() == 0) return "";
  std::string out = "<div class=\"ripe\">";
  for (std::size_t i = 0; i < kRipenessClasses; ++i)
    if (tally.ripe[i] > 0)
      out += "<i title=\"" + std::string(to_string(static_cast<RipenessClass>(i))) + ": " + count_text(tally.ripe[i]) +
             "\" style=\"background:" + kRipenessColors[i] +
             ";width:" + number(100.0 * static_cast<double>(tally.ripe[i]) / static_cast<double>(tally.colored()), 2) +
             "%\"></i>";
  return out + "</div>";
}

/// A line of a table: what it is about, and the scans of that.
struct Line {
  std::vector<std::string> labels;
  Tally tally;
};

std::string table_row(const Line& line) {
  const Tally& t = line.tally;
  const auto low = t.diameter(0.1), high = t.diameter(0.9);
  std::string labels;
  for (const std::string& text : line.labels) labels += cell(label(text));
  return "<tr>" + labels + cell(count_text(t.scans)) + cell(t.failed > 0 ? count_text(t.failed) : "") +
         cell(count_text(t.fruit)) + optional_cell(fruit_per_scan(t), 1) + optional_cell(t.diameter(0.5), 1) +
         cell(low ? number(*low, 0) + " to " + number(*high, 0) : "") + cell(t.sized > 0 ? number(t.mass, 1) : "") +
         optional_cell(ripe_percent(t), 0) + cell(ripeness_bar(t)) + "</tr>\n";
}

std::string table(const std::vector<std::string>& titles, const std::vector<Line>& lines) {
  std::string out = "<div class=\"wide\"><table><tr>";
  for (const std::string& title : titles) out += "<th>" + title + "</th>";
  out +=
      "<th>scans</th><th>failed</th><th>fruit</th><th>a scan</th><th>diameter, mm</th><th>80 % of them</th>"
      "<th>mass, kg</th><th>ripe, %</th><th>ripeness</th></tr>\n";
  for (const Line& line : lines) out += table_row(line);
  return out + "</table></div>\n";
}

/// The color of a value between the smallest and the largest: from pale to deep.
std::string heat(double value, double least, double most) {
  const double at = most > least ? (value - least) / (most - least) : 0.5;
  return "hsl(" + number(210.0 - 175.0 * at, 0) + ",65%," + number(88.0 - 26.0 * at, 0) + "%)";
}

/// A value for every row and date.
std::string grid(const Overview& overview, const std::string& title, int digits,
                 const std::function<std::optional<double>(const Tally&)>& value_of) {
  double least = 1e300, most = -1e300;
  for (const auto& [row, dates] : overview.cells)
    for (const auto& [date, tally] : dates)
      if (const auto value = value_of(tally)) least = std::min(least, *value), most = std::max(most, *value);
  if (most < least) return "";
  std::string out = "<h3>" + title + "</h3>\n<div class=\"wide\"><table class=\"grid\"><tr><th>row</th>";
  const std::vector<std::string> dates = overview.dates();
  for (const std::string& date : dates) out += "<th>" + label(date) + "</th>";
  out += "</tr>\n";
  for (const std::string& row : overview.rows()) {
    out += "<tr>" + cell(label(row));
    const auto& of_row = overview.cells.at(row);
    for (const std::string& date : dates) {
      const auto found = of_row.find(date);
      const auto value = found == of_row.end() ? std::nullopt : value_of(found->second);
      out += value ? "<td style=\"background:" + heat(*value, least, most) + "\">" + number(*value, digits) + "</td>"
                   : "<td class=\"none\"></td>";
    }
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

/// How many fruit have which diameter, drawn over `from` to `to` mm.
std::string histogram(const std::string& name, const Tally& tally, std::size_t from, std::size_t to) {
  constexpr double kWidth = 220.0, kHeight = 70.0;
  std::size_t most = 1;
  for (std::size_t i = from; i < to; ++i) most = std::max(most, tally.diameters[i]);
  const double step = kWidth / static_cast<double>(to - from);
  std::string out = "<figure><svg width=\"220\" height=\"84\" role=\"img\">";
  for (std::size_t i = from; i < to; ++i) {
    if (tally.diameters[i] == 0) continue;
    const double height = kHeight * static_cast<double>(tally.diameters[i]) / static_cast<double>(most);
    out += "<rect x=\"" + number(step * static_cast<double>(i - from), 1) + "\" y=\"" + number(kHeight - height, 1) +
           "\" width=\"" + number(0.9 * step, 1) + "\" height=\"" + number(height, 1) + "\"/>";
  }
  return out + "<text x=\"0\" y=\"82\">" + std::to_string(from) +
         "</text><text x=\"220\" y=\"82\" text-anchor=\"end\">" + std::to_string(to) + " mm</text></svg><figcaption>" +
         label(name) + ", " + count_text(tally.sized) + " fruit</figcaption></figure>\n";
}

std::string histograms(const Overview& overview, const Tally& all) {
  const auto is_used = [](std::size_t n) { return n > 0; };
  const auto first = std::find_if(all.diameters.begin(), all.diameters.end(), is_used);
  if (first == all.diameters.end()) return "";
  const auto last = std::find_if(all.diameters.rbegin(), all.diameters.rend(), is_used).base();
  constexpr std::size_t kRound = 10;
  const std::size_t from = static_cast<std::size_t>(first - all.diameters.begin()) / kRound * kRound;
  const std::size_t to = std::min<std::size_t>(
      Tally::kBins, (static_cast<std::size_t>(last - all.diameters.begin()) + kRound - 1) / kRound * kRound);
  std::string out = "<h2>Sizes</h2>\n<div class=\"sizes\">\n";
  for (const std::string& date : overview.dates()) out += histogram(date, overview.of_date(date), from, to);
  return out + "</div>\n";
}

}  // namespace

std::string season_page(const Overview& overview, const std::string& name) {
  const Tally all = overview.all(), last = overview.of_date(overview.last_date());
  const std::vector<std::string> dates = overview.dates(), rows = overview.rows();
  std::vector<Line> of_dates, of_rows;
  for (const std::string& date : dates) of_dates.push_back({{date}, overview.of_date(date)});
  for (const std::string& row : rows) {
    const std::string date = overview.last_date(row);
    of_rows.push_back({{row, date}, overview.of(row, date)});
  }
  std::string out = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped_html(name) +
                    "</title><meta name=\"viewport\" content=\"width=device-width\"><style>" + kStyle +
                    "</style></head><body>\n<h1>" + escaped_html(name) + "</h1>\n<p>" + count_text(last.fruit) +
                    " fruit in " + count_text(last.scans) + (last.scans == 1 ? " scan on " : " scans on ") +
                    (dates.size() > 1 ? "the last date, " : "") + label(overview.last_date()) + ". In all " +
                    count_text(all.scans) + (all.scans == 1 ? " scan of " : " scans of ") + count_text(rows.size()) +
                    (rows.size() == 1 ? " row" : " rows") + " on " + count_text(dates.size()) +
                    (dates.size() == 1 ? " date" : " dates") + "; " + count_text(all.failed) +
                    " scans have no result.</p>\n<p>Fruit count in each scan anew, so those of different dates are "
                    "not added up: they may be the same.</p>\n";
  if (overview.versions.size() > 1 || overview.parameter_sets > 1)
    out += "<p class=\"note\">The scans were processed by " + std::to_string(overview.versions.size()) +
           " versions with " + std::to_string(overview.parameter_sets) +
           " sets of parameters: differences between them may come from that.</p>\n";
  if (all.colored() > 0) {
    out += "<p class=\"key\">Ripeness:";
    for (std::size_t i = 0; i < kRipenessClasses; ++i)
      out += " <i style=\"background:" + std::string(kRipenessColors[i]) + "\"></i>" +
             to_string(static_cast<RipenessClass>(i));
    out += ". Ripe are light_red and red.</p>\n";
  }
  out += "<h2>Dates</h2>\n" + table({"date"}, of_dates);
  out += "<h2>Rows, each on its last date</h2>\n" + table({"row", "date"}, of_rows);
  if (rows.size() > 1 || dates.size() > 1)
    out += "<h2>Rows and dates</h2>\n" + grid(overview, "Fruit a scan", 1, fruit_per_scan) +
           grid(overview, "Mass, kg", 1,
                [](const Tally& t) { return t.sized > 0 ? std::optional(t.mass) : std::nullopt; }) +
           grid(overview, "Median diameter, mm", 1, [](const Tally& t) { return t.diameter(0.5); }) +
           grid(overview, "Ripe, %", 0, ripe_percent);
  return out + histograms(overview, all) + "</body></html>\n";
}

}  // namespace agrisee::season
