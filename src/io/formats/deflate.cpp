// SPDX-License-Identifier: BSD-3-Clause
#include "io/formats/deflate.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <queue>
#include <vector>

namespace agrisee::io {
namespace {

constexpr std::size_t kCodeBlock = 1 << 18;  // bytes that share a code
constexpr std::size_t kSymbols = 286;        // 0..255: bytes; 256: end of the block; 257..285: lengths of runs
constexpr int kEnd = 256, kShortestRun = 3, kLongestRun = 258;

/// Collects bits, the lowest first.
class Bits {
 public:
  void put(std::uint32_t bits, int count) {
    held_ |= std::uint64_t(bits) << size_;
    size_ += count;
    if (size_ < 32) return;
    for (int byte = 0; byte < 4; ++byte) four_[byte] = static_cast<char>(held_ >> 8 * byte & 255u);
    bytes_.append(four_, 4);
    held_ >>= 32;
    size_ -= 32;
  }
  /// All bytes; the last one is filled up with zeros.
  std::string take() {
    for (; size_ > 0; size_ -= 8, held_ >>= 8) bytes_ += static_cast<char>(held_ & 255u);
    return std::move(bytes_);
  }
  void reserve(std::size_t size) { bytes_.reserve(size); }

 private:
  std::string bytes_;
  std::uint64_t held_ = 0;  // fewer than 32 bits between calls
  int size_ = 0;
  char four_[4] = {};
};

/// The symbol of a run's length, and what follows it.
struct Length {
  int symbol, extra_bits, extra;
};

const std::array<Length, kLongestRun + 1>& lengths() {  // RFC 1951, 3.2.5
  static const std::array<Length, kLongestRun + 1> table = [] {
    std::array<Length, kLongestRun + 1> out{};
    int length = kShortestRun;
    for (int symbol = 257; symbol < 285; ++symbol) {
      const int bits = symbol < 265 ? 0 : (symbol - 261) / 4;
      for (int extra = 0; extra < 1 << bits && length < kLongestRun; ++extra, ++length)
        out[static_cast<std::size_t>(length)] = {symbol, bits, extra};
    }
    out[kLongestRun] = {285, 0, 0};
    return out;
  }();
  return table;
}

/// Call byte(value) or run(length) for the bytes [begin, end); a run repeats the byte before it.
template <typename Byte, typename Run>
void walk(std::string_view bytes, std::size_t begin, std::size_t end, Byte&& byte, Run&& run) {
  for (std::size_t i = begin; i < end;) {
    std::size_t same = 0;
    if (i > 0) {
      const std::size_t most = std::min(end - i, static_cast<std::size_t>(kLongestRun));
      while (same < most && bytes[i + same] == bytes[i - 1]) ++same;
    }
    if (same >= kShortestRun) {
      run(same);
      i += same;
    } else {
      byte(static_cast<unsigned char>(bytes[i++]));
    }
  }
}

/// Lengths (bits) of a Huffman code for symbols that occur so often, 0 for those that do not. At least two symbols get
/// a code, and none is longer than `longest`.
std::vector<int> code_lengths(std::vector<std::uint32_t> counts, int longest) {
  auto unused = std::count(counts.begin(), counts.end(), 0u);
  const auto most_unused = static_cast<std::ptrdiff_t>(counts.size()) - 2;
  for (auto i = counts.begin(); unused > most_unused; ++i)
    if (*i == 0) *i = 1, --unused;
  for (;;) {
    using Entry = std::pair<std::uint64_t, std::size_t>;  // how often, and the node of the tree
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> rare;
    std::vector<std::size_t> parent(2 * counts.size(), 0);
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (counts[i] > 0) rare.push({counts[i], i});
    std::size_t node = counts.size();
    while (rare.size() > 1) {
      const Entry a = rare.top();
      rare.pop();
      const Entry b = rare.top();
      rare.pop();
      parent[a.second] = parent[b.second] = node;
      rare.push({a.first + b.first, node++});
    }
    const std::size_t root = node - 1;
    std::vector<int> depth(node, 0), out(counts.size(), 0);
    for (std::size_t i = root; i-- > counts.size();) depth[i] = depth[parent[i]] + 1;
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (counts[i] > 0) out[i] = depth[parent[i]] + 1;
    if (*std::max_element(out.begin(), out.end()) <= longest) return out;
    for (std::uint32_t& count : counts) count = count > 0 ? count / 2 + 1 : 0;  // flatter, and again
  }
}

/// A canonical code (RFC 1951, 3.2.2), its bits in the order in which they are written.
struct Code {
  std::vector<int> length;
  std::vector<std::uint32_t> bits;

  explicit Code(std::vector<int> lengths) : length(std::move(lengths)), bits(length.size(), 0) {
    std::uint32_t next = 0;
    for (int size = 1; size <= 15; ++size, next <<= 1)
      for (std::size_t i = 0; i < length.size(); ++i)
        if (length[i] == size) {
          std::uint32_t code = next++;
          for (int b = 0; b < size; ++b, code >>= 1) bits[i] = bits[i] << 1 | (code & 1u);
        }
  }
  void put(std::size_t symbol, Bits& out) const { out.put(bits[symbol], length[symbol]); }
};

/// Write the codes of a block: that of the bytes and lengths, and that of the distances, which is one bit for the only
/// distance, 1.
void put_codes(const Code& code, Bits& out) {
  constexpr std::array<std::size_t, 19> kOrder{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  constexpr std::size_t kShortZeros = 17, kLongZeros = 18;  // 3 to 10 and 11 to 138 symbols without a code
  struct Step {
    std::size_t symbol;
    int extra_bits;
    std::uint32_t extra;
  };
  std::vector<int> all = code.length;
  all.push_back(1);  // the distance
  std::vector<Step> steps;
  for (std::size_t i = 0; i < all.size();) {
    std::size_t zeros = 0;
    while (i + zeros < all.size() && zeros < 138 && all[i + zeros] == 0) ++zeros;
    if (zeros >= 11)
      steps.push_back({kLongZeros, 7, static_cast<std::uint32_t>(zeros - 11)});
    else if (zeros >= 3)
      steps.push_back({kShortZeros, 3, static_cast<std::uint32_t>(zeros - 3)});
    else
      steps.push_back({static_cast<std::size_t>(all[i]), 0, 0}), zeros = 1;
    i += zeros;
  }
  std::vector<std::uint32_t> counts(kOrder.size(), 0);
  for (const Step& step : steps) ++counts[step.symbol];
  const Code inner(code_lengths(counts, 7));
  out.put(kSymbols - 257, 5);
  out.put(0, 5);  // one distance
  out.put(kOrder.size() - 4, 4);
  for (const std::size_t symbol : kOrder) out.put(static_cast<std::uint32_t>(inner.length[symbol]), 3);
  for (const Step& step : steps) {
    inner.put(step.symbol, out);
    out.put(step.extra, step.extra_bits);
  }
}

void put_block(std::string_view bytes, std::size_t begin, std::size_t end, Bits& out) {
  std::vector<std::uint32_t> counts(kSymbols, 0);
  counts[kEnd] = 1;
  walk(
      bytes, begin, end, [&](unsigned char byte) { ++counts[byte]; },
      [&](std::size_t length) { ++counts[static_cast<std::size_t>(lengths()[length].symbol)]; });
  const Code code(code_lengths(counts, 15));
  out.put(end == bytes.size() ? 1 : 0, 1);  // whether it is the last block
  out.put(2, 2);                            // with a code of its own
  put_codes(code, out);
  walk(
      bytes, begin, end, [&](unsigned char byte) { code.put(byte, out); },
      [&](std::size_t length) {
        const Length& l = lengths()[length];
        code.put(static_cast<std::size_t>(l.symbol), out);
        out.put(static_cast<std::uint32_t>(l.extra), l.extra_bits);
        out.put(0, 1);  // the distance
      });
  code.put(kEnd, out);
}

/// The checksum of a zlib stream (RFC 1950, 9).
std::uint32_t adler32(std::string_view bytes) {
  constexpr std::uint32_t kPrime = 65521;
  constexpr std::size_t kSafe = 5552;  // so many bytes are summed without overflow
  std::uint32_t a = 1, b = 0;
  for (std::size_t begin = 0; begin < bytes.size(); begin += kSafe) {
    for (const char c : bytes.substr(begin, kSafe)) a += static_cast<unsigned char>(c), b += a;
    a %= kPrime, b %= kPrime;
  }
  return b << 16 | a;
}

}  // namespace

std::string deflate(std::string_view bytes) {
  Bits out;
  out.reserve(bytes.size() / 2 + 64);
  out.put(0x0178, 16);  // deflate, a window of 32 kB
  std::size_t begin = 0;
  do {
    const std::size_t end = std::min(begin + kCodeBlock, bytes.size());
    put_block(bytes, begin, end, out);
    begin = end;
  } while (begin < bytes.size());
  std::string stream = out.take();
  const std::uint32_t sum = adler32(bytes);
  for (int shift = 24; shift >= 0; shift -= 8) stream += static_cast<char>(sum >> shift & 255u);
  return stream;
}

}  // namespace agrisee::io
