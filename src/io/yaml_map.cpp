// SPDX-License-Identifier: BSD-3-Clause
#include "yaml_map.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <cmath>
#include <set>

#include "text.hpp"

namespace agrisee::io {

YAML::Node load_yaml(const std::filesystem::path& path) {
  const Bytes bytes = read_bytes(path);
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(std::string(bytes.view()));
  } catch (const YAML::Exception& e) {
    if (e.mark.is_null()) io::fail(path, "not YAML: " + e.msg);
    io::fail(path, static_cast<std::size_t>(e.mark.line) + 1, "not YAML: " + e.msg);
  }
  if (documents.empty() || documents[0].IsNull()) io::fail(path, "is empty");
  if (documents.size() > 1) io::fail(path, "holds more than one YAML document");
  return documents[0];
}

void YamlValue::fail(const std::string& message) const {
  const YAML::Mark mark = node_.Mark();
  const std::string what = key_.empty() ? message : key_ + ": " + message;
  if (mark.is_null()) io::fail(path_, what);
  io::fail(path_, static_cast<std::size_t>(mark.line) + 1, what);
}

void YamlValue::check_keys(std::initializer_list<const char*> known) const {
  if (!node_.IsMap()) fail("expected keys and values");
  std::set<std::string> seen;
  for (const auto& member : node_) {
    const YamlValue key(path_, member.first, key_);
    const std::string name = member.first.IsScalar() ? member.first.Scalar() : "?";
    if (std::none_of(known.begin(), known.end(), [&](const char* k) { return name == k; }))
      key.fail("unknown key " + excerpt(name));
    if (!seen.insert(name).second) key.fail("key " + excerpt(name) + " twice");
  }
}

bool YamlValue::has(const char* key) const {
  const YAML::Node node = node_;
  return node.IsMap() && node[key].IsDefined();
}

YamlValue YamlValue::at(const char* key) const {
  if (!node_.IsMap()) fail("expected keys and values");
  const YAML::Node node = node_;
  const YAML::Node member = node[key];
  if (!member.IsDefined()) fail("missing key '" + std::string(key) + "'");
  return YamlValue(path_, member, key_.empty() ? key : key_ + "." + key);
}

YamlValue YamlValue::at(std::size_t index) const {
  return YamlValue(path_, node_[index], key_ + "[" + std::to_string(index) + "]");
}

std::size_t YamlValue::list_size() const {
  if (!node_.IsSequence()) fail("expected a list");
  return node_.size();
}

std::string YamlValue::text() const {
  if (!node_.IsScalar() || node_.Scalar().empty()) fail("expected a text");
  return node_.Scalar();
}

double YamlValue::number() const {
  if (!node_.IsScalar()) fail("expected a number");
  const auto value = to_number(node_.Scalar());
  if (!value) fail(excerpt(node_.Scalar()) + " is not a number");
  if (!std::isfinite(*value)) fail("has to be finite, got " + node_.Scalar());
  return *value;
}

long long YamlValue::integer() const {
  if (!node_.IsScalar()) fail("expected a whole number");
  const auto value = to_integer(node_.Scalar());
  if (!value) fail(excerpt(node_.Scalar()) + " is not a whole number");
  return *value;
}

}  // namespace agrisee::io
