// SPDX-License-Identifier: BSD-3-Clause
// write_seeds DIR: the seed corpora, DIR/<target>/<name>.
#include <agrisee/io/files.hpp>

#include "seeds.hpp"
#include "targets.hpp"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  for (const agrisee::fuzz::Seed& seed : agrisee::fuzz::make_seeds()) {
    const std::filesystem::path folder = std::filesystem::path(argv[1]) / seed.target;
    std::filesystem::create_directories(folder);
    agrisee::io::write_file(folder / seed.name, seed.bytes);
  }
}
