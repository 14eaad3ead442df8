// SPDX-License-Identifier: BSD-3-Clause
// The plots of a report.
#include <agrisee/study/paper_tables.hpp>

#include <algorithm>
#include <set>
#include <tuple>

#include "report/errors.hpp"
#include "report/figures.hpp"
#include "report/sections.hpp"
#include "report/svg.hpp"

namespace agrisee::report {
namespace {

using Value = std::optional<double>;
using SceneKey = std::tuple<int, int, std::string>;

/// The scenes of these groups, sorted.
std::vector<SceneKey> scenes_of(const std::vector<const Group*>& groups) {
  std::set<SceneKey> keys;
  for (const Group* group : groups)
    for (const Row& row : group->rows) keys.insert({row.total, row.hidden, row.scene});
  return {keys.begin(), keys.end()};
}

std::vector<std::string> names(const std::vector<SceneKey>& keys) {
  std::vector<std::string> out;
  for (const auto& [total, hidden, scene] : keys) out.push_back(scene);
  return out;
}

const Row* find_row(const Group& group, const SceneKey& key) {
  for (const Row& row : group.rows)
    if (SceneKey{row.total, row.hidden, row.scene} == key) return &row;
  return nullptr;
}

/// The value f(row) of each scene; none for scenes that the group does not have.
template <typename F>
std::vector<Value> per_scene(const Group& group, const std::vector<SceneKey>& keys, F&& f) {
  std::vector<Value> values;
  for (const SceneKey& key : keys) {
    const Row* row = find_row(group, key);
    values.push_back(row ? f(*row) : std::nullopt);
  }
  return values;
}

/// A figure per scene: the values of [1], then those of each group.
svg::BarPanel figure_panel(const std::string& title, const std::vector<const Group*>& groups, const Figure& figure) {
  const std::vector<SceneKey> keys = scenes_of(groups);
  svg::BarPanel panel{title, names(keys), {}, 100.0};
  svg::Bars paper{"the paper's table", svg::kReference, {}};
  for (const auto& [total, hidden, scene] : keys) paper.values.push_back(figure.paper(total, hidden));
  const auto known = [](const Value& v) { return v.has_value(); };
  if (std::any_of(paper.values.begin(), paper.values.end(), known)) panel.series.push_back(paper);
  for (std::size_t i = 0; i < groups.size(); ++i)
    panel.series.push_back({groups[i]->name(), svg::color(i),
                            per_scene(*groups[i], keys, [&](const Row& row) { return mean(row, figure).value; })});
  return panel;
}

/// The repeatability of each fruit of the truss in the localization table of [1].
svg::BarPanel repeatability_panel(const std::vector<const Group*>& groups) {
  std::set<int> ids;
  std::vector<std::pair<const Group*, std::vector<FruitTrials>>> found;
  for (const Group* group : groups)
    for (const Row& row : group->rows)
      if (row.total == study::kPaperLocalizationTotal && row.hidden == study::kPaperLocalizationHidden) {
        found.emplace_back(group, fruit_trials(row));
        for (const FruitTrials& fruit : found.back().second) ids.insert(fruit.id);
        break;
      }
  svg::BarPanel panel{
      "Repeatability of the centroid (RMSE over the trials, mm), fruit of the paper's table", {}, {}, {}};
  svg::Bars paper{"the paper's table", svg::kReference, {}};
  for (const int id : ids) {
    panel.categories.push_back("fruit " + std::to_string(id));
    const auto* row = study::paper_localization(study::kPaperLocalizationTotal, study::kPaperLocalizationHidden, id);
    paper.values.push_back(row ? Value(row->rmse) : std::nullopt);
  }
  panel.series.push_back(paper);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    svg::Bars bars{groups[i]->name(), svg::color(i), {}};
    for (const auto& [group, fruits] : found) {
      if (group != groups[i]) continue;
      for (const int id : ids) {
        const auto at = std::find_if(fruits.begin(), fruits.end(), [&](const FruitTrials& f) { return f.id == id; });
        bars.values.push_back(at == fruits.end() ? std::nullopt : times(1e3, at->rmse()));
      }
    }
    panel.series.push_back(bars);
  }
  return panel;
}

/// The mean errors of centroids and fitted centers per scene.
svg::BarPanel error_panel(const std::vector<const Group*>& groups) {
  const std::vector<SceneKey> keys = scenes_of(groups);
  svg::BarPanel panel{"Mean error per scene (mm)", names(keys), {}, {}};
  std::size_t next = 0;
  const auto add = [&](const Group& group, std::optional<double> FruitMetrics::*error, const std::string& what,
                       const std::string& color) {
    std::vector<Value> values =
        per_scene(group, keys, [&](const Row& row) { return times(1e3, errors(row, error).mean); });
    if (std::none_of(values.begin(), values.end(), [](const Value& v) { return v.has_value(); })) return;
    panel.series.push_back({group.preset + ": " + what, color, std::move(values)});
  };
  for (std::size_t i = 0; i < groups.size(); ++i)
    add(*groups[i], &FruitMetrics::centroid_error, "centroid from mean of observable surface", svg::color(i));
  next = groups.size();
  for (const Group* group : groups) add(*group, &FruitMetrics::center_error, "fitted center", svg::color(next++));
  return panel;
}

std::string noise_chart(const Data& data) {
  const std::vector<const Group*> groups = own_planner_groups(data);
  const std::vector<std::string> models = noises(data), presets = distinct(data, &Group::preset);
  std::vector<svg::BarPanel> panels;
  for (const auto& [title, figure] : {std::make_pair("Object recall R_obj (%)", &figure::object_recall),
                                      std::make_pair("mIoU over the observable surface (%)", &figure::miou_surface)}) {
    svg::BarPanel panel{title, models, {}, 100.0};
    for (std::size_t i = 0; i < presets.size(); ++i) {
      svg::Bars bars{presets[i], svg::color(i), {}};
      for (const std::string& noise : models) {
        const auto at = std::find_if(groups.begin(), groups.end(),
                                     [&](const Group* g) { return g->preset == presets[i] && g->noise == noise; });
        bars.values.push_back(at == groups.end() ? std::nullopt : mean(**at, *figure).value);
      }
      panel.series.push_back(bars);
    }
    panels.push_back(panel);
  }
  return svg::bar_chart("Presets under noise, mean over the scenes", panels);
}

std::string planner_chart(const Data& data) {
  const std::string noise = comparison_noise(data);
  std::vector<svg::Line> lines;
  for (const Group& group : data.groups) {
    if (group.noise != noise || group.reach != "arm") continue;
    svg::Line line{group.preset + " / " + group.planner, svg::color(lines.size()), {{0.0, 0.0}}};
    const std::vector<double> curve = scanned_curve(group);
    for (std::size_t i = 0; i < curve.size(); ++i)
      line.points.emplace_back(static_cast<double>(i + 1), 100.0 * curve[i]);
    lines.push_back(line);
  }
  return svg::line_chart("Observable surface seen, noise " + noise, "views",
                         "% within 5 mm of a point, mean over scenes", 100.0, lines);
}

}  // namespace

std::vector<File> plots(const Data& data) {
  const std::vector<const Group*> main = main_groups(data);
  std::vector<File> files;
  files.push_back(
      {"scanning.svg",
       svg::bar_chart("Scanning", {figure_panel("Scanned percentage of the fruit's surface", main, figure::scanned),
                                   figure_panel("Recall of the fruit's surface (%)", main, figure::recall)})});
  files.push_back({"segmentation.svg",
                   svg::bar_chart("Segmentation",
                                  {figure_panel("Object recall R_obj (%)", main, figure::object_recall),
                                   figure_panel("mIoU over the observable surface (%)", main, figure::miou_surface)})});
  std::vector<svg::BarPanel> localization;
  const svg::BarPanel repeat = repeatability_panel(main);
  if (!repeat.categories.empty()) localization.push_back(repeat);
  localization.push_back(error_panel(main));
  files.push_back({"localization.svg", svg::bar_chart("Localization", localization)});
  files.push_back({"planners.svg", planner_chart(data)});
  const std::vector<std::string> presets = distinct(data, &Group::preset);
  if (std::find(presets.begin(), presets.end(), "paper") != presets.end())
    files.push_back({"noise.svg", noise_chart(data)});
  return files;
}

}  // namespace agrisee::report
