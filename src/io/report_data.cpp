// SPDX-License-Identifier: BSD-3-Clause
#include "report_data.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "text.hpp"

namespace agrisee::io::report {
namespace {

/// Mildest first; models that are not known last, by name.
std::tuple<int, double, std::string> harshness(const std::string& noise) {
  if (noise == "none") return {0, 0.0, {}};
  if (noise == "l515") return {1, 0.0, {}};
  if (noise == "rough") return {2, 0.0, {}};
  const std::string gaussian = "gaussian:";
  if (noise.rfind(gaussian, 0) == 0)
    if (const auto sigma = to_number(std::string_view(noise).substr(gaussian.size()))) return {3, *sigma, noise};
  return {4, 0.0, noise};
}

const char* own_planner(const std::string& preset) { return preset == "paper" ? "see" : "gain"; }
const char* main_noise(const std::string& preset) { return preset == "paper" ? "gaussian:0.01" : "l515"; }

bool is_worse(double a, double b, Better better) { return better == Better::more ? a < b : a > b; }

template <typename Value>
std::optional<double> worst_of(const std::vector<Value>& items, Better better, Value none) {
  if (better == Better::neither || items.empty()) return std::nullopt;
  std::optional<double> worst;
  for (const Value& value : items) {
    if (value == none) return std::nullopt;
    if (!worst || is_worse(*value, *worst, better)) worst = value;
  }
  return worst;
}

std::vector<double> paper_values(const Group& group, const Figure& figure) {
  std::vector<double> values;
  if (figure.paper)
    for (const Row& row : group.rows)
      if (const auto value = figure.paper(row.total, row.hidden)) values.push_back(*value);
  return values;
}

}  // namespace

std::size_t Group::scans() const {
  std::size_t n = 0;
  for (const Row& row : rows) n += row.trials.size();
  return n;
}

Data arrange(const std::vector<CellRecord>& cells, const std::vector<SceneRecord>& scenes) {
  check_input(!cells.empty(), "report: there is no record of any scan");
  std::vector<const CellRecord*> sorted;
  for (const CellRecord& cell : cells) {
    if (cell.fruits.size() != cell.metrics.fruits.size())
      throw InputError("report: the record " + cell.cell.name() + " locates another number of fruit than it judges");
    sorted.push_back(&cell);
  }
  const auto key = [](const CellRecord* r) {
    const study::Cell& c = r->cell;
    return std::make_tuple(c.preset, c.planner, harshness(c.noise), c.noise, r->total, r->hidden, c.scene, c.trial);
  };
  std::sort(sorted.begin(), sorted.end(), [&](const auto* a, const auto* b) { return key(a) < key(b); });
  Data data;
  for (const CellRecord* r : sorted) {
    const study::Cell& c = r->cell;
    if (data.groups.empty() || data.groups.back().preset != c.preset || data.groups.back().planner != c.planner ||
        data.groups.back().noise != c.noise)
      data.groups.push_back({c.preset, c.planner, c.noise, {}});
    std::vector<Row>& rows = data.groups.back().rows;
    if (rows.empty() || rows.back().scene != c.scene || rows.back().total != r->total ||
        rows.back().hidden != r->hidden)
      rows.push_back({c.scene, r->total, r->hidden, {}});
    std::vector<const CellRecord*>& trials = rows.back().trials;
    if (!trials.empty() && trials.back()->cell.trial == c.trial)
      throw InputError("report: two records of the cell " + c.name());
    trials.push_back(r);
  }
  for (const SceneRecord& scene : scenes) data.scenes.push_back(&scene);
  const auto scene_key = [](const SceneRecord* s) { return std::tie(s->total, s->hidden, s->scene); };
  std::sort(data.scenes.begin(), data.scenes.end(),
            [&](const auto* a, const auto* b) { return scene_key(a) < scene_key(b); });
  std::set<std::string> names;
  for (const SceneRecord* scene : data.scenes)
    if (!names.insert(scene->scene).second) throw InputError("report: two records of the scene " + scene->scene);
  return data;
}

std::vector<const Group*> main_groups(const Data& data) {
  std::vector<const Group*> main;
  for (const std::string& preset : distinct(data, &Group::preset)) {
    const Group* best = nullptr;
    int best_score = -1;
    for (const Group& group : data.groups) {
      if (group.preset != preset) continue;
      const int score = 2 * (group.noise == main_noise(preset)) + (group.planner == own_planner(preset));
      if (score > best_score) best = &group, best_score = score;
    }
    main.push_back(best);
  }
  return main;
}

std::vector<const Group*> own_planner_groups(const Data& data) {
  std::map<std::pair<std::string, std::string>, const Group*> chosen;
  for (const Group& group : data.groups) {
    const Group*& slot = chosen[{group.preset, group.noise}];
    if (!slot || (group.planner == own_planner(group.preset) && slot->planner != group.planner)) slot = &group;
  }
  std::vector<const Group*> groups;
  for (const Group& group : data.groups)
    if (chosen[{group.preset, group.noise}] == &group) groups.push_back(&group);
  return groups;
}

std::vector<std::string> distinct(const Data& data, std::string Group::*text) {
  std::vector<std::string> values;
  for (const Group& group : data.groups)
    if (std::find(values.begin(), values.end(), group.*text) == values.end()) values.push_back(group.*text);
  return values;
}

std::vector<std::string> noises(const Data& data) {
  std::vector<std::string> names = distinct(data, &Group::noise);
  std::sort(names.begin(), names.end(), [](const auto& a, const auto& b) {
    return std::make_pair(harshness(a), a) < std::make_pair(harshness(b), b);
  });
  return names;
}

std::string comparison_noise(const Data& data) {
  std::map<std::string, std::size_t> count;
  for (const Group& group : data.groups) ++count[group.noise];
  std::vector<std::string> names = noises(data);
  std::stable_partition(names.begin(), names.end(), [](const auto& name) { return name == "l515"; });
  return *std::max_element(names.begin(), names.end(),
                           [&](const auto& a, const auto& b) { return count[a] < count[b]; });
}

Mean mean(const Row& row, const Figure& figure) {
  Mean m;
  double sum = 0.0;
  for (const CellRecord* cell : row.trials) {
    ++m.of;
    const std::optional<double> value = figure.of(*cell);
    if (!value || !std::isfinite(*value)) continue;
    ++m.have;
    sum += *value;
  }
  if (m.have > 0) m.value = sum / static_cast<double>(m.have);
  return m;
}

Mean mean(const Group& group, const Figure& figure) {
  Mean m;
  double sum = 0.0;
  int rows = 0;
  for (const Row& row : group.rows) {
    const Mean of_row = mean(row, figure);
    m.have += of_row.have;
    m.of += of_row.of;
    if (!of_row.value) continue;
    sum += *of_row.value;
    ++rows;
  }
  if (rows > 0) m.value = sum / rows;
  return m;
}

std::optional<double> worst_row(const Group& group, const Figure& figure) {
  std::vector<std::optional<double>> values;
  for (const Row& row : group.rows) {
    const Mean m = mean(row, figure);
    values.push_back(m.have == m.of ? m.value : std::nullopt);
  }
  return worst_of(values, figure.better, std::optional<double>());
}

std::optional<double> worst_scan(const Group& group, const Figure& figure) {
  std::vector<std::optional<double>> values;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) {
      const std::optional<double> value = figure.of(*cell);
      values.push_back(value ? finite(*value) : std::nullopt);
    }
  return worst_of(values, figure.better, std::optional<double>());
}

std::optional<double> paper_mean(const Group& group, const Figure& figure) {
  return statistics(paper_values(group, figure)).mean;
}

std::optional<double> paper_worst(const Group& group, const Figure& figure) {
  std::vector<std::optional<double>> values;
  for (const double value : paper_values(group, figure)) values.emplace_back(value);
  return worst_of(values, figure.better, std::optional<double>());
}

std::optional<double> views_to(const CellRecord& cell, double share) {
  for (std::size_t i = 0; i < cell.recall_after.size(); ++i)
    if (cell.recall_after[i] >= share) return static_cast<double>(i + 1);
  return std::nullopt;
}

std::optional<double> views_to_all(const CellRecord& cell) {
  for (std::size_t i = 0; i < cell.true_after.size(); ++i)
    if (cell.true_after[i] >= cell.metrics.n_real) return static_cast<double>(i + 1);
  return std::nullopt;
}

namespace {

std::string counted(const std::map<std::string, std::size_t>& reasons) {
  std::string out;
  for (const auto& [reason, count] : reasons) {
    if (!out.empty()) out += ", ";
    out += text(reason.empty() ? "-" : reason);
    if (reasons.size() > 1) out += " " + std::to_string(count);
  }
  return out;
}

}  // namespace

std::string stop_reasons(const Row& row) {
  std::map<std::string, std::size_t> reasons;
  for (const CellRecord* cell : row.trials) ++reasons[cell->stop_reason];
  return counted(reasons);
}

std::string stop_reasons(const Group& group) {
  std::map<std::string, std::size_t> reasons;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) ++reasons[cell->stop_reason];
  return counted(reasons);
}

std::vector<double> recall_curve(const Group& group) {
  std::size_t length = 0;
  for (const Row& row : group.rows)
    for (const CellRecord* cell : row.trials) length = std::max(length, cell->recall_after.size());
  std::vector<double> curve(length, 0.0);
  for (std::size_t i = 0; i < length; ++i) {
    for (const Row& row : group.rows) {
      double sum = 0.0;
      for (const CellRecord* cell : row.trials)
        if (!cell->recall_after.empty()) sum += cell->recall_after[std::min(i, cell->recall_after.size() - 1)];
      curve[i] += sum / static_cast<double>(row.trials.size()) / static_cast<double>(group.rows.size());
    }
  }
  return curve;
}

}  // namespace agrisee::io::report
