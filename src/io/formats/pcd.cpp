// SPDX-License-Identifier: BSD-3-Clause
#include <agrisee/io/files.hpp>
#include <agrisee/io/pcd.hpp>

#include <optional>

#include "io/formats/cloud_columns.hpp"
#include "io/formats/lzf.hpp"
#include "io/formats/records.hpp"
#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

/// A field of the points, as the header declares it.
struct Field {
  std::string name;
  Scalar type = Scalar::f32;
  std::size_t count = 1;  ///< numbers of this field per point; only fields with one number are used

  /// Size of the field of one point (bytes).
  std::size_t size() const { return count * size_of(type); }
};

/// The contents of the header.
struct Header {
  std::vector<Field> fields;
  std::size_t width = 0, height = 1, points = 0;
  std::string data;      ///< ascii, binary or binary_compressed
  std::size_t body = 0;  ///< offset of the data
  std::size_t line = 0;  ///< number of the first line of the data

  /// Size of a point (bytes).
  std::size_t point_size() const {
    std::size_t sum = 0;
    for (const Field& f : fields) sum += f.size();
    return sum;
  }
};

/// The lines of a header, before they are checked against each other.
struct HeaderLines {
  std::vector<std::string> names;        ///< FIELDS
  std::vector<long long> sizes, counts;  ///< SIZE, COUNT
  std::string types;                     ///< TYPE, a letter per field
  std::optional<std::size_t> width, height, points;
  std::string data;  ///< DATA
};

/// Reads a header line by line. Errors name the current line.
class HeaderParser {
 public:
  HeaderParser(const std::filesystem::path& path, std::string_view bytes) : path_(path), bytes_(bytes), lines_(bytes) {}

  Header parse() {
    const HeaderLines read = read_lines();
    Header header;
    header.fields = fields(read);
    if (!read.width && !read.points) bad("neither WIDTH nor POINTS");
    header.width = read.width ? *read.width : *read.points;
    header.height = read.height.value_or(1);
    if (header.height > 0 && header.width > static_cast<std::size_t>(1e18) / header.height)
      bad("WIDTH x HEIGHT is too large");
    header.points = header.width * header.height;
    if (read.points && *read.points != header.points) bad("POINTS is not WIDTH x HEIGHT");
    header.data = read.data;
    header.body = bytes_.size() - lines_.rest().size();
    header.line = lines_.number() + 1;
    return header;
  }

 private:
  [[noreturn]] void bad(const std::string& what) const { fail(path_, lines_.number(), "bad PCD header: " + what); }

  long long integer(std::string_view text, long long least, long long most) const {
    const auto value = to_integer(text);
    if (!value || *value < least || *value > most) bad(excerpt(text) + " is not a number, or out of range");
    return *value;
  }

  std::size_t count(std::string_view text) const {
    constexpr long long kMost = 1000000000000000;
    return static_cast<std::size_t>(integer(text, 0, kMost));
  }

  HeaderLines read_lines() {
    HeaderLines read;
    std::string_view line;
    while (read.data.empty()) {
      if (!lines_.next_filled(line)) fail(path_, "bad PCD header: the file ends before 'DATA'");
      const std::string_view keyword = next_word(line);
      if (keyword[0] == '#' || keyword == "VERSION" || keyword == "VIEWPOINT") continue;
      const auto each = [&](auto&& take) {
        for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) take(word);
      };
      if (keyword == "FIELDS" || keyword == "COLUMNS") {
        each([&](std::string_view word) { read.names.emplace_back(word); });
      } else if (keyword == "SIZE") {
        each([&](std::string_view word) { read.sizes.push_back(integer(word, 1, 8)); });
      } else if (keyword == "TYPE") {
        each([&](std::string_view word) { read.types += word.size() == 1 ? word[0] : '?'; });
      } else if (keyword == "COUNT") {
        each([&](std::string_view word) { read.counts.push_back(integer(word, 1, 1 << 20)); });
      } else if (keyword == "WIDTH") {
        read.width = count(next_word(line));
      } else if (keyword == "HEIGHT") {
        read.height = count(next_word(line));
      } else if (keyword == "POINTS") {
        read.points = count(next_word(line));
      } else if (keyword == "DATA") {
        read.data = lower(next_word(line).substr(0, 32));
        if (read.data != "ascii" && read.data != "binary" && read.data != "binary_compressed")
          bad("unknown DATA " + excerpt(read.data));
      } else {
        bad("unknown keyword " + excerpt(keyword));
      }
    }
    return read;
  }

  std::vector<Field> fields(const HeaderLines& read) const {
    const std::vector<std::string>& names = read.names;
    if (names.empty()) bad("no FIELDS");
    const std::vector<long long> counts = read.counts.empty() ? std::vector<long long>(names.size(), 1) : read.counts;
    if (read.sizes.size() != names.size() || read.types.size() != names.size() || counts.size() != names.size())
      bad("FIELDS, SIZE, TYPE and COUNT differ in length");
    std::vector<Field> fields;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string code = read.types[i] + std::to_string(read.sizes[i]);
      const std::optional<Scalar> type = scalar_of(code);
      if (!type) bad("field " + excerpt(names[i]) + " has no known type (" + code + ")");
      for (std::size_t j = 0; j < i; ++j)
        if (names[j] == names[i] && names[i] != "_") bad("two fields are called " + excerpt(names[i]));
      fields.push_back({names[i], *type, static_cast<std::size_t>(counts[i])});
    }
    return fields;
  }

  /// The type with that TYPE and SIZE, such as F4; none if it is unknown.
  static std::optional<Scalar> scalar_of(const std::string& code) {
    constexpr std::pair<const char*, Scalar> kTypes[] = {
        {"I1", Scalar::i8},  {"U1", Scalar::u8},  {"I2", Scalar::i16}, {"U2", Scalar::u16}, {"I4", Scalar::i32},
        {"U4", Scalar::u32}, {"I8", Scalar::i64}, {"U8", Scalar::u64}, {"F4", Scalar::f32}, {"F8", Scalar::f64}};
    for (const auto& [name, type] : kTypes)
      if (code == name) return type;
    return std::nullopt;
  }

  const std::filesystem::path& path_;
  std::string_view bytes_;
  Lines lines_;
};

[[noreturn]] void fail_truncated(const std::filesystem::path& path, const Header& header, std::size_t available) {
  fail(path, "truncated: the header promises " + std::to_string(header.points) + " points, but only " +
                 std::to_string(available) + " bytes of data follow");
}

/// Read data that are stored as text, a point per line.
void read_ascii(const std::filesystem::path& path, const Header& header, std::string_view body,
                const std::vector<Sink>& sinks) {
  Lines lines(body, header.line);
  std::string_view line;
  for (std::size_t r = 0; r < header.points; ++r) {
    if (!lines.next_filled(line))
      fail(path, "truncated: the file ends at point " + std::to_string(r) + " of " + std::to_string(header.points));
    for (std::size_t i = 0; i < header.fields.size(); ++i)
      for (std::size_t c = 0; c < header.fields[i].count; ++c) {
        const std::string_view word = next_word(line);
        const auto value = to_number(word);
        if (!value)
          fail(path, lines.number(),
               word.empty() ? "no value for '" + header.fields[i].name + "'"
                            : excerpt(word) + " is not a number (" + header.fields[i].name + ")");
        if (!sinks[i].store(r, *value))
          fail(path, lines.number(), "'" + header.fields[i].name + "' is not a whole number");
      }
    if (!next_word(line).empty()) fail(path, lines.number(), "more values than the header has fields");
  }
}

/// Read binary data. They are stored point by point or, where compressed (`by_field`), field by field.
void read_binary(const std::filesystem::path& path, const Header& header, const char* data, bool by_field,
                 const std::vector<Sink>& sinks) {
  std::vector<Column> columns;
  std::size_t offset = 0;
  for (std::size_t i = 0; i < header.fields.size(); ++i) {
    const Field& f = header.fields[i];
    if (sinks[i])
      columns.push_back({data + offset, by_field ? f.size() : header.point_size(), f.type, false, sinks[i]});
    offset += by_field ? f.size() * header.points : f.size();
  }
  if (const auto refused = decode(columns, header.points))
    fail(path, "point " + std::to_string(*refused) + ": a label is not a whole number");
}

/// Decompress data that begin with their compressed and uncompressed sizes.
Bytes decompress(const std::filesystem::path& path, const Header& header, std::string_view body) {
  std::uint32_t sizes[2] = {0, 0};  // compressed, uncompressed
  if (body.size() < sizeof sizes) fail_truncated(path, header, body.size());
  std::memcpy(sizes, body.data(), sizeof sizes);
  body.remove_prefix(sizeof sizes);
  if (sizes[0] > body.size()) fail_truncated(path, header, body.size());
  const std::size_t expected = header.points * header.point_size();
  if (sizes[1] != expected)
    fail(path, "the compressed data hold " + std::to_string(sizes[1]) + " bytes, the header asks for " +
                   std::to_string(expected));
  if (expected > kLzfMostPerByte * sizes[0]) fail(path, "the compressed data are damaged");
  Bytes out{std::unique_ptr<char[]>(new char[expected]), expected};
  if (!lzf_decode(body.data(), sizes[0], out.data.get(), expected)) fail(path, "the compressed data are damaged");
  return out;
}

}  // namespace

CloudFile read_pcd(const std::filesystem::path& path, NonFinite non_finite) {
  const Bytes bytes = read_bytes(path);
  if (bytes.size == 0) fail(path, "is empty");
  const Header header = HeaderParser(path, bytes.view()).parse();
  const std::string_view body = bytes.view().substr(header.body);
  // Memory is allocated only after the file is known to be large enough for the points.
  std::size_t numbers = 0;
  for (const Field& f : header.fields) numbers += f.count;
  const bool compressed = header.data == "binary_compressed";
  const std::size_t available = compressed ? body.size() * kLzfMostPerByte : body.size() + 1;
  const std::size_t smallest = header.data == "ascii" ? 2 * numbers : header.point_size();
  if (header.points > available / smallest) fail_truncated(path, header, body.size());
  if (header.data == "binary" && header.points > body.size() / smallest) fail_truncated(path, header, body.size());
  Bytes plain;
  if (compressed && header.points > 0) plain = decompress(path, header, body);

  std::vector<std::string> names;
  for (const Field& f : header.fields)
    if (f.count == 1) names.push_back(f.name);
  CloudColumns columns(path, header.points, names);
  std::vector<Sink> sinks;
  for (const Field& f : header.fields) sinks.push_back(f.count == 1 ? columns.sink(f.name, f.type) : Sink{});
  if (header.data == "ascii")
    read_ascii(path, header, body, sinks);
  else if (header.points > 0)
    read_binary(path, header, compressed ? plain.data.get() : body.data(), compressed, sinks);
  return columns.finish(non_finite, header.width, header.height);
}

void write_pcd(const std::filesystem::path& path, const Cloud& cloud, const Labels& instance) {
  check_input(instance.empty() || instance.size() == cloud.size(), "write_pcd: not one label per point");
  check_input(cloud.normals.empty() || cloud.normals.size() == cloud.size(), "write_pcd: not one normal per point");
  check_channels(cloud);
  std::string names = "x y z", sizes = "4 4 4", types = "F F F", counts = "1 1 1";
  const auto field = [&](const char* name, const char* type) {
    names += std::string(" ") + name;
    sizes += " 4";
    types += std::string(" ") + type;
    counts += " 1";
  };
  if (!cloud.normals.empty())
    for (const char* name : {"normal_x", "normal_y", "normal_z"}) field(name, "F");
  if (!cloud.colors.empty()) field("rgb", "F");
  if (!instance.empty()) field("label", "U");
  if (!cloud.instances.empty()) field("detection", "I");
  const std::string count = std::to_string(cloud.size());
  AtomicFile file(path);
  file.write("# .PCD v0.7 - AgriSEE, metres\nVERSION 0.7\nFIELDS " + names + "\nSIZE " + sizes + "\nTYPE " + types +
             "\nCOUNT " + counts + "\nWIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count +
             "\nDATA binary\n");
  const std::size_t size = 2 * sizes.size() + 2;  // four bytes for each digit, which blanks part
  write_records(file, cloud.size(), size, [&](char*& at, std::size_t i) {
    put_vector(at, cloud.points[i]);
    if (!cloud.normals.empty()) put_vector(at, cloud.normals[i]);
    if (!cloud.colors.empty()) {
      const Rgb& c = cloud.colors[i];
      put(at, std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | std::uint32_t{c[2]});
    }
    if (!instance.empty()) put(at, std::int32_t{instance[i]});
    if (!cloud.instances.empty()) put(at, std::int32_t{cloud.instances[i]});
  });
  file.commit();
}

}  // namespace agrisee::io
