// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/yaml_map.hpp"

#include <agrisee/io/files.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <yaml-cpp/eventhandler.h>

#include "io/formats/text.hpp"

namespace agrisee::io {

namespace {

/// Rejects documents that are nested too deeply, before any recursive code reads them.
class Structure final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    enter(mark);
  }
  void OnSequenceEnd() override { --depth_; }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    enter(mark);
  }
  void OnMapEnd() override { --depth_; }

 private:
  void enter(const YAML::Mark& mark) {
    constexpr int kDeepest = 32;
    if (++depth_ > kDeepest) throw YAML::ParserException(mark, "nested deeper than " + std::to_string(kDeepest));
  }
  int depth_ = 0;
};

/// Whether a second document follows the first. (YAML::LoadAll never returns for some texts, such as ",".)
/// @throws YAML::Exception for a text that is not YAML or nested too deeply
bool has_second_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Structure structure;
  return parser.HandleNextDocument(structure) && parser.HandleNextDocument(structure);
}

}  // namespace

YAML::Node load_yaml(const std::filesystem::path& path, bool may_be_empty) {
  return parse_yaml(path, std::string(read_bytes(path).view()), may_be_empty);
}

YAML::Node parse_yaml(const std::filesystem::path& path, const std::string& text, bool may_be_empty) {
  try {
    if (has_second_document(text)) io::fail(path, "holds more than one YAML document");
    const YAML::Node document = YAML::Load(text);
    if (document.IsNull() && !may_be_empty) io::fail(path, "is empty");
    return document;
  } catch (const YAML::Exception& e) {
    if (e.mark.is_null()) io::fail(path, "not YAML: " + e.msg);
    io::fail(path, static_cast<std::size_t>(e.mark.line) + 1, "not YAML: " + e.msg);
  }
}

std::string YamlValue::place() const {
  const YAML::Mark mark = node_.Mark();
  const std::string line = mark.is_null() ? "" : ":" + std::to_string(mark.line + 1);
  return path_.string() + line + (key_.empty() ? "" : ": " + key_);
}

void YamlValue::fail(const std::string& message) const { throw FileError(place() + ": " + message); }

void YamlValue::expect_map() const {
  if (node_.IsNull()) fail("is empty: expected keys and values");
  if (!node_.IsMap()) fail("expected keys and values");
}

void YamlValue::check_keys(std::initializer_list<const char*> known) const {
  expect_map();
  std::set<std::string> seen;
  for (const auto& member : node_) {
    const YamlValue key(path_, member.first, key_);
    const std::string name = member.first.IsScalar() ? member.first.Scalar() : "?";
    if (std::none_of(known.begin(), known.end(), [&](const char* k) { return name == k; }))
      key.fail("unknown key " + excerpt(name) + did_you_mean(name, {known.begin(), known.end()}));
    if (!seen.insert(name).second) key.fail("key " + excerpt(name) + " twice");
  }
}

bool YamlValue::has(const char* key) const {
  const YAML::Node node = node_;
  return node.IsMap() && node[key].IsDefined();
}

YamlValue YamlValue::at(const char* key) const {
  expect_map();
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
  if (!std::isfinite(*value)) fail("must be finite, got " + node_.Scalar());
  return *value;
}

long long YamlValue::integer() const {
  if (!node_.IsScalar()) fail("expected a whole number");
  const auto value = to_integer(node_.Scalar());
  if (!value) fail(excerpt(node_.Scalar()) + " is not a whole number");
  return *value;
}

}  // namespace agrisee::io
