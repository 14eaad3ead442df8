// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/fingerprint.hpp>
#include <agrisee/io/parameters.hpp>
#include <agrisee/io/scan_record.hpp>

#include <cstring>

#include "io/formats/columns.hpp"
#include "io/formats/json_value.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

namespace fs = std::filesystem;

constexpr int kTaskVersion = 1;
constexpr std::string_view kFirstWords = "agrisee view ";
constexpr std::string_view kFirstLine = "agrisee view 1\n";

Json to_json(const Pose& pose) {
  Json rows = Json::array();
  for (int r = 0; r < 3; ++r) {
    rows.push_back(Json::array());
    for (int c = 0; c < 4; ++c) rows.back().push_back(pose.matrix()(r, c));
  }
  return rows;
}

Pose pose_of(const JsonValue& value) {
  if (value.list_size() != 3) value.fail("expected three rows");
  Pose pose = Pose::Identity();
  for (std::size_t r = 0; r < 3; ++r)
    pose.matrix().row(static_cast<Eigen::Index>(r)) = value.at(r).numbers<4>().transpose();
  if (!is_rigid(pose)) value.fail("is not a rigid transform");
  return pose;
}

Json to_json(const sensor::Intrinsics& k) {
  return {{"width", k.width}, {"height", k.height}, {"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx}, {"cy", k.cy}};
}

sensor::Intrinsics intrinsics_of(const JsonValue& value, std::size_t pixels) {
  sensor::Intrinsics k;
  const std::uint64_t width = value.at("width").count(), height = value.at("height").count();
  if (width < 1 || width > pixels || pixels % width != 0 || height != pixels / width)
    value.fail("expected an image of " + std::to_string(pixels) + " pixels");
  k.width = static_cast<int>(width);
  k.height = static_cast<int>(height);
  k.fx = value.at("fx").number();
  k.fy = value.at("fy").number();
  k.cx = value.at("cx").number();
  k.cy = value.at("cy").number();
  return k;
}

template <typename T>
void append(std::string& out, const T* values, std::size_t count) {
  if (count > 0) out.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

/// Whether all bits of a depth are 0. Minus zero is stored, so that it is read back as minus zero.
bool is_blank_pixel(float z) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &z, sizeof bits);
  return bits == 0;
}

/// Append the depths as runs (see scan_record.hpp).
void append_runs(std::string& out, const std::vector<float>& depth) {
  for (std::size_t i = 0; i < depth.size();) {
    std::size_t taken = i;
    while (taken < depth.size() && is_blank_pixel(depth[taken])) ++taken;
    std::size_t end = taken;
    while (end < depth.size() && !is_blank_pixel(depth[end])) ++end;
    const std::uint32_t run[2] = {static_cast<std::uint32_t>(taken - i), static_cast<std::uint32_t>(end - taken)};
    append(out, run, 2);
    append(out, depth.data() + taken, end - taken);
    i = end;
  }
}

/// Read the depths of an image of `pixels` pixels. @return false when the runs do not fill exactly this image
bool read_runs(std::string_view bytes, std::vector<float>& depth, std::size_t pixels) {
  // The first walk checks the runs, before memory is allocated; the second one copies the depths.
  const auto walk = [&](auto&& take) {
    std::size_t pixel = 0;
    std::string_view rest = bytes;
    while (!rest.empty()) {
      std::uint32_t run[2];
      if (rest.size() < sizeof run) return false;
      std::memcpy(run, rest.data(), sizeof run);
      rest.remove_prefix(sizeof run);
      pixel += run[0];
      if (pixel + run[1] > pixels || rest.size() / sizeof(float) < run[1]) return false;
      take(pixel, rest.data(), std::size_t{run[1]});
      rest.remove_prefix(run[1] * sizeof(float));
      pixel += run[1];
    }
    return pixel == pixels;
  };
  if (!walk([](std::size_t, const char*, std::size_t) {})) return false;
  depth.assign(pixels, 0.0f);
  walk([&](std::size_t pixel, const char* from, std::size_t count) {
    if (count > 0) std::memcpy(depth.data() + pixel, from, count * sizeof(float));
  });
  return true;
}

std::uint64_t checksum(std::string_view bytes) {
  Fingerprint print;
  print.add(bytes);
  return print.value();
}

/// Whether a file is named like a view's record: at least four digits, see view_record_path().
bool is_record(const fs::path& path) {
  const std::string number = path.stem().string();
  return path.extension() == ".view" && number.size() >= 4 && is_digits(number);
}

}  // namespace

std::string ScanTask::fingerprint() const {
  Fingerprint print;
  for (const std::string& part : {content, version, std::to_string(seed), noise, planner}) {
    print.add(part);
    print.add("\n");
  }
  if (color) print.add("color\n");
  if (!detector.empty()) print.add("detector " + detector + "\n");
  print.add(parameters_to_json(parameters));
  return print.text();
}

void write_scan_task(const fs::path& path, const ScanTask& task) {
  Json j;
  j["format_version"] = kTaskVersion;
  j["scene"] = task.scene;
  j["content"] = task.content;
  j["version"] = task.version;
  j["seed"] = task.seed;
  j["threads"] = task.threads;
  j["noise"] = task.noise;
  j["planner"] = task.planner;
  if (task.color) j["color"] = true;
  if (!task.detector.empty()) j["detector"] = task.detector;
  j["parameters"] = parse_json(parameters_to_json(task.parameters));
  write_file(path, dump(j), Durability::now);
}

ScanTask read_scan_task(const fs::path& path) {
  const Json json = load_json(path);
  const JsonValue top(path, json, "");
  if (top.at("format_version").count() != kTaskVersion)
    top.at("format_version").fail("only version " + std::to_string(kTaskVersion) + " is known");
  ScanTask task;
  task.scene = top.at("scene").text();
  task.content = top.at("content").text();
  task.version = top.at("version").text();
  task.seed = top.at("seed").count();
  const std::uint64_t threads = top.at("threads").count();
  if (threads < 1 || threads > 1024) top.at("threads").fail("must be from 1 to 1024");
  task.threads = static_cast<int>(threads);
  task.noise = top.at("noise").text();
  task.planner = top.at("planner").text();
  if (top.has("color")) task.color = top.at("color").boolean();
  if (top.has("detector")) task.detector = top.at("detector").text();
  task.parameters = parameters_from_json(top.at("parameters").json().dump(), path.string());
  return task;
}

fs::path view_record_path(const fs::path& folder, std::size_t view) {
  std::string number = std::to_string(view);
  if (number.size() < 4) number.insert(0, 4 - number.size(), '0');
  return folder / "views" / (number + ".view");
}

void write_view_record(const fs::path& folder, std::size_t view, const ViewRecord& record, const std::string& scan) {
  sensor::check(record.frame);
  check_input(is_rigid(record.world_T_optical_asked) && is_rigid(record.world_T_optical),
              "write_view_record: a pose is not rigid");
  Json j;
  j["scan"] = scan;
  j["view"] = view;
  j["asked"] = to_json(record.world_T_optical_asked);
  j["reported"] = to_json(record.world_T_optical);
  if (record.joints) j["joints"] = json_list(*record.joints, "write_view_record: the joints are not finite");
  j["intrinsics"] = to_json(record.frame.intrinsics);
  std::string bytes = std::string(kFirstLine) + j.dump() + "\n";
  append_runs(bytes, record.frame.depth);
  const std::uint64_t sum = checksum(bytes);
  append(bytes, &sum, 1);
  const fs::path path = view_record_path(folder, view);
  make_folder(path.parent_path());
  write_file(path, bytes, Durability::now);
}

std::optional<ViewRecord> read_view_record(const fs::path& folder, std::size_t view, const std::string& scan,
                                           std::size_t pixels) {
  const fs::path path = view_record_path(folder, view);
  std::error_code error;
  if (!fs::exists(path, error)) return std::nullopt;
  const Bytes file = read_bytes(path);
  std::string_view bytes = file.view();
  if (bytes.substr(0, kFirstLine.size()) != kFirstLine)
    fail(path, bytes.substr(0, kFirstWords.size()) == kFirstWords ? "only version 1 of the view record is known"
                                                                  : "is not a view record");
  const auto damaged = [&] {
    fail(path, "is damaged; if it is removed, and run.json, too, `agrisee scan --resume` takes the view again");
  };
  std::uint64_t sum = 0;
  if (bytes.size() < kFirstLine.size() + sizeof sum) damaged();
  std::memcpy(&sum, bytes.data() + bytes.size() - sizeof sum, sizeof sum);
  bytes.remove_suffix(sizeof sum);
  if (checksum(bytes) != sum) damaged();
  bytes.remove_prefix(kFirstLine.size());
  const std::size_t line = bytes.find('\n');
  if (line == std::string_view::npos) damaged();
  Json json;
  try {
    json = parse_json(bytes.substr(0, line));
  } catch (const nlohmann::json::exception&) {
    damaged();
  } catch (const InputError&) {
    damaged();
  }
  const JsonValue top(path, json, "");
  if (top.at("scan").text() != scan) fail(path, "belongs to another scan, or was written by another build of agrisee");
  if (top.at("view").count() != view) fail(path, "is the record of another view");
  ViewRecord record;
  record.world_T_optical_asked = pose_of(top.at("asked"));
  record.world_T_optical = pose_of(top.at("reported"));
  if (top.has("joints")) record.joints = top.at("joints").numbers<6>();
  record.frame.intrinsics = intrinsics_of(top.at("intrinsics"), pixels);
  if (!read_runs(bytes.substr(line + 1), record.frame.depth, pixels)) damaged();
  return record;
}

void remove_scan_records(const fs::path& folder) {
  std::error_code error;
  const auto remove = [&](const fs::path& path) {
    fs::remove(path, error);
    if (error) fail(path, "cannot be removed: " + error.message());
  };
  remove(folder / "scan.json");
  const fs::path views = folder / "views";
  if (!fs::is_directory(views, error)) return;
  remove_leftovers(views);
  std::vector<fs::path> records;
  for (const fs::directory_entry& entry : fs::directory_iterator(views, error))
    if (is_record(entry.path())) records.push_back(entry.path());
  for (const fs::path& path : records) remove(path);
  fs::remove(views, error);  // fails, as it should, if the folder holds other files
}

}  // namespace agrisee::io
