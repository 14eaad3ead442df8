// SPDX-License-Identifier: BSD-3-Clause
#include "report/groups.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "io/formats/text.hpp"

namespace agrisee::report {
namespace {

using io::to_number;

/// Sort key of a noise model: mild ones first, unknown ones last, by name.
std::tuple<int, double, std::string> harshness(const std::string& noise) {
  if (noise == "none") return {0, 0.0, {}};
  const std::string models[] = {"l515-white", "l515", "l515:sun", "azure", "azure:sun", "d405", "d405:sun", "rough"};
  for (const std::string& model : models)
    if (noise == model) return {1 + static_cast<int>(&model - models), 0.0, {}};
  const std::string gaussian = "gaussian:";
  if (noise.rfind(gaussian, 0) == 0)
    if (const auto sigma = to_number(std::string_view(noise).substr(gaussian.size()))) return {20, *sigma, noise};
  return {21, 0.0, noise};
}

/// The planner of a preset.
const char* own_planner(const std::string& preset) { return preset == "default" ? "gain" : "see"; }
/// The noise model under which a preset is shown in detail.
const char* main_noise(const std::string& preset) { return preset == "paper" ? "gaussian:0.01" : "l515"; }

}  // namespace

std::size_t Group::scans() const {
  std::size_t n = 0;
  for (const Row& row : rows) n += row.trials.size();
  return n;
}

Data arrange(const std::vector<CellRecord>& cells, const std::vector<SceneRecord>& scenes) {
  check_input(!cells.empty(), "report: there is no record of a scan");
  std::vector<const CellRecord*> sorted;
  for (const CellRecord& cell : cells) {
    if (cell.fruits.size() != cell.metrics.fruits.size())
      throw InputError("report: the record " + cell.cell.name() +
                       " has different numbers of located and evaluated fruit");
    sorted.push_back(&cell);
  }
  const auto key = [](const CellRecord* r) {
    const study::Cell& c = r->cell;
    return std::make_tuple(c.preset, c.planner, harshness(c.noise), c.noise, c.reach, r->total, r->hidden, c.scene,
                           c.trial);
  };
  std::sort(sorted.begin(), sorted.end(), [&](const auto* a, const auto* b) { return key(a) < key(b); });
  Data data;
  for (const CellRecord* r : sorted) {
    const study::Cell& c = r->cell;
    if (data.groups.empty() || data.groups.back().preset != c.preset || data.groups.back().planner != c.planner ||
        data.groups.back().noise != c.noise || data.groups.back().reach != c.reach)
      data.groups.push_back({c.preset, c.planner, c.noise, c.reach, {}});
    std::vector<Row>& rows = data.groups.back().rows;
    if (rows.empty() || rows.back().scene != c.scene || rows.back().total != r->total ||
        rows.back().hidden != r->hidden)
      rows.push_back({c.scene, r->total, r->hidden, {}});
    std::vector<const CellRecord*>& trials = rows.back().trials;
    if (!trials.empty() && trials.back()->cell.trial == c.trial)
      throw InputError("report: there are two records of the cell " + c.name());
    trials.push_back(r);
  }
  for (const SceneRecord& scene : scenes) data.scenes.push_back(&scene);
  const auto scene_key = [](const SceneRecord* s) { return std::tie(s->total, s->hidden, s->scene); };
  std::sort(data.scenes.begin(), data.scenes.end(),
            [&](const auto* a, const auto* b) { return scene_key(a) < scene_key(b); });
  std::set<std::string> names;
  for (const SceneRecord* scene : data.scenes)
    if (!names.insert(scene->scene).second)
      throw InputError("report: there are two records of the scene " + scene->scene);
  return data;
}

std::vector<const Group*> main_groups(const Data& data) {
  std::vector<const Group*> main;
  for (const std::string& preset : distinct(data, &Group::preset)) {
    const Group* best = nullptr;
    int best_score = -1;
    for (const Group& group : data.groups) {
      if (group.preset != preset) continue;
      const int score =
          4 * (group.reach == "arm") + 2 * (group.noise == main_noise(preset)) + (group.planner == own_planner(preset));
      if (score > best_score) best = &group, best_score = score;
    }
    main.push_back(best);
  }
  return main;
}

std::vector<const Group*> own_planner_groups(const Data& data) {
  std::map<std::pair<std::string, std::string>, const Group*> chosen;
  for (const Group& group : data.groups) {
    if (group.reach != "arm") continue;
    const Group*& slot = chosen[{group.preset, group.noise}];
    if (!slot || (group.planner == own_planner(group.preset) && slot->planner != group.planner)) slot = &group;
  }
  std::vector<const Group*> groups;
  for (const Group& group : data.groups)
    if (chosen[{group.preset, group.noise}] == &group) groups.push_back(&group);
  return groups;
}

std::vector<std::string> distinct(const Data& data, std::string Group::*member) {
  std::vector<std::string> values;
  for (const Group& group : data.groups)
    if (std::find(values.begin(), values.end(), group.*member) == values.end()) values.push_back(group.*member);
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
  for (const Group& group : data.groups) count[group.noise] += group.reach == "arm";
  std::vector<std::string> names = noises(data);
  std::stable_partition(names.begin(), names.end(), [](const auto& name) { return name == "l515"; });
  return *std::max_element(names.begin(), names.end(),
                           [&](const auto& a, const auto& b) { return count[a] < count[b]; });
}

}  // namespace agrisee::report
