// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/json_value.hpp"

#include <algorithm>

namespace agrisee::io {
namespace {

/// Whether a value is a list of numbers, or of lists of numbers.
bool is_short_list(const Json& json) {
  if (!json.is_array()) return false;
  for (const Json& item : json)
    if (!item.is_number() && !is_short_list(item)) return false;
  return true;
}

/// Whether the parser stopped at a number that is not finite, as Python's json.dump writes it.
/// @param byte the one that it read last, counted from 1
bool is_not_finite(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte, text.size()));
  const std::size_t last = before.find_last_of("NI");
  if (last == std::string_view::npos || byte - last > 2) return false;
  const std::string_view rest = text.substr(last);
  return rest.substr(0, 3) == "NaN" || rest.substr(0, 8) == "Infinity";
}

std::string one_line(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Append the text of a value whose line begins with `indent`.
void dump(const Json& json, const std::string& indent, std::string& out) {
  if ((!json.is_object() && !json.is_array()) || json.empty() || is_short_list(json)) {
    out += one_line(json);
    return;
  }
  const std::string inner = indent + "  ";
  out += json.is_object() ? '{' : '[';
  bool first = true;
  for (const auto& item : json.items()) {
    out += (first ? "\n" : ",\n") + inner;
    first = false;
    if (json.is_object()) out += one_line(Json(item.key())) + ": ";
    dump(item.value(), inner, out);
  }
  out += "\n" + indent + (json.is_object() ? '}' : ']');
}

}  // namespace

Json parse_json(std::string_view text) {
  constexpr int kDeepest = 64;
  return Json::parse(text, [](int depth, Json::parse_event_t, Json&) {
    // Copying and writing a document recurse over its levels.
    if (depth > kDeepest) throw InputError("nested deeper than " + std::to_string(kDeepest));
    return true;
  });
}

Json load_json(const std::filesystem::path& path) { return load_json(path, read_bytes(path)); }

Json load_json(const std::filesystem::path& path, const Bytes& bytes) { return parse_json(path, bytes.view()); }

Json parse_json(const std::filesystem::path& path, std::string_view text) {
  if (text.empty()) fail(path, "is empty");
  try {
    return parse_json(text);
  } catch (const nlohmann::json::parse_error& e) {
    fail(path,
         "not JSON, at byte " + std::to_string(e.byte) +
             (is_not_finite(text, e.byte) ? ": JSON has no NaN and no Infinity; leave such a value out, or write null"
                                          : ""));
  } catch (const nlohmann::json::exception& e) {
    fail(path, std::string("not JSON: ") + e.what());
  } catch (const InputError& e) {
    fail(path, e.what());
  }
}

Json load_json_or_null(const std::filesystem::path& path) {
  try {
    return load_json(path);
  } catch (const FileError&) {
    return nullptr;
  }
}

std::string dump(const Json& json) {
  std::string out;
  dump(json, "", out);
  return out + "\n";
}

}  // namespace agrisee::io
