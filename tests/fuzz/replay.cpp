// SPDX-License-Identifier: BSD-3-Clause
// replay REGRESSIONS: every target, with any compiler, on the seeds, on what bugs were found with, and on plain damage
// to both: cut off at every byte, bytes changed, parts doubled or lost. Ends with the number of inputs, or a crash.
#include <agrisee/io/files.hpp>

#include <iostream>

#include "seeds.hpp"
#include "targets.hpp"

namespace {

using namespace agrisee;

std::size_t damage(const fuzz::Target& target, const std::string& whole, std::uint64_t seed, int changes) {
  std::size_t inputs = 0;
  const auto give = [&](const std::string& bytes) {
    target.run(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    ++inputs;
  };
  give(whole);
  const std::size_t step = std::max<std::size_t>(1, whole.size() / 500);
  for (std::size_t n = 0; n < whole.size(); n += step) give(whole.substr(0, n));
  std::uint64_t state = seed;
  const auto draw = [&](std::size_t below) {  // splitmix64
    std::uint64_t z = (state += 0x9E3779B97F4A7C15ull);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return static_cast<std::size_t>((z ^ (z >> 31)) % std::max<std::size_t>(below, 1));
  };
  for (int i = 0; i < changes; ++i) {
    std::string bytes = whole;
    for (std::size_t k = 0, n = 1 + draw(4); k < n && !bytes.empty(); ++k) {
      const std::size_t at = draw(bytes.size()), length = 1 + draw(16);
      switch (draw(4)) {
        case 0:
          bytes[at] = static_cast<char>(draw(256));
          break;
        case 1:
          bytes[at] = "0129-+.e{}[]:,&*#\n\t\xff"[draw(20)];
          break;
        case 2:
          bytes.erase(at, length);
          break;
        default:
          bytes.insert(draw(bytes.size()), bytes.substr(at, length));
      }
    }
    give(bytes);
  }
  return inputs;
}

}  // namespace

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc != 2 || !fs::is_directory(argv[1])) {
    std::cerr << "usage: replay FOLDER (of a folder a target)\n";
    return 1;
  }
  std::vector<fuzz::Seed> all = fuzz::make_seeds();
  for (const fuzz::Target& target : fuzz::kTargets)
    if (const fs::path folder = fs::path(argv[1]) / target.name; fs::is_directory(folder))
      for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        all.push_back(
            {target.name, entry.path().filename().string(), std::string(io::read_bytes(entry.path()).view())});
  std::size_t inputs = 0;
  for (const fuzz::Target& target : fuzz::kTargets) {
    std::uint64_t seed = 0;
    for (const fuzz::Seed& s : all)
      if (s.target == target.name) inputs += damage(target, s.bytes, ++seed, 1000);
    if (seed == 0) {
      std::cerr << target.name << ": no seed\n";
      return 1;
    }
  }
  std::cout << inputs << " inputs\n";
}
