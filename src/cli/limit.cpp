// SPDX-License-Identifier: BSD-3-Clause
// agrisee limit: how much of the fruit the arm can see at all from its place, or from places near it, and in how few
// views.
#include <agrisee/io/files.hpp>
#include <agrisee/io/palette.hpp>
#include <agrisee/io/results.hpp>
#include <agrisee/io/scene.hpp>
#include <agrisee/study/base_search.hpp>
#include <agrisee/study/greedy.hpp>
#include <agrisee/version.hpp>

#include <cstring>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.hpp"
#include "inputs.hpp"
#include "words.hpp"

namespace agrisee::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kFormatVersion = 1;
constexpr double kShares[] = {0.90, 0.95, 0.98, 0.99};  // shares of the observable samples for which views are counted
constexpr std::size_t kRows = 12;                       // number of places that are printed

struct LimitOptions {
  std::string scene, output;
  bool base_search = false;
  study::BaseSearchParameters base;
  int threads = 0;
  bool force = false, json = false;
};

/// What the command computes.
struct LimitResult {
  study::LimitParameters parameters;
  study::Observability observed;
  std::vector<study::FruitShare> fruits;
  double observable = 0.0;               ///< share of the samples that can be observed
  study::GreedyOrder frontal, free;      ///< greedy views; the first is the most frontal one, or any
  std::vector<std::size_t> seen_by;      ///< per sample: how many views see it
  std::vector<study::BasePlace> places;  ///< best first; empty without --base-search
};

LimitResult find_limit(const LimitOptions& options, const io::SceneFile& file, const study::Samples& samples) {
  const study::TracedScene traced(file.scene);
  const Workcell& cell = file.workcell;
  const int threads = threads_of(options.threads);
  LimitResult out;
  out.observed = study::observable(traced, samples, cell, out.parameters, threads);
  out.observable = study::share(samples, out.observed.observable);
  out.fruits = study::fruit_shares(samples, out.observed.observable);
  out.seen_by.assign(samples.size(), 0);
  for (std::size_t v = 0; v < out.observed.views.size(); ++v)
    for (std::size_t i = 0; i < samples.size(); ++i) out.seen_by[i] += out.observed.sees(v, i);
  if (!out.observed.views.empty()) {
    const double radius = out.parameters.cover_radius;
    out.frontal = study::frontal_order(out.observed, samples, cell, radius);
    out.free = study::greedy_order(out.observed, samples, std::nullopt, radius);
  }
  if (options.base_search) out.places = study::base_search(traced, samples, cell, options.base, threads);
  return out;
}

/// The greedy views as views of a scan, with samples instead of points: `points_in` counts the samples that a view
/// sees, `points_new` those that it newly covers.
std::vector<View> greedy_views(const LimitResult& limit, const study::Samples& samples) {
  std::vector<View> out;
  study::GreedyCover cover(limit.observed, samples, limit.parameters.cover_radius);
  for (const std::size_t v : limit.frontal.views) {
    const plan::ReachableView& reached = limit.observed.views[v];
    View view;
    view.world_T_optical = reached.world_T_optical;
    view.target = reached.target;
    view.joints = reached.joints;
    for (std::size_t i = 0; i < samples.size(); ++i) view.points_in += limit.observed.sees(v, i);
    view.points_new = cover.take(v);
    out.push_back(view);
  }
  return out;
}

/// The color of a sample: gray-red if no view sees it; otherwise from dark blue (few views) over green to yellow
/// (most).
io::Rgb seen_color(std::size_t seen_by, std::size_t most) {
  if (seen_by == 0) return {168, 92, 88};
  constexpr double kRamp[][3] = {{48, 18, 100}, {59, 82, 139}, {33, 145, 140}, {94, 201, 98}, {253, 231, 37}};
  const double at = 4.0 * std::sqrt(static_cast<double>(seen_by) / static_cast<double>(most));
  const auto i = std::min<std::size_t>(3, static_cast<std::size_t>(at));
  io::Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double part = at - static_cast<double>(i);
    color[c] = static_cast<std::uint8_t>(std::lround(kRamp[i][c] + part * (kRamp[i + 1][c] - kRamp[i][c])));
  }
  return color;
}

/// Write the samples as a colored cloud (binary little-endian PLY).
void write_observable(const fs::path& path, const study::Samples& samples, const std::vector<std::size_t>& seen_by) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\ncomment AgriSEE, metres, world frame\nelement vertex " +
      std::to_string(samples.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
      "nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty int instance\nproperty int "
      "seen_by\nend_header\n";
  const auto put = [&](const auto& value) {
    char raw[sizeof(value)];
    std::memcpy(raw, &value, sizeof(value));
    bytes.append(raw, sizeof(value));
  };
  const std::size_t most = *std::max_element(seen_by.begin(), seen_by.end());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (const Eigen::Vector3f* v : {&samples.points[i], &samples.normals[i]})
      for (const float x : *v) put(x);
    for (const std::uint8_t c : seen_color(seen_by[i], most)) put(c);
    put(static_cast<std::int32_t>(samples.fruit[i]));
    put(static_cast<std::int32_t>(seen_by[i]));
  }
  io::write_file(path, bytes);
}

Json xyz(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
Json optional(const std::optional<std::size_t>& n) { return n ? Json(*n) : Json(nullptr); }

template <typename P>
Json fields_of(const P& parameters) {
  Json out;
  P::fields(parameters, [&](const char* name, const auto& value, const auto&...) { out[name] = value; });
  return out;
}

Json to_json(const LimitOptions& options, const io::SceneFile& file, const study::Samples& samples,
             const LimitResult& limit) {
  Json out;
  out["format_version"] = kFormatVersion;
  out["scene"] = file.workcell.name;
  out["version"] = AGRISEE_VERSION;
  out["parameters"] = fields_of(limit.parameters);
  out["base"] = xyz(file.workcell.world_T_base.translation());
  out["within_reach"] = !limit.observed.views.empty();
  out["poses"] = limit.observed.views.size();
  out["samples"] = samples.size();
  out["observable"] = limit.observable;
  out["fruits"] = Json::array();
  for (const study::FruitShare& f : limit.fruits)
    out["fruits"].push_back({{"id", f.id}, {"samples", f.samples}, {"observable", f.observable}});
  out["views"] = Json::array();
  for (const double share : kShares)
    out["views"].push_back({{"share", share},
                            {"begun_frontal", optional(limit.frontal.views_for(share))},
                            {"begun_freely", optional(limit.free.views_for(share))}});
  if (!options.base_search) return out;
  Json& search = out["base_search"];
  search["range"] = options.base.range;
  search["step"] = options.base.step;
  search["share"] = options.base.share;
  search["parameters"] = fields_of(options.base.limit);
  search["places"] = Json::array();
  for (const study::BasePlace& p : limit.places) {
    Json place;
    place["xyz"] = xyz(p.base);
    place["present"] = p.present;
    place["blocked"] = p.blocked;
    if (p.blocked) place["blocked_by"] = p.blocked_by;
    place["poses"] = p.poses;
    place["observable"] = p.observable;
    place["least"] = p.least;
    place["views"] = optional(p.views);
    search["places"].push_back(std::move(place));
  }
  return out;
}

/// A share as text: "74.3 %".
std::string percent(double share) {
  std::ostringstream out;
  out << std::fixed << std::setprecision(1) << 100.0 * share << " %";
  return out.str();
}

void print_places(std::ostream& out, const LimitOptions& options, const std::vector<study::BasePlace>& places) {
  out << "Places for the base, best first (" << options.base.limit.candidates << " poses tried at each):\n"
      << "  rank       x       y       z  observable  least fruit  views for " << std::setprecision(0)
      << 100.0 * options.base.share << " %\n"
      << std::setprecision(3);
  std::size_t blocked = 0, left_out = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const study::BasePlace& p = places[i];
    blocked += p.blocked;
    if (i >= kRows && !p.present) {
      left_out += !p.blocked;
      continue;
    }
    if (p.blocked && !p.present) continue;
    out << std::setw(6) << i + 1 << std::setw(8) << p.base.x() << std::setw(8) << p.base.y() << std::setw(8)
        << p.base.z() << std::setw(12) << percent(p.observable) << std::setw(13) << percent(p.least) << std::setw(16)
        << (p.views ? std::to_string(*p.views) : "-") << (p.present ? "  <- present" : "") << "\n";
  }
  if (places.front().observable == 0.0) out << "  no fruit can be seen from any of them\n";
  if (left_out > 0) out << "  and " << left_out << " more in limit.json\n";
  if (blocked > 0) out << "  and " << blocked << " where the base would stand in a keep-out space\n";
}

void print_fruits(std::ostream& out, const std::vector<study::FruitShare>& fruits) {
  out << "  fruit  observable\n";
  const study::FruitShare* least = &fruits.front();
  std::string unseen;
  for (const study::FruitShare& f : fruits) {
    out << std::setw(7) << f.id << std::setw(12) << percent(f.observable)
        << (f.observable > 0.0 ? "" : "  cannot be seen at all") << "\n";
    if (f.observable < least->observable) least = &f;
    if (f.observable == 0.0) unseen += (unseen.empty() ? "" : ", ") + std::to_string(f.id);
  }
  if (!unseen.empty())
    out << "Fruit that cannot be seen at all from here: " << unseen << "\n";
  else
    out << "Every fruit can be seen from here; fruit " << least->id << " least of all, " << percent(least->observable)
        << "\n";
}

void print_views(std::ostream& out, const LimitResult& limit) {
  out << "Views that a planner needs that knows the truth (first view frontal / free):";
  for (const double share : kShares) {
    const auto frontal = limit.frontal.views_for(share), free = limit.free.views_for(share);
    out << (share == kShares[0] ? " " : ", ") << std::setprecision(0) << 100.0 * share << " % "
        << (frontal ? std::to_string(*frontal) : "-") << " / " << (free ? std::to_string(*free) : "-");
  }
  out << "\n";
}

void print(const LimitOptions& options, const io::SceneFile& file, const LimitResult& limit) {
  std::ostringstream out;
  out << std::fixed;
  const Eigen::Vector3d base = file.workcell.world_T_base.translation();
  out << file.workcell.name << ": from its base at " << std::setprecision(3) << base.x() << ", " << base.y() << ", "
      << base.z() << " m the arm ";
  if (limit.observed.views.empty())
    out << "can see none of the fruit: nothing is within reach\n";
  else
    out << "can see " << percent(limit.observable) << " of the fruit's surface (" << limit.observed.views.size()
        << " of " << limit.parameters.candidates << " poses tried show any)\n";
  print_fruits(out, limit.fruits);
  if (!limit.observed.views.empty()) print_views(out, limit);
  if (options.base_search) print_places(out, options, limit.places);
  out << "Result: " << options.output << "\n";
  std::cout << out.str();
}

/// @throws UsageError if the folder holds a result that may not be overwritten
void check_limit_output(const LimitOptions& options) {
  const fs::path folder = options.output;
  for (const char* name : {"limit.json", "observable.ply", "views.csv"})
    if (!options.force && fs::exists(folder / name))
      throw UsageError(options.output + ": already holds a result (" + name + "); use --force to overwrite it");
  if (fs::exists(folder / "run.json") || fs::exists(folder / "scan.json"))
    throw UsageError(options.output + ": holds the result of a scan, whose views would be overwritten");
}

int run_limit(const LimitOptions& options) {
  check_limit_output(options);
  try {
    options.base.check();
  } catch (const ParameterError& e) {  // the numbers came from the command line
    throw UsageError(e.what());
  }
  const io::SceneFile file = io::read_scene(scene_file(options.scene));
  file.workcell.sensor.check();
  const study::Samples samples = study::fruit_samples(file.scene);
  if (samples.size() == 0) throw FileError(options.scene + ": holds no fruit, so there is nothing to observe");
  const LimitResult limit = find_limit(options, file, samples);
  const std::string text =
      to_json(options, file, samples, limit).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";

  const fs::path folder = options.output;
  make_folder(options.output);
  fs::remove(folder / "limit.json");  // it is written last: a folder that holds it has a complete result
  write_observable(folder / "observable.ply", samples, limit.seen_by);
  io::write_views(folder / "views.csv", greedy_views(limit, samples));
  io::write_file(folder / "limit.json", text);
  if (options.json)
    std::cout << text;
  else
    print(options, file, limit);
  return kSuccess;
}

}  // namespace

void add_limit(CLI::App& app, Run& run) {
  auto* command = app.add_subcommand(
      "limit", "compute how much of the fruit in a scene the arm can see at best, and in how few views");
  auto options = std::make_shared<LimitOptions>();
  command->add_option("scene", options->scene, "scene file (YAML), or a folder with scene.yaml")->required();
  command->add_option("-o,--output", options->output, "folder for the result")->required();
  auto* search = command->add_flag("--base-search", options->base_search, "also try other places for the base");
  command
      ->add_option("--base-range", options->base.range,
                   "largest distance to move the base along x and y, either way (m)")
      ->check(CLI::NonNegativeNumber)
      ->needs(search)
      ->capture_default_str();
  command->add_option("--base-step", options->base.step, "distance between the places (m)")
      ->check(above_zero())
      ->needs(search)
      ->capture_default_str();
  command->add_option("--threads", options->threads, "number of threads (0: one per core); does not change the result")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--force", options->force, "overwrite an existing result");
  command->add_flag("--json", options->json, "print limit.json");
  command->footer(
      "Example:\n"
      "  agrisee limit truss/scene.yaml -o limit --base-search\n"
      "The folder then holds limit.json; observable.ply, the surface of the fruit, colored by the number of poses in\n"
      "reach that see it (gray-red: none); and views.csv, the views of a greedy planner that knows the truth\n"
      "(points_in: samples of the surface that a view sees; points_new: samples that no earlier view saw).");
  command->callback([options, &run] { run = [options] { return run_limit(*options); }; });
}

}  // namespace agrisee::cli
