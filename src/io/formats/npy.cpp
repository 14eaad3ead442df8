// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/npy.hpp"

#include <agrisee/io/files.hpp>

#include <limits>

#include "io/formats/text.hpp"

namespace agrisee::io {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";

/// The text behind `'key':` in the header, which is a Python dictionary; empty if there is no such key.
std::string_view value_of(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    const std::size_t at = header.find(quoted);
    if (at == std::string_view::npos) continue;
    std::string_view rest = trimmed(header.substr(at + quoted.size()));
    if (rest.empty() || rest.front() != ':') continue;
    return trimmed(rest.substr(1));
  }
  return {};
}

/// The lengths in "(480, 640)". @return false if the text does not begin with such a list
bool parse_shape(std::string_view text, std::vector<std::size_t>& shape) {
  const std::size_t end = text.find(')');
  if (text.empty() || text.front() != '(' || end == std::string_view::npos) return false;
  text = text.substr(1, end - 1);
  while (!trimmed(text).empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto length = to_integer(trimmed(text.substr(0, comma)));
    if (!length || *length < 0) return false;
    shape.push_back(static_cast<std::size_t>(*length));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return true;
}

/// Read the type, such as "'<f4'". @return false for a type that is not supported
bool parse_type(std::string_view text, NpyArray& array) {
  static constexpr std::pair<std::string_view, Scalar> kTypes[] = {
      {"i1", Scalar::i8},  {"u1", Scalar::u8},  {"i2", Scalar::i16}, {"u2", Scalar::u16}, {"i4", Scalar::i32},
      {"u4", Scalar::u32}, {"i8", Scalar::i64}, {"u8", Scalar::u64}, {"f4", Scalar::f32}, {"f8", Scalar::f64}};
  if (text.size() < 5 || (text[0] != '\'' && text[0] != '"') || text[4] != text[0]) return false;
  array.swapped = text[1] == '>';
  if (!array.swapped && text[1] != '<' && text[1] != '|' && text[1] != '=') return false;
  for (const auto& [name, type] : kTypes)
    if (text.substr(2, 2) == name) {
      array.type = type;
      return true;
    }
  return false;
}

/// Refuse an array of another type than numbers that are read. @param text its type in the header
[[noreturn]] void refuse_type(const std::filesystem::path& path, std::string_view text) {
  if (!text.empty() && text.front() == '[')
    fail(path,
         "holds records with named fields; save an array of numbers: "
         "numpy.lib.recfunctions.structured_to_unstructured(a).astype('float32')");
  if (!text.empty()) text = text.substr(1, text.find(text.front(), 1) - 1);  // without quotes
  fail(path, "holds numbers of the type " + excerpt(text) + ", which is not read; save them with .astype('float32')");
}

}  // namespace

std::string NpyArray::shape_text() const {
  std::string out = "(";
  for (std::size_t i = 0; i < shape.size(); ++i) out += (i ? ", " : "") + std::to_string(shape[i]);
  return out + (shape.size() == 1 ? ",)" : ")");
}

bool is_npy(std::string_view bytes) { return bytes.substr(0, kMagic.size()) == kMagic; }

NpyArray parse_npy(const std::filesystem::path& path, std::string_view bytes) {
  if (!is_npy(bytes)) fail(path, "is not an NPY file");
  if (bytes.size() < 12) fail(path, "is cut off in its header");
  const auto byte = [&](std::size_t i) { return std::size_t{static_cast<unsigned char>(bytes[i])}; };
  const bool old = byte(6) == 1;
  const std::size_t begin = old ? 10 : 12;
  const std::size_t length = byte(8) | byte(9) << 8 | (old ? 0 : byte(10) << 16 | byte(11) << 24);
  if (byte(6) < 1 || byte(6) > 3) fail(path, "is of an unknown version of NPY, " + std::to_string(byte(6)));
  if (bytes.size() - begin < length) fail(path, "is cut off in its header");
  const std::string_view header = bytes.substr(begin, length);
  NpyArray array;
  const std::string_view type = value_of(header, "descr"), order = value_of(header, "fortran_order");
  if (!parse_type(type, array)) refuse_type(path, type);
  array.fortran = order.substr(0, 4) == "True";
  if (!array.fortran && order.substr(0, 5) != "False") fail(path, "bad NPY header: no 'fortran_order'");
  if (!parse_shape(value_of(header, "shape"), array.shape)) fail(path, "bad NPY header: no 'shape'");
  array.data = bytes.data() + begin + length;
  // The product of the lengths must not overflow before it is compared with the size of the file.
  const std::size_t room = (bytes.size() - begin - length) / size_of(array.type);
  std::size_t n = 1;
  for (const std::size_t l : array.shape) {
    if (l > 0 && n > std::numeric_limits<std::size_t>::max() / l) fail(path, "bad NPY header: the shape is too large");
    n *= l;
  }
  if (n > room)
    fail(path, "is cut off: the shape " + array.shape_text() + " needs " + std::to_string(n) + " numbers, there are " +
                   std::to_string(room));
  return array;
}

std::string npy_bytes(const std::vector<float>& values, std::size_t rows, std::size_t columns) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ", " +
                       std::to_string(columns) + "), }";
  header.append(64 - (10 + header.size() + 1) % 64, ' ');  // the data begin at a multiple of 64 bytes
  header += '\n';
  std::string out(kMagic);
  out += {'\1', '\0', static_cast<char>(header.size() & 255), static_cast<char>(header.size() >> 8)};
  out += header;
  if (!values.empty()) out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return out;
}

}  // namespace agrisee::io
