// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/color_image.hpp>
#include <agrisee/io/detections.hpp>
#include <agrisee/io/files.hpp>
#include <agrisee/io/png.hpp>
#include <agrisee/sensor/detection_check.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "io/formats/csv.hpp"
#include "io/formats/json_value.hpp"
#include "io/formats/png16.hpp"

namespace agrisee::io {
namespace {

namespace fs = std::filesystem;

/// What a detection may be called in a file; the first name is the one of messages.
const std::vector<std::vector<const char*>> kColumnNames = {{"instance", "label", "id"}, {"class"},
                                                            {"score", "confidence"},     {"u", "box_u", "x"},
                                                            {"v", "box_v", "y"},         {"width", "box_w", "w"},
                                                            {"height", "box_h", "h"}};
constexpr std::size_t kInstance = 0, kClass = 1, kScore = 2, kBoxFirst = 3;

/// The known name that an unknown one probably means, if the value with the known one is missing; empty otherwise.
/// Detectors write other keys of their own. Names of a box are left out: too few of them is an error anyway.
/// @param has(k) whether there is a value with the names kColumnNames[k]
template <typename Has>
std::string misspelled(const std::string& name, bool has_box, Has&& has) {
  std::vector<std::string> missing;
  for (std::size_t k = 0; k < kBoxFirst; ++k) {
    const std::vector<const char*>& names = kColumnNames[k];
    if (std::find(names.begin(), names.end(), name) != names.end()) return "";
    if (has(k)) continue;
    for (const char* known : names)
      if (std::string(known) != "id") missing.emplace_back(known);  // too short to tell what is near
  }
  if (!has_box && name != "box") missing.emplace_back("box");
  return did_you_mean(name, missing);
}

bool is_fruit(const std::string& name) {
  static const std::set<std::string> kOthers{"leaf", "stem", "branch", "other", "background"};
  return kOthers.count(lower(name)) == 0;
}

/// Collects detections and tests them.
class Collector {
 public:
  /// One of the values of a detection; empty where the file has none.
  using Number = std::function<std::optional<double>(std::size_t)>;
  using Complain = std::function<void(const std::string&)>;

  /// @param path the file, for error messages
  /// @param first the lowest instance of detections that state none
  Collector(fs::path path, std::size_t first) : path_(std::move(path)), first_(first) {}

  /// @param number(k)   the value with the names kColumnNames[k]
  /// @param complain(m) throws FileError with the message m
  void add(const Number& number, const std::string& name, const std::optional<sensor::PixelBox>& given_box,
           const Complain& complain) {
    sensor::Detection d;
    if (const auto instance = number(kInstance)) {
      if (!(*instance >= 1.0 && *instance <= kLast) || *instance != std::floor(*instance))
        complain("instance: must be a whole number from 1 to 65535, got " + format(*instance));
      d.instance = static_cast<int>(*instance);
      if (!stated_.insert(d.instance).second) complain("instance: " + std::to_string(d.instance) + " is listed twice");
    }
    d.score = number(kScore).value_or(1.0);
    if (!(d.score >= 0.0 && d.score <= 1.0)) complain("score: must be from 0 to 1, got " + format(d.score));
    d.name = name;
    d.fruit = is_fruit(name);
    d.box = given_box ? given_box : box_of(number, complain);
    if (d.box && !(d.box->width > 0.0 && d.box->height > 0.0 && std::isfinite(d.box->u + d.box->width) &&
                   std::isfinite(d.box->v + d.box->height)))
      complain("box: must have a width and a height above 0");
    found_.push_back(d);
  }

  /// What was added. Detections that state no instance get the lowest ones, from the first on, that no other states.
  std::vector<sensor::Detection> take() {
    std::size_t next = first_;
    for (sensor::Detection& d : found_) {
      if (d.instance != kNone) continue;
      while (stated_.count(static_cast<int>(next)) > 0) ++next;
      if (next > kLast) fail(path_, "instance: no number up to 65535 is left for a detection that states none");
      d.instance = static_cast<int>(next++);
    }
    return std::move(found_);
  }

 private:
  static constexpr int kNone = 0, kLast = 65535;

  static std::optional<sensor::PixelBox> box_of(const Number& number, const Complain& complain) {
    const auto u = number(kBoxFirst), v = number(kBoxFirst + 1), width = number(kBoxFirst + 2),
               height = number(kBoxFirst + 3);
    if (!u && !v && !width && !height) return std::nullopt;
    if (!u || !v || !width || !height) complain("box: needs all of u, v, width and height");
    return sensor::PixelBox{*u, *v, *width, *height};
  }

  fs::path path_;
  std::size_t first_;
  std::vector<sensor::Detection> found_;
  std::set<int> stated_;
};

std::vector<sensor::Detection> from_json(const fs::path& path, const Bytes& bytes, std::size_t first) {
  const Json json = load_json(path, bytes);
  const JsonValue list(path, json, "");
  Collector out(path, first);
  for (std::size_t i = 0; i < list.list_size(); ++i) {
    const JsonValue value = list.at(i);
    if (!value.json().is_object()) value.fail("expected an object");
    const auto number = [&](std::size_t k) -> std::optional<double> {
      for (const char* name : kColumnNames[k])
        if (value.has(name)) return value.at(name).number();
      return std::nullopt;
    };
    std::optional<sensor::PixelBox> box;
    if (value.has("box")) {
      const Eigen::Vector4d b = value.at("box").numbers<4>();
      box = sensor::PixelBox{b[0], b[1], b[2], b[3]};
    }
    const auto has = [&](std::size_t k) {
      const std::vector<const char*>& names = kColumnNames[k];
      return std::any_of(names.begin(), names.end(), [&](const char* name) { return value.has(name); });
    };
    for (const auto& item : value.json().items())
      if (const std::string meant = misspelled(item.key(), box || has(kBoxFirst), has); !meant.empty())
        value.fail("unknown key " + excerpt(item.key()) + meant);
    out.add(number, value.has("class") ? value.at("class").text() : "", box,
            [&](const std::string& message) { value.fail(message); });
  }
  return out.take();
}

std::vector<sensor::Detection> from_csv(const fs::path& path, std::string_view bytes, std::size_t first) {
  Lines lines(bytes);
  std::string_view line;
  if (!lines.next_filled(line)) fail(path, "is empty");
  std::vector<std::string> names, cells;
  const char separator = csv_separator(line);
  split_csv(line, names, separator);
  std::map<std::size_t, std::size_t> columns;  // of each value
  for (std::size_t k = 0; k < kColumnNames.size(); ++k)
    for (const char* name : kColumnNames[k])
      for (std::size_t c = 0; c < names.size(); ++c)
        if (!columns.count(k) && lower(trimmed(names[c])) == name) columns[k] = c;
  const auto has = [&](std::size_t k) { return columns.count(k) > 0; };
  for (const std::string& name : names)
    if (const std::string meant = misspelled(lower(trimmed(name)), has(kBoxFirst), has); !meant.empty())
      fail(path, lines.number(), "unknown column " + excerpt(trimmed(name)) + meant);
  if (!columns.count(kInstance) && !columns.count(kBoxFirst))
    fail(path, "holds no detections: its first line names neither 'instance' nor a box (u, v, width, height)");
  Collector out(path, first);
  while (lines.next_filled(line)) {
    const auto complain = [&](const std::string& message) { fail(path, lines.number(), message); };
    if (!split_csv(line, cells, separator) || cells.size() != names.size())
      complain("expected " + std::to_string(names.size()) + " cells, got " + std::to_string(cells.size()));
    const auto number = [&](std::size_t k) -> std::optional<double> {
      if (!columns.count(k) || trimmed(cells[columns[k]]).empty()) return std::nullopt;
      const auto value = to_number(trimmed(cells[columns[k]]));
      if (!value)
        complain(std::string(kColumnNames[k].front()) + ": " + excerpt(cells[columns[k]]) + " is not a number");
      return value;
    };
    const std::string name = columns.count(kClass) ? std::string(trimmed(cells[columns[kClass]])) : "";
    out.add(number, name, std::nullopt, complain);
  }
  return out.take();
}

/// @throws FileError if an image is not as large as the depth image
void check_size(const fs::path& path, int width, int height, const sensor::Intrinsics& k) {
  if (width == k.width && height == k.height) return;
  fail(path, "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels, but the depth image " +
                 std::to_string(k.width) + " x " + std::to_string(k.height) +
                 "; channels have to be registered to the depth image");
}

/// @throws FileError if all boxes are shares of the image, or corners
void check_boxes(const fs::path& path, const std::vector<sensor::Detection>& boxes, const sensor::Intrinsics& k) {
  constexpr std::size_t kMany = 4;  // so many cannot all reach from their left to the left of the image, and upwards
  if (boxes.empty()) return;
  bool shares = true, corners = true, beyond = false;
  for (const sensor::Detection& d : boxes) {
    const sensor::PixelBox& b = *d.box;
    shares = shares && b.width < 1.0 && b.height < 1.0;
    corners = corners && b.u >= 0.0 && b.v >= 0.0 && b.width > b.u && b.height > b.v;
    beyond = beyond || b.u + b.width > k.width + 1.0 || b.v + b.height > k.height + 1.0;
  }
  if (shares)
    fail(path, "all boxes are smaller than a pixel: are they normalized, as shares of the image? Pixels are expected");
  if (corners && (beyond || boxes.size() >= kMany))
    fail(path, std::string(beyond ? "a box ends outside of the image" : "all boxes reach across each other") +
                   ": are the numbers corners (left, upper, right, lower)? u, v, width, height are expected");
}

/// @throws FileError if a box shows nothing of the image
void check_inside(const fs::path& path, const std::vector<sensor::Detection>& detections, const sensor::Intrinsics& k) {
  for (const sensor::Detection& d : detections) {
    if (!d.box) continue;
    const sensor::PixelBox& b = *d.box;
    if (b.u < k.width && b.v < k.height && b.u + b.width > 0.0 && b.v + b.height > 0.0) continue;
    fail(path, "the box of detection " + std::to_string(d.instance) + " (u " + format(b.u) + ", v " + format(b.v) +
                   ", width " + format(b.width) + ", height " + format(b.height) + ") lies outside of the image, " +
                   std::to_string(k.width) + " x " + std::to_string(k.height) +
                   " pixels: are the boxes those of a larger image? They have to be in pixels of the depth image");
  }
}

/// The file with classes and scores beside a label image; empty if there is none.
fs::path table_beside(const fs::path& masks) {
  for (const char* extension : {".json", ".csv"}) {
    fs::path path = masks;
    path.replace_extension(extension);
    std::error_code error;
    if (fs::exists(path, error)) return path;
  }
  return {};
}

/// Add detections. One that is known already, by its instance, gains the box.
void add_detections(sensor::DepthFrame& frame, std::vector<sensor::Detection> more) {
  for (sensor::Detection& d : more) {
    const auto known = std::find_if(frame.detections.begin(), frame.detections.end(),
                                    [&](const sensor::Detection& k) { return k.instance == d.instance; });
    if (known == frame.detections.end())
      frame.detections.push_back(std::move(d));
    else
      known->box = d.box;
  }
}

}  // namespace

ColorImage read_color_image(const fs::path& path) { return decode_png_colors(path, read_bytes(path).view()); }

LabelImage read_label_image(const fs::path& path) { return decode_png_labels(path, read_bytes(path).view()); }

std::vector<sensor::Detection> read_detections(const fs::path& path, std::size_t first) {
  const Bytes bytes = read_bytes(path);
  if (bytes.size == 0) fail(path, "is empty");
  const std::string_view text = trimmed(without_byte_order_mark(bytes.view()));
  return !text.empty() && (text.front() == '[' || text.front() == '{') ? from_json(path, bytes, first)
                                                                       : from_csv(path, bytes.view(), first);
}

void add_channels(sensor::DepthFrame& frame, const ChannelFiles& files) {
  const sensor::Intrinsics& k = frame.intrinsics;
  if (!files.color.empty()) {
    ColorImage image = read_color_image(files.color);
    check_size(files.color, image.width, image.height, k);
    frame.color = std::move(image.pixels);
  }
  if (!files.masks.empty()) {
    LabelImage image = read_label_image(files.masks);
    check_size(files.masks, image.width, image.height, k);
    frame.instances = std::move(image.labels);
    frame.detected = true;
    try {
      sensor::check_masks(frame);
    } catch (const InputError& e) {
      fail(files.masks, e.what());
    }
    if (const fs::path table = table_beside(files.masks); !table.empty()) {
      std::vector<sensor::Detection> listed = read_detections(table);
      check_inside(table, listed, k);
      add_detections(frame, std::move(listed));
    }
  }
  if (!files.boxes.empty()) {
    frame.detected = true;
    // Boxes that name no instance have nothing to do with the masks: they are numbered behind these.
    std::size_t last = 0;
    for (const std::uint16_t i : frame.instances) last = std::max<std::size_t>(last, i);
    for (const sensor::Detection& d : frame.detections) last = std::max(last, static_cast<std::size_t>(d.instance));
    std::vector<sensor::Detection> boxes = read_detections(files.boxes, last + 1);
    for (const sensor::Detection& d : boxes)
      if (!d.box) fail(files.boxes, "detection " + std::to_string(d.instance) + " has no box (u, v, width, height)");
    check_boxes(files.boxes, boxes, k);
    check_inside(files.boxes, boxes, k);
    add_detections(frame, std::move(boxes));
  }
}

void write_channels(const sensor::DepthFrame& frame, const ChannelFiles& files) {
  sensor::check(frame);
  const sensor::Intrinsics& k = frame.intrinsics;
  if (!files.color.empty()) {
    check_input(!frame.color.empty(), "write_channels: the frame has no colors");
    write_png(files.color, {k.width, k.height, frame.color});
  }
  if (files.masks.empty()) return;
  check_input(!frame.instances.empty(), "write_channels: the frame has no masks");
  write_file(files.masks, encode_png16({k.width, k.height, frame.instances}));
  Json list = Json::array();
  for (const sensor::Detection& d : frame.detections) {
    Json one{{"instance", d.instance}, {"score", d.score}};
    if (!d.name.empty() || !d.fruit) one["class"] = d.fruit || !is_fruit(d.name) ? d.name : "other";
    if (d.box) one["box"] = {d.box->u, d.box->v, d.box->width, d.box->height};
    list.push_back(one);
  }
  write_file(fs::path(files.masks).replace_extension(".json"), dump(list));
}

}  // namespace agrisee::io
