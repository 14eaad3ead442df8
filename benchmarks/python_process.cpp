// SPDX-License-Identifier: BSD-3-Clause
// The C++ half of python_process.py: for each line of input, process a cloud and print the number of fruit, the
// seconds that it took, and the processor time (s).
//   agrisee_python_peer FILE THREADS X Y Z
// FILE holds N x 3 float32, row by row; X Y Z is the viewpoint (m).
#include <agrisee/core/stopwatch.hpp>
#include <agrisee/process.hpp>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>

int main(int argc, char** argv) {
  if (argc != 6) return 1;
  std::ifstream file(argv[1], std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  using Rows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const Eigen::Map<const Rows> rows(reinterpret_cast<const float*>(bytes.data()),
                                    static_cast<Eigen::Index>(bytes.size() / (3 * sizeof(float))), 3);
  agrisee::CloudOrigin origin;
  origin.viewpoint = Eigen::Vector3d(std::atof(argv[3]), std::atof(argv[4]), std::atof(argv[5]));
  for (std::string line; std::getline(std::cin, line);) {
    double seconds = 0.0;
    const std::clock_t begin = std::clock();  // processor time of all threads
    const auto result =
        agrisee::timed(seconds, [&] { return agrisee::process(rows, {}, origin, {}, std::atoi(argv[2])); });
    std::cout << result.fruits.size() << " " << seconds << " "
              << static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC << std::endl;
  }
}
