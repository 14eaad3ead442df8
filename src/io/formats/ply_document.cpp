// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/ply_document.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

/// The type with that name in a PLY header; none if the name is unknown.
std::optional<Scalar> scalar_of(std::string_view name) {
  static constexpr std::pair<std::string_view, Scalar> kNames[] = {
      {"char", Scalar::i8},    {"int8", Scalar::i8},    {"uchar", Scalar::u8},   {"uint8", Scalar::u8},
      {"short", Scalar::i16},  {"int16", Scalar::i16},  {"ushort", Scalar::u16}, {"uint16", Scalar::u16},
      {"int", Scalar::i32},    {"int32", Scalar::i32},  {"uint", Scalar::u32},   {"uint32", Scalar::u32},
      {"int64", Scalar::i64},  {"uint64", Scalar::u64}, {"float", Scalar::f32},  {"float32", Scalar::f32},
      {"double", Scalar::f64}, {"float64", Scalar::f64}};
  for (const auto& [known, type] : kNames)
    if (name == known) return type;
  return std::nullopt;
}

}  // namespace

bool PlyElement::has_list() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
}

std::size_t PlyElement::record_size() const {
  std::size_t sum = 0;
  for (const PlyProperty& p : properties) sum += size_of(p.is_list ? p.count_type : p.type);
  return sum;
}

int PlyElement::find(std::initializer_list<const char*> names) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    for (const char* candidate : names)
      if (properties[i].name == candidate) return static_cast<int>(i);
  return -1;
}

PlyDocument::PlyDocument(const std::filesystem::path& path) : path_(path), file_(path) {
  constexpr std::size_t kHead = 2048;  // bytes; few headers are longer
  Bytes head{std::unique_ptr<char[]>(new char[kHead]), 0};
  head.size = file_.read(head.data.get(), kHead);
  if (head.size == 0) fail(path_, "is empty");
  const std::size_t end = head.view().find("\nend_header");
  const bool header_in_head =
      end != std::string_view::npos && head.view().find('\n', end + 1) != std::string_view::npos;
  const bool whole = head.size < kHead || !file_.size() || !header_in_head;
  bytes_ = whole ? file_.rest(std::move(head)) : std::move(head);
  parse_header();
  const auto has_list = [](const PlyElement& e) { return e.has_list(); };
  const bool by_blocks = !whole && !ascii_ && std::none_of(elements_.begin(), elements_.end(), has_list);
  if (!whole && !by_blocks) bytes_ = file_.rest(std::move(bytes_));
  size_ = by_blocks ? std::max(*file_.size(), bytes_.size) : bytes_.size;
  check_sizes();
}

const PlyElement* PlyDocument::find(const char* name) const {
  for (const PlyElement& e : elements_)
    if (e.name == name) return &e;
  return nullptr;
}

void PlyDocument::parse_header() {
  Lines lines(bytes_.view());
  std::string_view line;
  if (!lines.next(line) || trimmed(line) != "ply") fail(path_, "is not a PLY file: it does not begin with 'ply'");
  const auto bad = [&](const std::string& what) { fail(path_, lines.number(), "bad PLY header: " + what); };
  bool format_seen = false;
  while (true) {
    if (!lines.next(line)) fail(path_, "bad PLY header: the file ends before 'end_header'");
    const std::string_view whole = line;
    const std::string_view keyword = next_word(line);
    if (keyword == "end_header") break;
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      const std::string_view name = next_word(line);
      ascii_ = name == "ascii";
      swapped_ = name == "binary_big_endian";
      if (!ascii_ && !swapped_ && name != "binary_little_endian") bad("unknown format " + excerpt(name));
      if (next_word(line) != "1.0") bad("only version 1.0 is known");
      format_seen = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = next_word(line);
      const auto count = to_integer(next_word(line));
      if (element.name.empty() || !count || *count < 0 || !next_word(line).empty())
        bad("expected 'element NAME COUNT', got " + excerpt(whole));
      if (find(element.name.c_str())) bad("two elements are called " + excerpt(element.name));
      element.count = static_cast<std::size_t>(*count);
      elements_.push_back(element);
    } else if (keyword == "property") {
      if (elements_.empty()) bad("a property before the first element");
      PlyProperty property;
      std::string_view type = next_word(line);
      property.is_list = type == "list";
      if (property.is_list) {
        const auto count_type = scalar_of(next_word(line));
        if (!count_type) bad("unknown type in " + excerpt(whole));
        property.count_type = *count_type;
        type = next_word(line);
      }
      const auto scalar = scalar_of(type);
      if (!scalar) bad("unknown type in " + excerpt(whole));
      property.type = *scalar;
      property.name = next_word(line);
      if (property.name.empty() || !next_word(line).empty()) bad("expected one name in " + excerpt(whole));
      if (elements_.back().find({property.name.c_str()}) >= 0)
        bad("two properties are called " + excerpt(property.name));
      elements_.back().properties.push_back(property);
    } else {
      bad("unknown keyword " + excerpt(keyword));
    }
  }
  if (!format_seen) bad("no format");
  body_ = bytes_.size - lines.rest().size();
  body_line_ = lines.number() + 1;
}

void PlyDocument::check_sizes() const {
  const std::size_t available = size_ - body_;
  for (const PlyElement& e : elements_) {
    if (e.count == 0) continue;
    if (e.properties.empty()) fail(path_, "bad PLY header: element '" + e.name + "' has no properties");
    // As text every number takes at least a digit and a blank; the last blank of the file may be missing.
    const std::size_t smallest = ascii_ ? 2 * e.properties.size() : e.record_size();
    if (e.count > (available + 1) / smallest)
      fail(path_, "truncated: the header promises " + std::to_string(e.count) + " records of '" + e.name +
                      "', but only " + std::to_string(available) + " bytes follow");
  }
}

void PlyDocument::fail_truncated(const PlyElement& element, std::size_t record) const {
  fail(path_, "truncated: the file ends in '" + element.name + "' " + std::to_string(record) + " of " +
                  std::to_string(element.count));
}

void PlyDocument::read(const std::vector<std::pair<const PlyElement*, Wanted>>& wanted) {
  std::size_t left = wanted.size();
  Lines lines(bytes_.view().substr(body_), body_line_);
  for (const PlyElement& e : elements_) {
    if (left == 0) return;
    const auto found = std::find_if(wanted.begin(), wanted.end(), [&](const auto& w) { return w.first == &e; });
    const Wanted* take = found == wanted.end() ? nullptr : &found->second;
    if (take) --left;
    if (ascii_)
      read_text(e, take, lines);
    else if (e.has_list())
      read_records(e, take);
    else
      read_blocks(e, take);
  }
}

/// Copy the next bytes of the body, first from memory, then from the file. @return the number of bytes copied
std::size_t PlyDocument::next(char* to, std::size_t size) {
  const std::size_t here = body_ < bytes_.size ? std::min(size, bytes_.size - body_) : 0;
  if (here > 0) std::memcpy(to, bytes_.data.get() + body_, here);
  const std::size_t got = here + (here < size ? file_.read(to + here, size - here) : 0);
  body_ += got;
  return got;
}

void PlyDocument::read_blocks(const PlyElement& element, const Wanted* wanted) {
  constexpr std::size_t kBlock = 1 << 16;  // bytes, or one record
  const std::size_t size = element.record_size();
  if (size == 0) return;
  const std::size_t most = std::min(std::max<std::size_t>(kBlock / size, 1), element.count);
  std::vector<char> block(most * size);
  for (std::size_t begin = 0; begin < element.count; begin += most) {
    const std::size_t rows = std::min(most, element.count - begin);
    if (const std::size_t got = next(block.data(), rows * size); got < rows * size)
      fail_truncated(element, begin + got / size);
    if (!wanted) continue;
    std::vector<Column> columns;
    std::size_t offset = 0;
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const Scalar type = element.properties[i].type;
      if (const Sink& sink = wanted->sinks[i])
        columns.push_back({block.data() + offset, size, type, swapped_, sink.from(begin)});
      offset += size_of(type);
    }
    if (const auto refused = decode(columns, rows))
      fail(path_, "'" + element.name + "' " + std::to_string(begin + *refused) + ": a label is not a whole number");
  }
}

void PlyDocument::read_records(const PlyElement& element, const Wanted* wanted) {
  const char* at = bytes_.data.get() + body_;
  const char* const end = bytes_.data.get() + bytes_.size;
  std::vector<double> values;
  for (std::size_t r = 0; r < element.count; ++r) {
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& p = element.properties[i];
      const std::size_t size = size_of(p.type);
      const auto available = [&] { return static_cast<std::size_t>(end - at); };
      if (!p.is_list) {
        if (available() < size) fail_truncated(element, r);
        if (wanted && wanted->sinks[i] && !wanted->sinks[i].store(r, read_scalar(at, p.type, swapped_)))
          fail(path_, "'" + element.name + "' " + std::to_string(r) + ": a label is not a whole number");
        at += size;
        continue;
      }
      if (available() < size_of(p.count_type)) fail_truncated(element, r);
      const double length = read_scalar(at, p.count_type, swapped_);
      at += size_of(p.count_type);
      if (!(length >= 0.0) || length != std::floor(length))
        fail(path_,
             "'" + element.name + "' " + std::to_string(r) + ": a list of " + std::to_string(length) + " values");
      if (length > static_cast<double>(available() / size)) fail_truncated(element, r);
      const auto n = static_cast<std::size_t>(length);
      if (wanted && wanted->list == static_cast<int>(i)) {
        values.resize(n);
        for (std::size_t j = 0; j < n; ++j) values[j] = read_scalar(at + j * size, p.type, swapped_);
        wanted->on_list(r, values);
      }
      at += n * size;
    }
  }
  body_ = static_cast<std::size_t>(at - bytes_.data.get());
}

void PlyDocument::read_text(const PlyElement& element, const Wanted* wanted, Lines& lines) const {
  std::vector<double> values;
  std::string_view line;
  for (std::size_t r = 0; r < element.count; ++r) {
    if (!lines.next_filled(line)) fail_truncated(element, r);
    if (!wanted) continue;
    const char* at = line.data();
    const char* const end = at + line.size();
    const auto number = [&](const PlyProperty& p) {
      while (at < end && is_blank(*at)) ++at;
      double value = 0.0;
      const char* next = at < end ? parse_number(at, end, value) : nullptr;
      if (!next || (next < end && !is_blank(*next))) {
        std::string_view rest(at, static_cast<std::size_t>(end - at));
        fail(path_, lines.number(),
             at < end ? excerpt(next_word(rest)) + " is not a number (" + p.name + ")"
                      : "no value for '" + p.name + "'");
      }
      at = next;
      return value;
    };
    for (std::size_t i = 0; i < element.properties.size(); ++i) {
      const PlyProperty& p = element.properties[i];
      if (!p.is_list) {
        const double value = number(p);
        if (!wanted->sinks[i].store(r, value)) fail(path_, lines.number(), "'" + p.name + "' is not a whole number");
        continue;
      }
      const double length = number(p);
      if (!(length >= 0.0 && length <= static_cast<double>(line.size())) || length != std::floor(length))
        fail(path_, lines.number(), "a list of " + format(length) + " values");
      values.resize(static_cast<std::size_t>(length));
      for (double& value : values) value = number(p);
      if (wanted->list == static_cast<int>(i)) wanted->on_list(r, values);
    }
    while (at < end && is_blank(*at)) ++at;
    if (at < end) fail(path_, lines.number(), "more values than the header has properties");
  }
}

}  // namespace agrisee::io
