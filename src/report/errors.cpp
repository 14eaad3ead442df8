// SPDX-License-Identifier: BSD-3-Clause
#include "report/errors.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace agrisee::report {
namespace {

std::vector<double> error_values(const Row& row, std::optional<double> FruitMetrics::*error) {
  std::vector<double> values;
  for (const CellRecord* cell : row.trials)
    for (const FruitMetrics& fruit : cell->metrics.fruits)
      if (fruit.*error) values.push_back(std::abs(*(fruit.*error)));
  return values;
}

std::vector<double> rmse_values(const Row& row) {
  std::vector<double> values;
  for (const FruitTrials& fruit : fruit_trials(row))
    if (const auto rmse = fruit.rmse()) values.push_back(*rmse);
  return values;
}

/// Statistics of the values that of_row returns for all rows of a group.
template <typename F>
auto pooled(const Group& group, F&& of_row) {
  std::vector<double> values;
  for (const Row& row : group.rows) {
    const std::vector<double> more = of_row(row);
    values.insert(values.end(), more.begin(), more.end());
  }
  return statistics(std::move(values));
}

}  // namespace

Errors statistics(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); }), values.end());
  Errors e;
  e.count = values.size();
  if (values.empty()) return e;
  double sum = 0.0;
  for (const double value : values) sum += value;
  e.mean = sum / static_cast<double>(values.size());
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  e.median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  e.worst = values.back();
  return e;
}

Errors errors(const Row& row, std::optional<double> FruitMetrics::*error) {
  return statistics(error_values(row, error));
}
Errors errors(const Group& group, std::optional<double> FruitMetrics::*error) {
  return pooled(group, [&](const Row& row) { return error_values(row, error); });
}

std::vector<FruitTrials> fruit_trials(const Row& row) {
  std::map<int, FruitTrials> by_id;
  for (const CellRecord* cell : row.trials)
    for (const study::LocatedFruit& fruit : cell->fruits) {
      FruitTrials& entry = by_id[fruit.id];
      entry.id = fruit.id;
      entry.hidden = entry.hidden || fruit.hidden;
      ++entry.trials;
      if (fruit.found_by.empty() || !fruit.centroid.allFinite()) continue;
      entry.world.push_back(fruit.centroid);
      entry.sigma.push_back(fruit.sigma);
    }
  std::vector<FruitTrials> all;
  for (auto& [id, entry] : by_id) all.push_back(std::move(entry));
  return all;
}

Errors repeatability(const Row& row) { return statistics(rmse_values(row)); }
Errors repeatability(const Group& group) { return pooled(group, rmse_values); }

Located located(const Row& row) {
  Located l;
  for (const FruitTrials& fruit : fruit_trials(row)) {
    l.found += fruit.world.size();
    l.all += fruit.trials;
  }
  return l;
}

Located located(const Group& group) {
  Located l;
  for (const Row& row : group.rows) {
    const Located more = located(row);
    l.found += more.found;
    l.all += more.all;
  }
  return l;
}

std::optional<double> least_recall(const Row& row) {
  std::optional<double> least;
  for (const CellRecord* cell : row.trials)
    for (const FruitMetrics& fruit : cell->metrics.fruits)
      if (std::isfinite(fruit.recall_obs)) least = std::min(least.value_or(fruit.recall_obs), fruit.recall_obs);
  return least;
}

std::optional<double> least_recall(const Group& group) {
  std::optional<double> least;
  for (const Row& row : group.rows)
    if (const auto value = least_recall(row)) least = std::min(least.value_or(*value), *value);
  return least;
}

}  // namespace agrisee::report
